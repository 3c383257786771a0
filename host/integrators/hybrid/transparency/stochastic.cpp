// Stochastic transparency (Enderton et al. 2010): a fixed number of samples a pixel, of which a layer covers as many as
// it is opaque. Right on average whatever the order; without the correction of the total opacity, which needs another
// pass.
#include "host/integrators/hybrid/transparency/found_layers.h"
#include "host/integrators/hybrid/transparency/kinds.h"
#include "kernels/hybrid/hybrid_types.h"
#include "kernels/hybrid/transparency/layer_stochastic_frag.spv.h"
#include "kernels/hybrid/transparency/layer_vert.spv.h"
#include "kernels/hybrid/transparency/stochastic_mean.spv.h"

namespace wavepath {
namespace {

const LayerRecipe kStochasticRecipe = {
    .code = {"layers", wavepath_layer_vert_spv, wavepath_layer_stochastic_frag_spv},
    .attachments = kFoundLayer,
    .finish = {"stochastic mean", wavepath_stochastic_mean_spv},
    .passes = [](const RenderPlan& settings) { return settings.transparency_samples; },
    .bindings = kFoundLayerBindings};
constexpr std::array<std::string_view, 1> kStochasticSettings = {"transparency-samples"};

} // namespace

constinit const TransparencyKind kTransparencyStochastic = {
    .name = "stochastic",
    .summary = "sampled at a fixed number of random positions (Enderton et al. 2010)",
    .settings = kStochasticSettings,
    .flag = gpu::kHybridLayers,
    .layers = &kStochasticRecipe,
};

} // namespace wavepath
