// The rows of the table of settings: values and meaning of what can be set about occlusion.
#include <fmt/format.h>

#include "host/integrators/hybrid/occlusion/catalogue.h"

namespace wavepath {
namespace {

using S = RenderSettings;

constexpr double kMostAoBias = 90.0; // degrees

} // namespace

std::vector<Setting> occlusion_rows() {
  static const std::vector<std::string_view> names = kOcclusionTechniques.names();
  return {
      {.name = "occlusion",
       .value = ChoiceValue{&S::occlusion, names},
       .meaning = fmt::format("how ambient occlusion is found: by rays, or among the depths that the picture shows: {}",
                              fmt::join(names, ", ")),
       .placeholder = "NAME",
       .label = "occlusion",
       .study = names},
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
}

} // namespace wavepath
