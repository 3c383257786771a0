#include "host/render/settings/antialias_rows.h"

#include <fmt/format.h>

#include "host/render/settings/antialias_settings.h"

namespace wavepath {

std::vector<Setting> antialias_rows() {
  return {{.name = "antialias",
           .value = ChoiceValue{&RenderSettings::antialias, kAntialiasNames},
           .meaning = fmt::format("how edges are kept smooth: by the pixel filter over all samples, or as real-time "
                                  "rendering does it: {}",
                                  fmt::join(kAntialiasNames, ", ")),
           .placeholder = "NAME",
           .group = SettingGroup::special,
           .takers = Takers::listed_else_refused,
           .offered = kByRender | kByView,
           .label = "anti-aliasing",
           .study = std::vector<std::string_view>(kAntialiasNames.begin(), kAntialiasNames.end())}};
}

} // namespace wavepath
