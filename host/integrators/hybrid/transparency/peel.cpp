// Depth peeling (Everitt 2001): every pass finds the nearest layer behind the last one, pixel by pixel. Exact as far as
// --transparency-layers reach.
#include "host/integrators/hybrid/transparency/found_layers.h"
#include "host/integrators/hybrid/transparency/kinds.h"
#include "kernels/hybrid/hybrid_types.h"
#include "kernels/hybrid/transparency/layer_peel_frag.spv.h"
#include "kernels/hybrid/transparency/layer_vert.spv.h"
#include "kernels/hybrid/transparency/peel_under.spv.h"

namespace wavepath {
namespace {

const LayerRecipe kPeelRecipe = {.code = {"layers", wavepath_layer_vert_spv, wavepath_layer_peel_frag_spv},
                                 .attachments = kFoundLayer,
                                 .finish = {"peel", wavepath_peel_under_spv},
                                 .passes = [](const RenderPlan& settings) { return settings.transparency_layers; },
                                 .bindings = kFoundLayerBindings};
constexpr std::array<std::string_view, 1> kPeelSettings = {"transparency-layers"};

} // namespace

constinit const TransparencyKind kTransparencyPeel = {
    .name = "peel",
    .summary = "peeled off one by one, the nearest first (Everitt 2001)",
    .settings = kPeelSettings,
    .flag = gpu::kHybridLayers,
    .layers = &kPeelRecipe,
};

} // namespace wavepath
