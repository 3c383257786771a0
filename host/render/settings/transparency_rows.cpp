#include "host/render/settings/transparency_rows.h"

#include "host/render/settings/transparency_settings.h"

namespace wavepath {
namespace {

using S = RenderSettings;

constexpr std::uint32_t kMostLayers = 64;

} // namespace

std::vector<Setting> transparency_rows() {
  std::vector<Setting> rows = {
      {.name = "transparency",
       .value = ChoiceValue{&S::transparency, kTransparencyNames},
       .meaning = "how BLEND surfaces (of refractive: glass) are seen through: at random, or by rasterized layers",
       .label = "transparency",
       .study = std::vector<std::string_view>(kTransparencyNames.begin(), kTransparencyNames.end())},
      {.name = "transparency-layers",
       .value = WholeValue{&S::transparency_layers, 1, kMostLayers},
       .meaning = "layers that are peeled off in front of what is opaque",
       .placeholder = "N",
       .label = "layers",
       .study = {"1", "2", "4", "8"}},
      {.name = "transparency-samples",
       .value = WholeValue{&S::transparency_samples, 1, kMostLayers},
       .meaning = "of stochastic transparency, for every sample of a pixel",
       .placeholder = "N",
       .label = "layer samples",
       .study = {"2", "8", "32"}},
  };
  for (Setting& row : rows) {
    row.group = SettingGroup::special;
    row.offered = kByRender | kByView;
    row.takers = Takers::listed_else_refused;
  }
  return rows;
}

} // namespace wavepath
