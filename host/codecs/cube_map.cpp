#include "host/codecs/cube_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <OpenEXR/ImfEnvmap.h>

namespace wavepath {
namespace {

float sample_face(const std::vector<float>& faces, std::uint32_t width, const Imath::V3f& direction) {
  const int size = static_cast<int>(width);
  const Imath::Box2i window({0, 0}, {size - 1, 6 * size - 1});
  Imf::CubeMapFace face{};
  Imath::V2f in_face;
  Imf::CubeMap::faceAndPixelPosition(direction, window, face, in_face);
  const Imath::V2f position = Imf::CubeMap::pixelPosition(face, window, in_face);
  const Imath::Box2i bounds = Imf::CubeMap::dataWindowForFace(face, window);
  const auto clamped = [](float value, int least, int most) {
    return std::clamp(value, static_cast<float>(least), static_cast<float>(most));
  };
  const float x = clamped(position.x, bounds.min.x, bounds.max.x), y = clamped(position.y, bounds.min.y, bounds.max.y);
  const int left = static_cast<int>(x), top = static_cast<int>(y);
  const int right = std::min(left + 1, bounds.max.x), bottom = std::min(top + 1, bounds.max.y);
  const auto texel = [&](int column, int row) {
    return faces[static_cast<std::size_t>(row) * width + static_cast<std::size_t>(column)];
  };
  const float across = x - static_cast<float>(left), down = y - static_cast<float>(top);
  return std::lerp(std::lerp(texel(left, top), texel(right, top), across),
                   std::lerp(texel(left, bottom), texel(right, bottom), across), down);
}

} // namespace

bool is_stacked_cube(std::uint32_t width, std::uint32_t height) {
  return width > 0 && height % 6 == 0 && height / 6 == width;
}

std::vector<float> lat_long_of_cube(const std::vector<float>& faces, std::uint32_t width) {
  const std::size_t columns = std::size_t{4} * width, rows = std::size_t{2} * width;
  std::vector<float> map(columns * rows);
  for (std::size_t row = 0; row < rows; ++row) {
    const double polar = std::numbers::pi * (static_cast<double>(row) + 0.5) / static_cast<double>(rows);
    for (std::size_t column = 0; column < columns; ++column) {
      const double azimuth =
          2.0 * std::numbers::pi * ((static_cast<double>(column) + 0.5) / static_cast<double>(columns) - 0.5);
      const Imath::V3f direction(static_cast<float>(std::sin(polar) * std::cos(azimuth)),
                                 static_cast<float>(std::cos(polar)),
                                 static_cast<float>(std::sin(polar) * std::sin(azimuth)));
      map[row * columns + column] = sample_face(faces, width, direction);
    }
  }
  return map;
}

} // namespace wavepath
