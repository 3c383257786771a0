// Soft shadows by cones through surface voxels (Crassin et al. 2011): one cone from every point to the whole of a lamp.
#include <array>
#include <cmath>
#include <numbers>

#include "host/integrators/hybrid/shadows/kinds.h"
#include "host/integrators/hybrid/shadows/look_up_technique.h"
#include "host/integrators/hybrid/shadows/times.h"
#include "host/integrators/hybrid/voxels/surface_voxels.h"
#include "kernels/hybrid/shadows/look_up_cones.spv.h"

namespace wavepath {
namespace {

using enum BindingKind;

enum ConeBuffer : std::size_t { kConeFrameData, kConeSources, kLamps };
const std::vector<BufferRule> kConeRules = {
    {"frame", nullptr, {{gpu::kBindShadowFrame, uniform}}},
    {"sources", nullptr, {{gpu::kBindShadowLights, texels_rg32ui}}},
    {"lamps", nullptr, {{gpu::kBindShadowViews, texels_rgba32f}, {gpu::kBindConeLamps, texels_rgba32f}}}}; // no views

std::vector<Binding> cone_layout() {
  std::vector<Binding> layout = look_up_layout(kConeRules);
  add_voxel_layout(layout);
  return layout;
}

const std::array<KernelCode, 1> kConeStages = {{{kShadowLookUpStage, wavepath_look_up_cones_spv}}};
const KernelProgram kConeProgram = {kConeStages, kOnlyStage, cone_layout};

// A source as kBindConeLamps has it: its middle and 1, or the direction to a sun and 0; the normal of a flat one, or 0,
// and the radius of a disc of its area. Points and suns have no radius.
std::array<glm::vec4, 2> lamp_of(const ShadowSource& source) {
  const double u = glm::length(source.u), v = glm::length(source.v);
  switch (source.kind) {
    case kDirectionalSource:
      return {glm::vec4(-source.direction, 0.0f), glm::vec4(0.0f)};
    case kRectangleSource:
    case kDiscSource: {
      const glm::dvec3 normal = glm::normalize(glm::cross(source.u, source.v));
      const double radius = source.kind == kDiscSource ? u : std::sqrt(4.0 * u * v / std::numbers::pi);
      return {glm::vec4(source.position, 1.0f), glm::vec4(normal, radius)};
    }
    case kSphereSource:
      return {glm::vec4(source.position, 1.0f), glm::vec4(0.0f, 0.0f, 0.0f, u)};
    default:
      return {glm::vec4(source.position, 1.0f), glm::vec4(0.0f)};
  }
}

class ConeShadows : public LookUpTechnique {
public:
  explicit ConeShadows(const ShadowContext& context) : LookUpTechnique(context, kConeRules) {
    buffers_[kConeSources] = upload(workspace_.device, sources_of_lights());
    std::vector<glm::vec4> lamps;
    for (const ShadowSource& source : sources_)
      for (const glm::vec4& texel : lamp_of(source)) lamps.push_back(texel);
    buffers_[kLamps] = upload(workspace_.device, lamps);
  }

  void change(const View& view, const RenderPlan& settings, const std::vector<Binding>& shared) override {
    start_kernels(view, settings);
    gpu::ShadowFrame frame{};
    frame.ambient = static_cast<float>(settings.shadow_ambient);
    upload_frame(frame);
    bind(shared);
  }

  void build(WaveQueue&, std::uint32_t) override {} // voxels are those of the frame
  std::uint32_t view_count() const override { return 0; }
};

} // namespace

constinit const ShadowKind kShadowCones = {
    .name = "cones",
    .summary = "a cone to each lamp through voxels of the surfaces (voxel cone tracing, Crassin et al. 2011)",
    .sources = kAllSources,
    .program = &kConeProgram,
    .voxels = true,
    .make = [](const ShadowContext& context) -> std::unique_ptr<ShadowTechnique> {
      return std::make_unique<ConeShadows>(context);
    },
};

} // namespace wavepath
