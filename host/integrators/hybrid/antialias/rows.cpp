// The rows of the table of settings: values and meaning of what can be set about anti-aliasing.
#include <span>

#include <fmt/format.h>

#include "host/integrators/hybrid/antialias/catalogue.h"

namespace wavepath {

std::vector<Setting> antialias_rows() {
  static const std::vector<std::string_view> names = kAntialiasTechniques.names();
  return {{.name = "antialias",
           .value = ChoiceValue{&RenderSettings::antialias, names},
           .meaning = fmt::format("anti-aliasing. filter: the pixel filter over all samples. The others are techniques "
                                  "of real-time rendering: {}",
                                  fmt::join(std::span(names).subspan(1), ", ")),
           .placeholder = "NAME",
           .label = "anti-aliasing",
           .study = names}};
}

} // namespace wavepath
