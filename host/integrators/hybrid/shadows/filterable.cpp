// Techniques that average something over a map before it is looked up (kernels/hybrid/shadows/blur.glsl): variance maps
// (Donnelly and Lauritzen 2006), exponential ones (Annen et al. 2008), both at once (Lauritzen and McCool 2008), moment
// maps (Peters and Klein 2015), and leak tracing on these (Kern, Bruell and Grosch 2024).
#include <array>

#include "host/integrators/hybrid/shadows/kinds.h"
#include "host/integrators/hybrid/shadows/shadow_maps.h"
#include "kernels/hybrid/shadows/blur_columns.spv.h"
#include "kernels/hybrid/shadows/esm_rows.spv.h"
#include "kernels/hybrid/shadows/evsm_rows.spv.h"
#include "kernels/hybrid/shadows/look_up_esm.spv.h"
#include "kernels/hybrid/shadows/look_up_evsm.spv.h"
#include "kernels/hybrid/shadows/look_up_leak.spv.h"
#include "kernels/hybrid/shadows/look_up_moment.spv.h"
#include "kernels/hybrid/shadows/look_up_vsm.spv.h"
#include "kernels/hybrid/shadows/moment_columns.spv.h"
#include "kernels/hybrid/shadows/moment_rows.spv.h"
#include "kernels/hybrid/shadows/vsm_rows.spv.h"

namespace wavepath {
namespace {

enum FilterableStage : std::size_t { kFilterableLookUp, kBlurRows, kBlurColumns, kFilterableStageCount };
constexpr std::array<std::size_t, kFilterableStageCount> kFilterableOrder = {kFilterableLookUp, kBlurRows,
                                                                             kBlurColumns};
constexpr std::array<MapPass, 2> kBlurPasses = {{{kBlurRows}, {kBlurColumns}}};

using Spirv = std::span<const std::uint32_t>;
constexpr std::array<KernelCode, kFilterableStageCount> filterable(Spirv look_up, Spirv rows, Spirv columns) {
  return {{{"shadow look-up", look_up}, {"shadow rows", rows}, {"shadow columns", columns}}};
}

constexpr std::array kVsmStages =
                         filterable(wavepath_look_up_vsm_spv, wavepath_vsm_rows_spv, wavepath_blur_columns_spv),
                     kEsmStages =
                         filterable(wavepath_look_up_esm_spv, wavepath_esm_rows_spv, wavepath_blur_columns_spv),
                     kEvsmStages =
                         filterable(wavepath_look_up_evsm_spv, wavepath_evsm_rows_spv, wavepath_blur_columns_spv),
                     kMomentStages =
                         filterable(wavepath_look_up_moment_spv, wavepath_moment_rows_spv, wavepath_moment_columns_spv),
                     kLeakStages =
                         filterable(wavepath_look_up_leak_spv, wavepath_moment_rows_spv, wavepath_blur_columns_spv);
constexpr KernelProgram kVsmProgram = {kVsmStages, kFilterableOrder, shadow_layout},
                        kEsmProgram = {kEsmStages, kFilterableOrder, shadow_layout},
                        kEvsmProgram = {kEvsmStages, kFilterableOrder, shadow_layout},
                        kMomentProgram = {kMomentStages, kFilterableOrder, shadow_layout},
                        kLeakProgram = {kLeakStages, kFilterableOrder, shadow_layout};

// Exponent within the range of floats, with a margin for rounding. It is for the whole range of depths, as 40 is for -1
// to 1.
constexpr double kExponent = 80.0;

constexpr ShadowMapRecipe recipe(double exponent, bool counts = false) {
  return {.counts = counts,
          .guard = [](const RenderPlan& settings) { return settings.shadow_blur; },
          .filtered_bytes = [](const RenderPlan&) { return std::uint64_t{sizeof(gpu::vec4)}; },
          .scratch_bytes = [](const RenderPlan&) { return std::uint64_t{sizeof(gpu::vec4)}; },
          .passes = kBlurPasses,
          .exponent = exponent};
}
constexpr ShadowMapRecipe kMoments = recipe(0.0), kExponentials = recipe(kExponent), kTracesLeaks = recipe(0.0, true);

// Settings of these techniques. Some support the first four only; the last one is for exponential or moment maps.
constexpr std::array<std::string_view, 5> kExponentialSettings = {"shadow-size", "shadow-bias", "shadow-source",
                                                                  "shadow-blur", "shadow-exponent"},
                                          kMomentSettings = {"shadow-size", "shadow-bias", "shadow-source",
                                                             "shadow-blur", "shadow-bits"};
constexpr std::span kBlurSettings = std::span<const std::string_view>(kMomentSettings).first(4);

} // namespace

constinit const ShadowKind kShadowVsm = {
    .name = "vsm",
    .summary = "the most light that mean and variance of a map's depths allow (Donnelly and Lauritzen 2006)",
    .sources = kAllSources,
    .settings = kBlurSettings,
    .program = &kVsmProgram,
    .maps = &kMoments,
    .make = make_shadow_maps,
};

constinit const ShadowKind kShadowEsm = {
    .name = "esm",
    .summary = "a map's depths as exponentials, averaged (Annen et al. 2008)",
    .sources = kAllSources,
    .settings = kExponentialSettings,
    .program = &kEsmProgram,
    .maps = &kExponentials,
    .make = make_shadow_maps,
};

constinit const ShadowKind kShadowEvsm = {
    .name = "evsm",
    .summary = "the most light that mean and variance of exponentials of depth allow (Lauritzen and McCool 2008)",
    .sources = kAllSources,
    .settings = kExponentialSettings,
    .program = &kEvsmProgram,
    .maps = &kExponentials,
    .make = make_shadow_maps,
};

constinit const ShadowKind kShadowMoment = {
    .name = "moment",
    .summary = "the most light that four moments of a map's depths allow (Peters and Klein 2015)",
    .sources = kAllSources,
    .settings = kMomentSettings,
    .program = &kMomentProgram,
    .maps = &kMoments,
    .make = make_shadow_maps,
};

constinit const ShadowKind kShadowLeak = {
    .name = "leak",
    .summary = "a map and its moments where they agree, rays elsewhere (Kern, Bruell and Grosch 2024)",
    .sources = kPunctualSources,
    .settings = kBlurSettings,
    .program = &kLeakProgram,
    .maps = &kTracesLeaks,
    .make = make_shadow_maps,
};

} // namespace wavepath
