// Weighted, blended transparency, which needs no order (McGuire and Bavoil 2013): layers are averaged, and nearer ones
// count for more. Exact for one layer, and for layers of one colour.
#include <array>

#include "host/integrators/hybrid/transparency/kinds.h"
#include "kernels/hybrid/hybrid_types.h"
#include "kernels/hybrid/transparency/layer_vert.spv.h"
#include "kernels/hybrid/transparency/layer_weighted_frag.spv.h"
#include "kernels/hybrid/transparency/transparency_types.h"
#include "kernels/hybrid/transparency/weighted_mean.spv.h"

namespace wavepath {
namespace {

constexpr ClearValue kNothing = {.colour = {0.0f, 0.0f, 0.0f, 1.0f}};
constexpr std::array<AttachmentInfo, 2> kWeightedAttachments{
    {{.name = "sum of layers", .clear = kNothing}, {.name = "weight of layers", .clear = kNothing}}};
constexpr std::array<std::uint32_t, 2> kBindings = {gpu::kBindLayerSums, gpu::kBindLayerWeights};
const LayerRecipe kWeightedRecipe = {.code = {"layers", wavepath_layer_vert_spv, wavepath_layer_weighted_frag_spv},
                                     .attachments = kWeightedAttachments,
                                     .state = {.blend = Blend::sum},
                                     .finish = {"weighted mean", wavepath_weighted_mean_spv},
                                     .bindings = kBindings};

} // namespace

constinit const TransparencyKind kTransparencyWeighted = {
    .name = "weighted",
    .summary = "averaged by weights that fall with depth (McGuire and Bavoil 2013)",
    .flag = gpu::kHybridLayers,
    .layers = &kWeightedRecipe,
};

} // namespace wavepath
