// Weighs the texels of an environment map; see environment_light.h.
#include "host/scene/pack/environment_light.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include <tbb/parallel_for.h>

#include "host/scene/pack/alias.h"
#include "host/scene/pack/emission.h"

namespace wavepath {
namespace {

// Of one texel of row y.
double texel_solid_angle(std::size_t y, std::size_t width, std::size_t height) {
  const auto polar = [&](std::size_t row) {
    return std::cos(std::numbers::pi * static_cast<double>(row) / static_cast<double>(height));
  };
  return 2.0 * std::numbers::pi / static_cast<double>(width) * (polar(y) - polar(y + 1));
}

// Luminance under the weights 1 2 1 / 2 4 2 / 1 2 1.
double tent_luminance(const Environment& map, std::size_t x, std::size_t y) {
  const std::size_t columns[3] = {(x + map.width - 1) % map.width, x, (x + 1) % map.width};
  const std::size_t rows[3] = {y > 0 ? y - 1 : 0, y, std::min<std::size_t>(y + 1, map.height - 1)};
  double sum = 0.0;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i)
      sum += (i == 1 ? 2.0 : 1.0) * (j == 1 ? 2.0 : 1.0) *
             luminance(glm::dvec3(map.radiance) * glm::dvec3(map.map[rows[j] * map.width + columns[i]]));
  return sum / 16.0;
}

} // namespace

double pack_environment(const Environment& environment, PackedScene& packed) {
  if (!environment.present()) return 0.0;
  if (environment.map.empty()) {
    packed.environment_radiance = environment.radiance;
    return 4.0 * std::numbers::pi * luminance(environment.radiance);
  }

  const std::size_t width = environment.width, height = environment.height;
  std::vector<double> weights(width * height);
  tbb::parallel_for(std::size_t{0}, height, [&](std::size_t y) {
    const double solid_angle = texel_solid_angle(y, width, height);
    for (std::size_t x = 0; x < width; ++x) weights[y * width + x] = tent_luminance(environment, x, y) * solid_angle;
  });
  const AliasTable table = build_alias_table(weights);
  if (table.threshold.empty()) return 0.0; // black all over
  weights = {};

  packed.environment_radiance = environment.radiance;
  packed.environment_rotation = environment.rotation;
  packed.environment_width = environment.width;
  packed.environment_height = environment.height;
  const std::vector<double> probability = alias_probabilities(table);
  packed.environment.resize(width * height);
  packed.environment_alias.resize(width * height);
  for (std::size_t i = 0; i < width * height; ++i) {
    packed.environment[i] = {environment.map[i], static_cast<float>(probability[i])};
    packed.environment_alias[i] = {std::bit_cast<std::uint32_t>(table.threshold[i]), table.alias[i]};
  }
  return table.total;
}

} // namespace wavepath
