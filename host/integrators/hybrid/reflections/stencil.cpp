// Plane mirrors by the stencil buffer (Kilgard 1999): the pixels that show a mirror are marked, depth is reset, and the
// mirrored scene is drawn where the marks are. Mirrors in mirrors are marked within these marks. One picture serves all
// mirrors.
#include <array>
#include <map>

#include "host/integrators/hybrid/reflections/kinds.h"
#include "host/integrators/hybrid/reflections/pictured.h"
#include "kernels/hybrid/reflections/mirror_mask_frag.spv.h"
#include "kernels/hybrid/reflections/mirror_vert.spv.h"
#include "kernels/hybrid/reflections/reflect.spv.h"
#include "kernels/hybrid/reflections/reflect_answer.spv.h"
#include "kernels/hybrid/reflections/reflect_meet.spv.h"
#include "kernels/hybrid/reflections/reflect_nested.spv.h"
#include "kernels/hybrid/reflections/reflect_nested_queue.spv.h"
#include "kernels/hybrid/reflections/reflect_pictured.spv.h"

namespace wavepath {
namespace {

const std::array<KernelCode, kRayStageCount + 1> kStencilStages = {
    {{"reflect", wavepath_reflect_spv},
     {"meet reflected", wavepath_reflect_meet_spv},
     {"answer reflected", wavepath_reflect_answer_spv},
     {"mirrors in mirrors", wavepath_reflect_nested_spv},
     {"queue of mirrors in mirrors", wavepath_reflect_nested_queue_spv},
     {"pictured reflections", wavepath_reflect_pictured_spv}}};
constexpr std::array<std::size_t, kRayStageCount + 1> kStencilOrder = {kReflect,  kNested, kMeet,
                                                                       kPictured, kAnswer, kNestedQueue};
const KernelProgram kStencilProgram = {kStencilStages, kStencilOrder, pictured_layout};

const RasterCode kMaskCode{"mirror marks", wavepath_mirror_vert_spv, wavepath_mirror_mask_frag_spv};
constexpr std::array<AttachmentInfo, 2> kStencilAttachments{
    {{.name = "mirrors", .format = ImageFormat::rg32ui, .clear = {.words = {gpu::kNone, gpu::kNoMirror}}},
     {.name = "depth and stencil", .format = ImageFormat::depth32f_stencil8, .clear = {.depth = 0.0f}}}};

// Marks: the number of the mirror that the frame shows, from 1 on, and in the upper half that of the mirror in it.
// Kilgard counts in the place of the latter, one mirror after the other; numbers do with one picture for all of them.
constexpr std::uint32_t kMarkBits = 4, kFirstMark = (1u << kMarkBits) - 1;
static_assert(gpu::kMostMirrors <= kFirstMark);

// Marks the nested mirror where the first one was marked.
RasterState mask_state(std::uint32_t mark) {
  const bool nested = mark > kFirstMark;
  RasterState state;
  state.depth = {.test = false, .write = false};
  const StencilFace face{.pass = StencilOp::replace,
                         .compare = nested ? Compare::equal : Compare::always,
                         .reference = mark,
                         .read_mask = kFirstMark,
                         .write_mask = nested ? ~kFirstMark & 0xffu : kFirstMark};
  state.stencil = StencilState{face, face};
  return state;
}
RasterState drawn_state(std::uint32_t mark) {
  RasterState state;
  const StencilFace face{.compare = Compare::equal, .reference = mark};
  state.stencil = StencilState{face, face};
  return state;
}

class StencilReflections : public PicturedReflections {
public:
  using PicturedReflections::PicturedReflections;

  void build(WaveQueue& queue) override {
    const std::uint64_t pixels = std::uint64_t{context_.workspace.frame.width} * context_.workspace.frame.height;
    for (std::uint32_t i = 0; i < picture_count(); ++i) {
      const auto mark = [this, i](Commands& commands) { draw_mask(commands, i); };
      const auto keep = [this, i, pixels](Commands& commands) {
        if (!is_last_of_kind(i)) return;
        const std::uint64_t before = picture(i).is_nested() ? pixels * sizeof(glm::uvec2) : 0;
        target_->image(0).copy_to(commands.handle(), ids_, Aspect::main, before);
      };
      draw(queue, i, *pipelines_of(i).mirrored, kClearDepth, mark, keep);
    }
  }

protected:
  void make_target(std::uint32_t width, std::uint32_t height, const Constants& constants) override {
    target_ = std::make_unique<RasterTarget>(context_.workspace.device, width, height, kStencilAttachments);
    constants_ = constants;
    pipelines_.clear();
  }

private:
  struct Pipelines {
    std::unique_ptr<RasterPipeline> mask, mirrored;
  };

  // Made when they are first drawn with.
  const Pipelines& pipelines_of(std::uint32_t index) {
    const Picture& drawn = picture(index);
    const std::uint32_t mirror = drawn.mirror + 1;
    const std::uint32_t mark = drawn.is_nested() ? mirror << kMarkBits | (drawn.first + 1) : mirror;
    Pipelines& pipelines = pipelines_[mark];
    const auto make = [&](const RasterCode& code, const RasterState& state) {
      return std::make_unique<RasterPipeline>(context_.workspace.device, code, kStencilAttachments, state,
                                              drawn.bindings, constants_);
    };
    if (!pipelines.mask) pipelines = {make(kMaskCode, mask_state(mark)), make(kMirroredCode, drawn_state(mark))};
    return pipelines;
  }

  // The marks are seen by the frame's own camera, or that of the first mirror, which the buffer does not hold yet.
  void draw_mask(Commands& commands, std::uint32_t index) {
    const gpu::Frame frame = seen_by(picture(index));
    commands.write(picture(index).frame, &frame, sizeof(frame));
    gpu::Wave wave{};
    wave.first_sample = index;
    const VertexRange whole{0, 3, 0, 1};
    const RasterDraw mask{pipelines_of(index).mask.get(), &picture(index).bindings, &wave, {&whole, 1}};
    const std::uint32_t clear = !is_first_of_kind(index)     ? kClearNothing
                                : picture(index).is_nested() ? kClearColour
                                                             : kClearAll;
    target_->draw(commands, {.draws = {&mask, 1}, .clear = clear});
  }

  Constants constants_{};
  std::map<std::uint32_t, Pipelines> pipelines_; // by mark
};

} // namespace

constinit const ReflectionKind kReflectionStencil = {
    .name = "stencil",
    .summary = "drawn by mirrored cameras where the stencil marks plane mirrors (Kilgard 1999)",
    .program = &kStencilProgram,
    .nested_stages = kNestedRayStages,
    .depth = 2,
    .bytes_per_pixel = 32,
    .make = [](const ReflectionContext& context) -> std::unique_ptr<ReflectionTechnique> {
      return std::make_unique<StencilReflections>(context);
    },
};

} // namespace wavepath
