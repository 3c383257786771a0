#include "host/convert/environment.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "host/base/error.h"
#include "host/codecs/linear_picture.h"

namespace wavepath::convert {
namespace {

constexpr double kMapPi = 3.141592653589793;
constexpr std::uint32_t kMostEnvironmentSide = 16384, kMostMadeWidth = 8192;

glm::dvec3 pixel(const Environment& map, std::int64_t x, std::int64_t y) {
  const std::size_t i = 3 * (static_cast<std::size_t>(y) * map.width + static_cast<std::size_t>(x));
  return {map.pixels[i], map.pixels[i + 1], map.pixels[i + 2]};
}

// Bilinear. `wrap`: brings a pixel beyond the edge back to where the surface goes on.
template <class WrapPixel>
glm::dvec3 look_up(const Environment& map, double u, double v, const WrapPixel& wrap) {
  const double x = u * map.width - 0.5, y = v * map.height - 0.5;
  const double fx = x - std::floor(x), fy = y - std::floor(y);
  glm::dvec3 sum(0.0);
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      auto px = static_cast<std::int64_t>(std::floor(x)) + i, py = static_cast<std::int64_t>(std::floor(y)) + j;
      wrap(px, py);
      sum += (i ? fx : 1.0 - fx) * (j ? fy : 1.0 - fy) * pixel(map, px, py);
    }
  return sum;
}

// The direction of a point of a lat-long map of ours.
glm::dvec3 direction_at(double u, double v) {
  const double phi = (u - 0.5) * 2.0 * kMapPi, theta = v * kMapPi;
  return {std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)};
}

// A lat-long map of what `radiance` says of directions; the mean of 2x2 points in each pixel.
Environment sampled(std::uint32_t width, const std::function<glm::dvec3(const glm::dvec3&)>& radiance) {
  Environment map;
  map.width = std::clamp(width, 4u, kMostMadeWidth);
  map.height = map.width / 2;
  map.pixels.reserve(std::size_t{map.width} * map.height * 3);
  for (std::uint32_t y = 0; y < map.height; ++y)
    for (std::uint32_t x = 0; x < map.width; ++x) {
      glm::dvec3 sum(0.0);
      for (int k = 0; k < 4; ++k)
        sum += radiance(direction_at((x + 0.25 + 0.5 * (k & 1)) / map.width, (y + 0.25 + 0.5 * (k >> 1)) / map.height));
      for (int c = 0; c < 3; ++c) map.pixels.push_back(static_cast<float>(0.25 * sum[c]));
    }
  return map;
}

glm::dmat3 light_from_world(const std::string& path, const glm::dmat4& world_from_light) {
  const glm::dmat3 matrix(world_from_light);
  if (!(std::abs(glm::determinant(matrix)) > 0.0))
    throw Error(path, "lights from a transform that is flat", "correct the scene");
  return glm::inverse(matrix);
}

glm::dvec2 equal_area_square(const glm::dvec3& d) { // Clarberg 2008
  const double x = std::abs(d.x), y = std::abs(d.y), z = std::abs(d.z);
  const double r = std::sqrt(std::max(0.0, 1.0 - z));
  const double phi = std::max(x, y) > 0.0 ? std::atan2(y, x) * 2.0 / kMapPi : 0.0;
  double v = phi * r, u = r - v;
  if (d.z < 0.0) u = 1.0 - std::exchange(v, 1.0 - u);
  return {0.5 * (std::copysign(u, d.x) + 1.0), 0.5 * (std::copysign(v, d.y) + 1.0)};
}

} // namespace

Environment read_environment_pixels(const std::string& path) {
  ReadRequest request;
  request.light = true;
  request.check = [&](std::uint32_t width, std::uint32_t height) {
    if (width > kMostEnvironmentSide || height > kMostEnvironmentSide)
      throw Error(path, "is larger than 16384 x 16384 pixels", "make it smaller");
  };
  const LinearPicture picture = read_linear(path, request);
  Environment map;
  map.width = picture.width, map.height = picture.height;
  map.pixels.reserve(std::size_t{map.width} * map.height * 3);
  for (std::size_t i = 0; i < std::size_t{map.width} * map.height; ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const float value = picture.planes[c][i];
      map.pixels.push_back(std::isfinite(value) ? value : 0.0f);
    }
  return map;
}

void add_environment(Description& scene, const glm::dvec3& color) {
  if (!scene.environment) scene.environment.emplace();
  Environment& environment = *scene.environment;
  environment.color += color;
  for (std::size_t i = 0; i < environment.pixels.size(); ++i)
    environment.pixels[i] += static_cast<float>(color[static_cast<int>(i % 3)]);
}

void add_environment(Description& scene, const Environment& map, const glm::dvec3& gain) {
  if (scene.environment && !scene.environment->pixels.empty()) {
    scene.losses.add("environment map besides another one: left out");
    return;
  }
  const glm::dvec3 color = scene.environment ? scene.environment->color : glm::dvec3(0.0);
  scene.environment = map;
  for (std::size_t i = 0; i < map.pixels.size(); ++i) {
    const int c = static_cast<int>(i % 3);
    scene.environment->pixels[i] = static_cast<float>(static_cast<double>(map.pixels[i]) * gain[c] + color[c]);
  }
}

Environment equal_area_environment(const std::string& path, const glm::dmat4& world_from_light) {
  const Environment square = read_environment_pixels(path);
  if (square.width != square.height)
    throw Error(path, "is not square, as environments of pbrt-v4 are", "convert it with `imgtool makeequiarea`");
  const glm::dmat3 matrix = light_from_world(path, world_from_light);
  const auto side = static_cast<std::int64_t>(square.width);
  const auto wrap = [side](std::int64_t& x, std::int64_t& y) {
    if (x < 0) x = -x - 1, y = side - 1 - y;
    if (x >= side) x = 2 * side - 1 - x, y = side - 1 - y;
    if (y < 0) x = side - 1 - x, y = -y - 1;
    if (y >= side) x = side - 1 - x, y = 2 * side - 1 - y;
    x = std::clamp<std::int64_t>(x, 0, side - 1), y = std::clamp<std::int64_t>(y, 0, side - 1);
  };
  return sampled(square.width * 2, [&](const glm::dvec3& world) {
    const glm::dvec2 at = equal_area_square(glm::normalize(matrix * world));
    return look_up(square, at.x, at.y, wrap);
  });
}

Environment lat_long_environment(const std::string& path, const glm::dmat4& world_from_light) {
  const Environment source = read_environment_pixels(path);
  const glm::dmat3 matrix = light_from_world(path, world_from_light);
  const auto width = static_cast<std::int64_t>(source.width), height = static_cast<std::int64_t>(source.height);
  const auto wrap = [=](std::int64_t& x, std::int64_t& y) {
    x = (x % width + width) % width;
    y = std::clamp<std::int64_t>(y, 0, height - 1);
  };
  return sampled(source.width, [&](const glm::dvec3& world) {
    const glm::dvec3 d = glm::normalize(matrix * world);
    const double u = std::atan2(d.x, -d.z) / (2.0 * kMapPi);
    return look_up(source, u - std::floor(u), std::acos(std::clamp(d.y, -1.0, 1.0)) / kMapPi, wrap);
  });
}

void move_environment(Environment& map, const glm::dmat4& root) {
  if (map.pixels.empty() || glm::dmat3(root) == glm::dmat3(1.0)) return;
  // Mirrored along z: a column u is the one at 1 - u, so that nothing has to be filtered again.
  for (std::uint32_t y = 0; y < map.height; ++y)
    for (std::uint32_t x = 0; x < map.width / 2; ++x)
      for (std::uint32_t c = 0; c < 3; ++c)
        std::swap(map.pixels[3 * (std::size_t{y} * map.width + x) + c],
                  map.pixels[3 * (std::size_t{y} * map.width + (map.width - 1 - x)) + c]);
}

} // namespace wavepath::convert
