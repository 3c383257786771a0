// Sample distribution shadow maps (Lauritzen, Salvi and Lefohn 2011): cascades fitted to the points that a frame shows,
// which the device reduces to bounds. These are read back, because the host leaves out of drawing what a view does not
// show.
#include <algorithm>
#include <array>
#include <bit>

#include "host/integrators/hybrid/shadows/cascade_views.h"
#include "host/integrators/hybrid/shadows/kinds.h"
#include "host/integrators/hybrid/shadows/shadow_maps.h"
#include "kernels/hybrid/depth_bounds.spv.h"
#include "kernels/hybrid/shadows/look_up_map.spv.h"
#include "kernels/hybrid/slice_bounds.spv.h"

namespace wavepath {
namespace {

enum SdsmStage : std::size_t { kSdsmLookUp, kDepthBounds, kSliceBounds, kSdsmStageCount };
const std::array<KernelCode, kSdsmStageCount> kSdsmStages = {{{"shadow look-up", wavepath_look_up_map_spv},
                                                              {"shadow bounds", wavepath_depth_bounds_spv},
                                                              {"shadow bounds", wavepath_slice_bounds_spv}}};
constexpr std::array<std::size_t, kSdsmStageCount> kSdsmOrder = {kSdsmLookUp, kSliceBounds, kDepthBounds};
const KernelProgram kSdsmProgram = {kSdsmStages, kSdsmOrder, shadow_layout};

constexpr std::uint32_t kNothingYet[] = {0xffffffffu, 0u}; // least and largest
constexpr double kMargin = 1e-6;                           // of the usual view: what its positions are rounded by

// Inverse of ordered_bits() in kernels/hybrid/visible_point.glsl.
float float_of(std::uint32_t ordered) {
  return std::bit_cast<float>(ordered & 0x80000000u ? ordered & 0x7fffffffu : ~ordered);
}

void fit_to_frame(const FrameFit& fit) {
  const std::vector<std::uint32_t> range = fit.reduce(kDepthBounds, {kNothingYet[0], kNothingYet[1]}, 0);
  if (range[0] > range[1]) return; // nothing is seen: any views will do
  fit.report.nearest = float_of(range[0]);
  fit.report.farthest = float_of(range[1]);
  const std::uint32_t parts = fit.settings.shadow_cascades;
  const std::vector<double> depths = split_depths(fit.report.nearest, fit.report.farthest, parts);
  std::vector<std::uint32_t> words;
  for (std::uint32_t i = 0; i < parts; ++i)
    words.push_back(std::bit_cast<std::uint32_t>(static_cast<float>(depths[i + 1])));
  for (std::size_t i = 0; i < 2 * fit.views.size(); ++i) words.insert(words.end(), {kNothingYet[0], kNothingYet[1]});
  const std::vector<std::uint32_t> boxes = fit.reduce(kSliceBounds, words, parts);
  for (std::size_t i = 0; i < fit.views.size(); ++i) {
    const std::uint32_t* box = &boxes[parts + 4 * i];
    if (box[0] > box[1]) {
      fit.views[i] = blind_view(fit.views[i]);
      continue;
    }
    const glm::dvec2 lo(float_of(box[0]), float_of(box[2])), hi(float_of(box[1]), float_of(box[3]));
    fit.views[i] = cropped_view(fit.views[i], lo - kMargin, hi + kMargin, fit.settings.shadow_size);
  }
}

const ShadowMapRecipe kSdsmRecipe = {
    .views =
        [](const ShadowFit& fit, const ShadowSource& source, const View&, const RenderPlan& settings) {
          return std::vector<gpu::ShadowView>(settings.shadow_cascades, parallel_view(fit, source.direction));
        },
    .frame_words = [](std::uint32_t views, const RenderPlan& settings) { return settings.shadow_cascades + 4 * views; },
    .fit_to_frame = fit_to_frame};
constexpr std::array<std::string_view, 4> kSdsmSettings = {"shadow-size", "shadow-bias", "shadow-source",
                                                           "shadow-cascades"};

} // namespace

constinit const ShadowKind kShadowSdsm = {
    .name = "sdsm",
    .summary = "cascades fitted to the points that a frame shows (Lauritzen et al. 2011)",
    .sources = kDirectionalSource,
    .settings = kSdsmSettings,
    .program = &kSdsmProgram,
    .maps = &kSdsmRecipe,
    .make = make_shadow_maps,
};

} // namespace wavepath
