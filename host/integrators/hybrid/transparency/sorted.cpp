// Layers blended in the order of their triangles' middles, from back to front (Porter and Duff 1984). Triangles that
// cross, or that overlap in a cycle, have no such order.
#include <array>

#include "host/integrators/hybrid/transparency/kinds.h"
#include "kernels/hybrid/hybrid_types.h"
#include "kernels/hybrid/transparency/layer_sorted_frag.spv.h"
#include "kernels/hybrid/transparency/layer_vert.spv.h"

namespace wavepath {
namespace {

constexpr std::array<AttachmentInfo, 1> kSortedAttachments{
    {{.name = "layers", .clear = {.colour = {0.0f, 0.0f, 0.0f, 1.0f}}}}};
const LayerRecipe kSortedRecipe = {.code = {"layers", wavepath_layer_vert_spv, wavepath_layer_sorted_frag_spv},
                                   .attachments = kSortedAttachments,
                                   .state = {.blend = Blend::over},
                                   .sorts = true};

} // namespace

constinit const TransparencyKind kTransparencySorted = {
    .name = "sorted",
    .summary = "blended in the order of the middles of their triangles",
    .flag = gpu::kHybridLayers,
    .layers = &kSortedRecipe,
};

} // namespace wavepath
