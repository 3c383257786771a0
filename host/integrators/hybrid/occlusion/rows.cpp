// The rows of the table of settings: values and meaning of what can be set about occlusion.
#include <span>

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
       .meaning = fmt::format(
           "technique for ambient occlusion. traced: rays. cones: cones through voxels (--voxels). The others "
           "use the depths of the picture: {}",
           fmt::join(std::span(names).subspan(1), ", ")),
       .placeholder = "NAME",
       .label = "occlusion",
       .study = names},
      {.name = "ao-bias",
       .value = NumberValue{&S::ao_bias, 0.0, kMostAoBias},
       .meaning = "--occlusion hbao: smallest elevation of an occluder over the tangent plane, in degrees",
       .placeholder = "DEGREES",
       .study = {"0", "10", "30"}},
      {.name = "ao-thinness",
       .value = NumberValue{&S::ao_thinness, 0.0, 1.0},
       .meaning = "--occlusion gtao: fraction by which surfaces behind an occluder lower its horizon. 0: occluders "
                  "have infinite depth",
       .placeholder = "FRACTION",
       .study = {"0", "0.1", "0.5"}},
  };
}

} // namespace wavepath
