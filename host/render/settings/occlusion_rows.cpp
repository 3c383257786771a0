#include "host/render/settings/occlusion_rows.h"

#include <fmt/format.h>

#include "host/render/settings/occlusion_settings.h"

namespace wavepath {
namespace {

using S = RenderSettings;

constexpr double kMostAoBias = 90.0; // degrees

} // namespace

std::vector<Setting> occlusion_rows() {
  std::vector<Setting> rows = {
      {.name = "occlusion",
       .value = ChoiceValue{&S::occlusion, kOcclusionNames},
       .meaning = fmt::format("how ambient occlusion is found: by rays, or among the depths that the picture shows: {}",
                              fmt::join(kOcclusionNames, ", ")),
       .placeholder = "NAME",
       .label = "occlusion",
       .study = std::vector<std::string_view>(kOcclusionNames.begin(), kOcclusionNames.end())},
      {.name = "ao-bias",
       .value = NumberValue{&S::ao_bias, 0.0, kMostAoBias},
       .meaning = "of hbao: elevation over the tangent plane up to which nothing occludes",
       .placeholder = "DEGREES",
       .study = {"0", "10", "30"}},
      {.name = "ao-thinness",
       .value = NumberValue{&S::ao_thinness, 0.0, 1.0},
       .meaning = "of gtao: share by which what is seen behind a body lowers its horizon; 0: bodies have no back",
       .placeholder = "SHARE",
       .study = {"0", "0.1", "0.5"}},
  };
  for (Setting& row : rows) {
    row.group = SettingGroup::special;
    row.offered = kByRender | kByView;
    row.takers = Takers::listed_else_refused;
  }
  return rows;
}

} // namespace wavepath
