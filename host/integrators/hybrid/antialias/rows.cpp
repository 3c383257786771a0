// The rows of the table of settings: values and meaning of what can be set about anti-aliasing.
#include <fmt/format.h>

#include "host/integrators/hybrid/antialias/catalogue.h"

namespace wavepath {

std::vector<Setting> antialias_rows() {
  static const std::vector<std::string_view> names = kAntialiasTechniques.names();
  return {{.name = "antialias",
           .value = ChoiceValue{&RenderSettings::antialias, names},
           .meaning = fmt::format("how edges are kept smooth: by the pixel filter over all samples, or as real-time "
                                  "rendering does it: {}",
                                  fmt::join(names, ", ")),
           .placeholder = "NAME",
           .label = "anti-aliasing",
           .study = names}};
}

} // namespace wavepath
