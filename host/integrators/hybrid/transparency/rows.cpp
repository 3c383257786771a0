// The rows of the table of settings: values and meaning of what can be set about transparency.
#include "host/integrators/hybrid/transparency/catalogue.h"

namespace wavepath {
namespace {

using S = RenderSettings;

constexpr std::uint32_t kMostLayers = 64;

} // namespace

std::vector<Setting> transparency_rows() {
  static const std::vector<std::string_view> names = kTransparencyTechniques.names();
  return {
      {.name = "transparency",
       .value = ChoiceValue{&S::transparency, names},
       .meaning = "technique for BLEND surfaces; refractive is for glass. traced: rays pass at random. The others "
                  "rasterize layers",
       .label = "transparency",
       .study = names},
      {.name = "transparency-layers",
       .value = WholeValue{&S::transparency_layers, 1, kMostLayers},
       .meaning = "number of layers that are peeled off in front of the opaque surface",
       .placeholder = "N",
       .label = "layers",
       .study = {"1", "2", "4", "8"}},
      {.name = "transparency-samples",
       .value = WholeValue{&S::transparency_samples, 1, kMostLayers},
       .meaning = "samples of stochastic transparency for each sample of a pixel",
       .placeholder = "N",
       .label = "layer samples",
       .study = {"2", "8", "32"}},
  };
}

} // namespace wavepath
