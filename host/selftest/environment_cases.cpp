// Cases of environment maps: a sun's disc in a dark sky, one texel that outshines all, black maps and broken ones.
#include <cmath>
#include <filesystem>
#include <numbers>

#include <fmt/format.h>
#include <unistd.h>

#include "host/base/error.h"
#include "host/picture/files/picture_io.h"
#include "host/scene/staging/environment.h"
#include "host/selftest/oracles.h"
#include "host/selftest/scenes.h"
#include "host/selftest/selftest.h"
#include "host/selftest/studio.h"

namespace wavepath {
namespace {

using std::numbers::pi;

Environment uniform_map(std::uint32_t width, float radiance) {
  Environment map;
  map.radiance = glm::vec3(1.0f);
  map.width = width, map.height = width / 2;
  map.map.assign(std::size_t{map.width} * map.height, glm::vec3(radiance));
  return map;
}

glm::dvec3 direction_at(const Environment& map, double column, double row) {
  return environment_direction({column / map.width, row / map.height}, 0.0);
}

double solid_angle(const Environment& map, double row, double texels) { // of a piece of 1 / texels of a texel's sides
  const double step = 1.0 / texels / map.height;
  return 2.0 * pi / (map.width * texels) * pi * step * std::sin(pi * row / map.height);
}

// A white floor under the map, seen at one point.
Scene under_sky(const Environment& map) {
  Scene scene;
  add_triangles(scene, floor_quad(1.0f), add_lambert(scene, glm::vec3(1.0f)));
  scene.environment = map;
  look_down(scene, 1e-6, 0.05);
  return scene;
}

constexpr double kSunRadius = 0.2666 * pi / 180.0, kSunRadiance = 1.6e9, kSky = 0.1;

// A disc in a sky of `kSky`: each texel holds what of it the disc covers. `sun`: the direction that is its middle.
Environment sun_and_sky(std::uint32_t width, glm::dvec3& sun) {
  Environment map = uniform_map(width, static_cast<float>(kSky));
  constexpr int kPieces = 16;
  const double column = 0.3 * width + 0.37, row = 0.17 * width + 0.21; // 28.8 degrees above the horizon
  sun = direction_at(map, column, row);
  const int reach_rows = static_cast<int>(std::ceil(kSunRadius / pi * map.height)) + 1, reach_columns = 2 * reach_rows;
  for (int y = static_cast<int>(row) - reach_rows; y <= static_cast<int>(row) + reach_rows; ++y)
    for (int x = static_cast<int>(column) - reach_columns; x <= static_cast<int>(column) + reach_columns; ++x) {
      int covered = 0;
      for (int piece = 0; piece < kPieces * kPieces; ++piece) {
        const double u = x + (piece % kPieces + 0.5) / kPieces, v = y + (piece / kPieces + 0.5) / kPieces;
        covered += glm::length(glm::cross(direction_at(map, u, v), sun)) < std::sin(kSunRadius);
      }
      const double fraction = static_cast<double>(covered) / (kPieces * kPieces);
      map.map[static_cast<std::size_t>(y) * width + x] += glm::vec3(static_cast<float>(kSunRadiance * fraction));
    }
  return map;
}

// In the sun's light, and in the shade of a plate that covers it, where the sky is all there is.
Measurement sun_in_sky(const SelftestContext& context) {
  glm::dvec3 sun;
  Scene scene = under_sky(sun_and_sky(context.full ? 8192 : 2048, sun));
  const double solid_angle_of_disc = 2.0 * pi * (1.0 - std::cos(kSunRadius)); // 6.8018e-5 sr
  const double expected = kSunRadiance * solid_angle_of_disc * sun.y + pi * kSky;
  Studio studio(context);
  Worst worst;
  const RenderPlan settings = square(16, context.full ? 4096 : 512, 1);
  worst.add(studio.measure(scene, settings), expected / pi, 1e-3 * expected / pi, "in the sun");

  const glm::dvec3 aside = glm::normalize(glm::cross(sun, glm::dvec3(0, 1, 0))), over = glm::cross(aside, sun);
  const float half = 0.05f; // ten times the sun, half a degree more than what bilinear interpolation spreads it over
  const glm::vec3 a = 2.0f * half * glm::vec3(aside), b = 2.0f * half * glm::vec3(over);
  const Triangles plate = quad(glm::vec3(sun) - 0.5f * (a + b), a, b);
  add_triangles(scene, plate, add_lambert(scene, glm::vec3(0.0f)));
  const double hidden = std::max(irradiance(plate), irradiance(flipped(plate))); // only the face it turns to us counts
  worst.add(studio.measure(scene, settings), kSky * (1.0 - hidden / pi), 1e-5, "in the shade");
  return worst.judge();
}

// One texel of 1e9 in a black map: the tent that bilinear interpolation makes of it, summed in small pieces.
void try_one_texel(const SelftestContext& context, Studio& studio, Worst& worst) {
  const std::uint32_t width = context.full ? 8192 : 2048;
  Environment map = uniform_map(width, 0.0f);
  const std::uint32_t column = width / 3, row = width / 7;
  map.map[std::size_t{row} * width + column] = glm::vec3(1e9f);
  constexpr int kPieces = 64;
  double expected = 0.0;
  for (int j = 0; j < 2 * kPieces; ++j)
    for (int i = 0; i < 2 * kPieces; ++i) {
      const double u = (i + 0.5) / kPieces - 1.0, v = (j + 0.5) / kPieces - 1.0; // from the texel's centre
      const double x = column + 0.5 + u, y = row + 0.5 + v;
      expected += 1e9 * (1.0 - std::abs(u)) * (1.0 - std::abs(v)) * direction_at(map, x, y).y *
                  solid_angle(map, y, kPieces) / pi;
    }
  const Estimate estimate = studio.measure(under_sky(map), square(16, context.full ? 4096 : 512, 1));
  worst.add(estimate, expected, 1e-4 * expected, fmt::format("one texel of 1e9 in a map of {} x {}", width, width / 2));
}

// Whether a map with this value in one texel is refused when its file is read.
bool rejects(float texel) {
  Picture picture{4, 2, {}};
  for (const char* name : {"R", "G", "B", "A"}) picture.channels.push_back({name, std::vector<float>(8, 1.0f)});
  picture.channels[1].values[5] = texel;
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / fmt::format("wavepath_selftest_{}.exr", getpid());
  write_picture(path.string(), picture, {}, {});
  bool rejected = false;
  try {
    load_environment(path.string());
  } catch (const Error&) {
    rejected = true;
  }
  std::filesystem::remove(path);
  return rejected;
}

Measurement texel_extremes(const SelftestContext& context) {
  Studio studio(context);
  Worst worst;
  try_one_texel(context, studio, worst);
  const Estimate black = studio.measure(under_sky(uniform_map(64, 0.0f)), square(16, 16, 1), 1);
  worst.add(black.nonfinite > 0 ? std::nan("") : black.largest, 0.0, 0.0, "black map");
  worst.add(rejects(std::nanf("")), 1.0, 0.0, "a NaN texel is refused");
  worst.add(rejects(std::numeric_limits<float>::infinity()), 1.0, 0.0, "an infinite texel is refused");
  worst.add(rejects(-1.0f), 1.0, 0.0, "a negative texel is refused");
  worst.add(rejects(1.0f), 0.0, 0.0, "a good map is refused");
  return worst.judge();
}

constexpr SelftestCase kEnvironmentCases[] = {
    {33, "sun of 1.6e9 in a dark sky", "outdoor scenes are too bright or too dark, in the sun or in the shade",
     sun_in_sky},
    {34, "environment texels 1e9, black, NaN",
     "small bright windows or lamps in an environment are lost, or the whole picture is", texel_extremes},
};

} // namespace

std::span<const SelftestCase> environment_cases() { return kEnvironmentCases; }

} // namespace wavepath
