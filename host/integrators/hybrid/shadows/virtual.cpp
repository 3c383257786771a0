// Virtual shadow maps: of a large map only the pages are resident in which a frame's points are looked up.
#include <array>

#include "host/integrators/hybrid/shadows/kinds.h"
#include "host/integrators/hybrid/shadows/shadow_maps.h"
#include "kernels/hybrid/page_requests.spv.h"
#include "kernels/hybrid/shadows/look_up_virtual.spv.h"

namespace wavepath {
namespace {

const std::array<KernelCode, 2> kVirtualStages = {
    {{"shadow look-up", wavepath_look_up_virtual_spv}, {"shadow pages", wavepath_page_requests_spv}}};
constexpr std::array<std::size_t, 2> kVirtualOrder = {0, 1};
const KernelProgram kVirtualProgram = {kVirtualStages, kVirtualOrder, shadow_layout};
const ShadowMapRecipe kVirtualRecipe = {.pages = true};
constexpr std::array<std::string_view, 3> kVirtualSettings = {"shadow-size", "shadow-bias", "shadow-source"};

void check_draws_once(const RenderPlan& settings) {
  if (settings.shadow_bias == gpu::kBiasMidpoint)
    throw UsageError("--shadow-bias midpoint", "draws maps twice, and --shadows virtual draws its pages once",
                     "use another bias");
}

} // namespace

constinit const ShadowKind kShadowVirtual = {
    .name = "virtual",
    .summary = "a shadow map of which only pages that a frame asks for are resident",
    .sources = kAllSources,
    .settings = kVirtualSettings,
    .program = &kVirtualProgram,
    .maps = &kVirtualRecipe,
    .make = make_shadow_maps,
    .check = check_draws_once,
};

} // namespace wavepath
