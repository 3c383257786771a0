// Plane mirrors by pictures of the mirrored scene (Diefenbach and Badler 1997): each plane has a whole picture, of
// which the pixels that show it take theirs; so has each plane that another one shows.
#include <algorithm>
#include <array>

#include "host/integrators/hybrid/reflections/kinds.h"
#include "host/integrators/hybrid/reflections/pictured.h"
#include "kernels/hybrid/reflections/mirror_pick.spv.h"
#include "kernels/hybrid/reflections/mirror_pick_nested.spv.h"
#include "kernels/hybrid/reflections/reflect.spv.h"
#include "kernels/hybrid/reflections/reflect_answer.spv.h"
#include "kernels/hybrid/reflections/reflect_meet.spv.h"
#include "kernels/hybrid/reflections/reflect_nested.spv.h"
#include "kernels/hybrid/reflections/reflect_nested_queue.spv.h"
#include "kernels/hybrid/reflections/reflect_pictured.spv.h"

namespace wavepath {
namespace {

constexpr std::size_t kPick = kPictured + 1, kPickNested = kPick + 1, kPlanarStageCount = kPickNested + 1;
const std::array<KernelCode, kPlanarStageCount> kPlanarStages = {
    {{"reflect", wavepath_reflect_spv},
     {"meet reflected", wavepath_reflect_meet_spv},
     {"answer reflected", wavepath_reflect_answer_spv},
     {"mirrors in mirrors", wavepath_reflect_nested_spv},
     {"queue of mirrors in mirrors", wavepath_reflect_nested_queue_spv},
     {"pictured reflections", wavepath_reflect_pictured_spv},
     {"pick mirrors", wavepath_mirror_pick_spv},
     {"pick mirrors in mirrors", wavepath_mirror_pick_nested_spv}}};
constexpr std::array<std::size_t, kPlanarStageCount> kPlanarOrder = {kReflect, kNested,   kMeet,   kPickNested,
                                                                     kPick,    kPictured, kAnswer, kNestedQueue};

std::vector<Binding> planar_layout() {
  std::vector<Binding> layout = pictured_layout();
  layout.push_back({gpu::kBindMirrorPicture, BindingKind::texels_rg32ui, nullptr});
  return layout;
}
const KernelProgram kPlanarReflectionProgram = {kPlanarStages, kPlanarOrder, planar_layout};

constexpr std::uint32_t kPickedPixels = 1u << 16; // of a dispatch
constexpr std::array<AttachmentInfo, 2> kMirroredAttachments{
    {{.name = "mirror", .format = ImageFormat::rg32ui, .clear = {.words = {gpu::kNone, gpu::kNone}}},
     {.name = "depth", .format = ImageFormat::depth32f, .clear = {.depth = 0.0f}}}};

class PlanarReflections : public PicturedReflections {
public:
  using PicturedReflections::PicturedReflections;

  void change(const View& view, const RenderPlan& settings, const KernelConfig& config,
              const std::vector<Binding>& shared) override {
    reserve(context_.workspace.device, picture_, std::uint64_t{settings.width} * settings.height * sizeof(glm::uvec2));
    PicturedReflections::change(view, settings, config, shared);
  }

  void build(WaveQueue& queue) override {
    for (std::uint32_t i = 0; i < picture_count(); ++i)
      draw(
          queue, i, *pipeline_, kClearAll, [](Commands&) {}, [this, i](Commands& commands) { pick(commands, i); });
  }

  std::uint64_t bytes() const override { return PicturedReflections::bytes() + picture_.bytes(); }

protected:
  void make_target(std::uint32_t width, std::uint32_t height, const Constants& constants) override {
    Device& device = context_.workspace.device;
    target_ = std::make_unique<RasterTarget>(device, width, height, kMirroredAttachments);
    pipeline_ = std::make_unique<RasterPipeline>(device, kMirroredCode, kMirroredAttachments, RasterState{},
                                                 picture(0).bindings, constants);
  }
  void add_bindings(std::vector<Binding>& bindings) override {
    PicturedReflections::add_bindings(bindings);
    bindings.push_back({gpu::kBindMirrorPicture, BindingKind::texels_rg32ui, &picture_});
  }

private:
  void pick(Commands& commands, std::uint32_t index) {
    const bool nested = picture(index).is_nested();
    target_->image(0).copy_to(commands.handle(), picture_);
    commands.barrier();
    commands.bind(bindings(0));
    const std::uint32_t pixels = context_.workspace.frame.width * context_.workspace.frame.height;
    for (std::uint32_t first = 0; first < pixels; first += kPickedPixels) {
      gpu::Wave wave{};
      wave.first_sample = index;
      wave.bounce = picture(index).first;
      wave.sample_count = is_first_of_kind(index) ? 1 : 0;
      wave.first_pixel = first;
      wave.pixel_count = std::min(kPickedPixels, pixels - first);
      commands.dispatch(kernels()[nested ? kPickNested : kPick], groups_for(wave.pixel_count), &wave);
    }
  }

  std::unique_ptr<RasterPipeline> pipeline_;
  Buffer picture_;
};

} // namespace

constinit const ReflectionKind kReflectionPlanar = {
    .name = "planar",
    .summary = "drawn by mirrored cameras, of plane mirrors alone (Diefenbach and Badler 1997)",
    .program = &kPlanarReflectionProgram,
    .nested_stages = kNestedRayStages | 1u << kPickNested,
    .depth = 2,
    .bytes_per_pixel = 36,
    .make = [](const ReflectionContext& context) -> std::unique_ptr<ReflectionTechnique> {
      return std::make_unique<PlanarReflections>(context);
    },
};

} // namespace wavepath
