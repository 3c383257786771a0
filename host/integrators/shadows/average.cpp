// The mean of hard shadow maps from many points of a lamp.
#include <array>
#include <cmath>
#include <numbers>

#include "host/integrators/shadows/kinds.h"
#include "host/integrators/shadows/shadow_maps.h"
#include "kernels/shadows/look_up_average.spv.h"

namespace wavepath {
namespace {

// The digits of i in base 2, mirrored at the point (van der Corput 1935).
double mirrored_bits(std::uint32_t i) {
  double value = 0.0;
  for (double digit = 0.5; i > 0; i >>= 1, digit *= 0.5) value += (i & 1u) * digit;
  return value;
}

// Points that share the lamp's area evenly (Hammersley 1960).
std::vector<gpu::ShadowView> views_from_points(const ShadowFit& fit, const ShadowSource& source, const View&,
                                               const RenderSettings& settings) {
  std::vector<gpu::ShadowView> views;
  for (std::uint32_t i = 0; i < settings.shadow_taps; ++i) {
    const double a = (i + 0.5) / settings.shadow_taps, b = mirrored_bits(i) + 0.5 / settings.shadow_taps;
    const double radius = std::sqrt(a), angle = 2.0 * std::numbers::pi * b;
    const glm::dvec2 at = source.kind == kDiscSource ? radius * glm::dvec2(std::cos(angle), std::sin(angle))
                                                     : 2.0 * glm::dvec2(a, b) - 1.0;
    ShadowSource point = source;
    point.position += at.x * source.u + at.y * source.v;
    for (const gpu::ShadowView& view : usual_views(fit, point)) views.push_back(view);
  }
  return views;
}

const std::array<KernelCode, 1> kStages = {{{"shadow look-up", wavepath_look_up_average_spv}}};
constexpr std::array<std::size_t, 1> kOrder = {0};
const KernelProgram kProgram = {kStages, kOrder, shadow_layout};
const ShadowMapRecipe kRecipe = {.program = &kProgram, .views = views_from_points};
constexpr std::array<std::string_view, 4> kSettings = {"shadow-size", "shadow-bias", "shadow-source", "shadow-taps"};

} // namespace

constinit const ShadowKind kShadowAverage = {
    .name = "average",
    .summary = "the mean of shadow maps from --shadow-taps points of a lamp",
    .sources = kAreaSources,
    .settings = kSettings,
    .make = [](const ShadowContext& context) { return make_shadow_maps(kRecipe, context); },
};

} // namespace wavepath
