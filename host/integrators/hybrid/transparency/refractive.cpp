// Refraction in screen space (Wyman 2005): transmitting surfaces are left out of the opaque picture, and bend the view
// of it. What the picture does not show is not seen through them, other transmitting bodies among it.
#include "host/integrators/hybrid/transparency/found_layers.h"
#include "host/integrators/hybrid/transparency/kinds.h"
#include "kernels/hybrid/hybrid_types.h"
#include "kernels/hybrid/transparency/layer_peel_frag.spv.h"
#include "kernels/hybrid/transparency/layer_vert.spv.h"
#include "kernels/hybrid/transparency/refract.spv.h"

namespace wavepath {
namespace {

const LayerRecipe kRefractiveRecipe = {
    .code = {"layers", wavepath_layer_vert_spv, wavepath_layer_peel_frag_spv},
    .attachments = kFoundLayer,
    .finish = {"refract", wavepath_refract_spv},
    .passes = [](const RenderPlan&) { return 2u; }, // where rays enter, and leave
    .bindings = kFoundLayerBindings,
    .holds = [](const gpu::Material& material) { return material.transmission > 0.0f; }};

} // namespace

constinit const TransparencyKind kTransparencyRefractive = {
    .name = "refractive",
    .summary = "bent views of the opaque picture (Wyman 2005)",
    .subject = "surfaces that transmit",
    .flag = gpu::kHybridRefractive,
    .layers = &kRefractiveRecipe,
};

} // namespace wavepath
