#include "host/scene/blackbody.h"

#include <cmath>

#include "host/scene/spectrum.h"

namespace wavepath {

glm::dvec3 blackbody_color(double kelvin) {
  constexpr double kWien = 2.897771955e6; // nm K: wavelength of the maximum times temperature
  if (!(kelvin > kDarkKelvin)) return glm::dvec3(0.0);
  return glm::max(light_color(black_body(kelvin)) / planck(kWien / kelvin, kelvin), 0.0);
}

std::vector<glm::vec4> blackbody_table(float lowest, float highest, std::uint32_t count) {
  std::vector<glm::vec4> table;
  const double ratio = double{highest} / double{lowest};
  for (std::uint32_t i = 0; i < count; ++i)
    table.emplace_back(glm::vec3(blackbody_color(double{lowest} * std::pow(ratio, double(i) / double(count - 1)))),
                       0.0f);
  return table;
}

} // namespace wavepath
