#include "host/integrators/automatic/kind.h"

#include <array>

#include "host/integrators/bidirectional/bidirectional.h"
#include "host/integrators/bidirectional/kind.h"
#include "host/integrators/path/kind.h"

namespace wavepath {
namespace {

constexpr std::array<std::string_view, 12> kSettings = {"adaptive",    "hemisphere", "direct",   "light-samples",
                                                        "sky-samples", "reuse",      "aperture", "focus",
                                                        "blades",      "shutter",    "denoise",  "terminator"};

std::vector<RenderPlan> candidates(const RenderPlan& settings, const PackedScene& scene) {
  RenderPlan path = settings;
  path.integrator = &kPath;
  RenderPlan guided = path;
  guided.guide = true;
  RenderPlan bidirectional = settings;
  bidirectional.integrator = &kBidirectional;
  bidirectional.techniques &= ~gpu::kTechniqueMerge; // what is taken without being asked for is not biased
  std::vector<RenderPlan> all = {path, guided};
  const bool asks_for_path = settings.adaptive == kAdaptiveOn;
  if (!asks_for_path && settings.aovs.empty() && !settings.moving && settings.terminator == gpu::kTerminatorFacets &&
      !(scene.features & kBidirectionalLacks))
    all.push_back(bidirectional);
  return all;
}

} // namespace

const IntegratorKind& automatic_integrator() {
  static const IntegratorKind kAutomatic = [] {
    IntegratorKind kind = kPath;
    kind.name = "auto";
    kind.summary = "the best of path, path --guide and bidirectional, by short discarded renders (pilots)";
    kind.settings = kSettings;
    kind.candidates = candidates;
    return kind;
  }();
  return kAutomatic;
}

} // namespace wavepath
