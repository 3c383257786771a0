// The rows of the table of settings: values and meaning of what can be set about reflections.
#include <span>

#include <fmt/format.h>

#include "host/integrators/hybrid/reflections/catalogue.h"

namespace wavepath {

std::vector<Setting> reflection_rows() {
  static const std::vector<std::string_view> names = kReflectionTechniques.names();
  return {
      {.name = "reflections",
       .value = ChoiceValue{&RenderSettings::reflections, names},
       .meaning = fmt::format("what mirrors show of lit surfaces. none: nothing but lamps and the environment. "
                              "Techniques: {}",
                              fmt::join(std::span(names).subspan(1), ", ")),
       .placeholder = "NAME",
       .label = "reflections",
       .study = names},
      {.name = "reflection-threshold",
       .value = NumberValue{&RenderSettings::reflection_threshold, 0.0, 1.0},
       .meaning =
           "Hall's rule: only surfaces that reflect at least this fraction of light head-on, and whose roughness "
           "is below 0.3, are mirrors. 0.04 is that of glass and plastic",
       .placeholder = "FRACTION",
       .study = {"0", "0.1", "0.5"}},
  };
}

} // namespace wavepath
