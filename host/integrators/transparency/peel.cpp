// Depth peeling (Everitt 2001): every pass finds the nearest layer behind the last one, pixel by pixel. Exact as far as
// --transparency-layers reach.
#include <array>

#include "host/integrators/transparency/kinds.h"
#include "kernels/hybrid/hybrid_types.h"
#include "kernels/transparency/layer_peel_frag.spv.h"
#include "kernels/transparency/layer_vert.spv.h"
#include "kernels/transparency/peel_under.spv.h"
#include "kernels/transparency/transparency_types.h"

namespace wavepath {
namespace {

constexpr std::array<AttachmentInfo, 2> kAttachments{
    {{.name = "layer", .format = ImageFormat::rg32ui, .clear = {.words = {gpu::kNone, gpu::kNone}}},
     {.name = "depth", .format = ImageFormat::depth32f, .clear = {.depth = 0.0f}}}};
constexpr std::array<std::uint32_t, 1> kBindings = {gpu::kBindLayerSeen};
const LayerRecipe kRecipe = {.code = {"layers", wavepath_layer_vert_spv, wavepath_layer_peel_frag_spv},
                             .attachments = kAttachments,
                             .state = {},
                             .finish = {"peel", wavepath_peel_under_spv},
                             .passes = [](const RenderSettings& settings) { return settings.transparency_layers; },
                             .bindings = kBindings};
constexpr std::array<std::string_view, 1> kSettings = {"transparency-layers"};

} // namespace

constinit const TransparencyKind kTransparencyPeel = {
    .name = "peel",
    .summary = "the nearest layers, peeled off one by one (Everitt 2001)",
    .settings = kSettings,
    .flag = gpu::kHybridLayers,
    .layers = &kRecipe,
};

} // namespace wavepath
