// The mean of hard shadow maps from many points of a lamp.
#include <array>

#include "host/integrators/hybrid/shadows/kinds.h"
#include "host/integrators/hybrid/shadows/lamp_points.h"
#include "host/integrators/hybrid/shadows/shadow_maps.h"
#include "kernels/hybrid/shadows/look_up_average.spv.h"

namespace wavepath {
namespace {

// Distance from a sphere's surface, relative to its radius: its facets lie deeper than the surface.
constexpr double kLift = 1e-3;

std::vector<gpu::ShadowView> views_from_points(const ShadowFit& fit, const ShadowSource& source, const View&,
                                               const RenderPlan& settings) {
  std::vector<gpu::ShadowView> views;
  for (const glm::dvec3& position : lamp_points(source, settings.shadow_taps)) {
    ShadowSource point = source;
    point.position = position;
    const bool round = source.kind == kSphereSource;
    if (round) { // its tangent plane's side that is lit
      point.kind = kDiscSource;
      point.direction = glm::normalize(position - source.position);
      point.position += kLift * (position - source.position);
    }
    for (gpu::ShadowView& view : usual_views(fit, point)) {
      view.is_part = round;
      views.push_back(view);
    }
  }
  return views;
}

const std::array<KernelCode, 1> kAverageStages = {{{"shadow look-up", wavepath_look_up_average_spv}}};
const KernelProgram kAverageProgram = {kAverageStages, kOnlyStage, shadow_layout};
const ShadowMapRecipe kAverageRecipe = {.views = views_from_points};
constexpr std::array<std::string_view, 4> kAverageSettings = {"shadow-size", "shadow-bias", "shadow-source",
                                                              "shadow-taps"};

} // namespace

constinit const ShadowKind kShadowAverage = {
    .name = "average",
    .summary = "the mean of shadow maps from --shadow-taps points of a lamp",
    .sources = kAreaSources,
    .settings = kAverageSettings,
    .program = &kAverageProgram,
    .maps = &kAverageRecipe,
    .make = make_shadow_maps,
};

} // namespace wavepath
