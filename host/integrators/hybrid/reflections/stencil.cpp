// Plane mirrors by the stencil buffer (Kilgard 1999): the pixels that show a mirror are marked, depth is reset, and the
// mirrored scene is drawn where the marks are. One picture serves all mirrors.
#include <array>

#include "host/integrators/hybrid/reflections/kinds.h"
#include "host/integrators/hybrid/reflections/pictured.h"
#include "kernels/hybrid/reflections/mirror_mask_frag.spv.h"
#include "kernels/hybrid/reflections/mirror_vert.spv.h"
#include "kernels/hybrid/reflections/reflect.spv.h"
#include "kernels/hybrid/reflections/reflect_answer.spv.h"
#include "kernels/hybrid/reflections/reflect_meet.spv.h"
#include "kernels/hybrid/reflections/reflect_pictured.spv.h"

namespace wavepath {
namespace {

const std::array<KernelCode, kRayStageCount + 1> kStencilStages = {
    {{"reflect", wavepath_reflect_spv},
     {"meet reflected", wavepath_reflect_meet_spv},
     {"answer reflected", wavepath_reflect_answer_spv},
     {"pictured reflections", wavepath_reflect_pictured_spv}}};
constexpr std::array<std::size_t, kRayStageCount + 1> kStencilOrder = {kReflect, kMeet, kPictured, kAnswer};
const KernelProgram kStencilProgram = {kStencilStages, kStencilOrder, pictured_layout};

const RasterCode kMaskCode{"mirror marks", wavepath_mirror_vert_spv, wavepath_mirror_mask_frag_spv};
constexpr std::array<AttachmentInfo, 2> kStencilAttachments{
    {{.name = "mirrors", .format = ImageFormat::rg32ui, .clear = {.words = {gpu::kNone, gpu::kNoMirror}}},
     {.name = "depth and stencil", .format = ImageFormat::depth32f_stencil8, .clear = {.depth = 0.0f}}}};

// Marks are the numbers of mirrors, from 1 on.
RasterState mask_state(std::uint32_t mirror) {
  RasterState state;
  state.depth = {.test = false, .write = false};
  const StencilFace face{.pass = StencilOp::replace, .reference = mirror + 1};
  state.stencil = StencilState{face, face};
  return state;
}
RasterState drawn_state(std::uint32_t mirror) {
  RasterState state;
  const StencilFace face{.compare = Compare::equal, .reference = mirror + 1};
  state.stencil = StencilState{face, face};
  return state;
}

class StencilReflections : public PicturedReflections {
public:
  using PicturedReflections::PicturedReflections;

  void build(WaveQueue& queue) override {
    for (std::uint32_t i = 0; i < mirror_count(); ++i) {
      const auto mark = [this, i](Commands& commands) { draw_mask(commands, i); };
      const auto keep = [this, i](Commands& commands) {
        if (i + 1 == mirror_count()) target_->image(0).copy_to(commands.handle(), ids_);
      };
      draw(queue, i, *pipelines_[i].mirrored, kClearDepth, mark, keep);
    }
  }

protected:
  void make_target(std::uint32_t width, std::uint32_t height, const Constants& constants) override {
    Device& device = context_.workspace.device;
    target_ = std::make_unique<RasterTarget>(device, width, height, kStencilAttachments);
    pipelines_.clear();
    for (std::uint32_t i = 0; i < mirror_count(); ++i)
      pipelines_.push_back({std::make_unique<RasterPipeline>(device, kMaskCode, kStencilAttachments, mask_state(i),
                                                             drawn_with(i), constants),
                            std::make_unique<RasterPipeline>(device, kMirroredCode, kStencilAttachments, drawn_state(i),
                                                             drawn_with(i), constants)});
  }

private:
  struct Pipelines {
    std::unique_ptr<RasterPipeline> mask, mirrored;
  };

  // The marks are seen by the frame's own camera, which the buffer does not hold yet.
  void draw_mask(Commands& commands, std::uint32_t mirror) {
    commands.write(frame_of(mirror), &context_.workspace.frame, sizeof(gpu::Frame));
    gpu::Wave wave{};
    wave.first_sample = mirror;
    const VertexRange whole{0, 3, 0, 1};
    const RasterDraw mask{pipelines_[mirror].mask.get(), &drawn_with(mirror), &wave, {&whole, 1}};
    target_->draw(commands, {.draws = {&mask, 1}, .clear = mirror == 0 ? kClearAll : kClearNothing});
  }

  std::vector<Pipelines> pipelines_; // of each mirror
};

} // namespace

constinit const ReflectionKind kReflectionStencil = {
    .name = "stencil",
    .summary = "drawn by mirrored cameras where the stencil marks plane mirrors (Kilgard 1999)",
    .program = &kStencilProgram,
    .bytes_per_pixel = 24,
    .make = [](const ReflectionContext& context) -> std::unique_ptr<ReflectionTechnique> {
      return std::make_unique<StencilReflections>(context);
    },
};

} // namespace wavepath
