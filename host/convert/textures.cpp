#include "host/convert/textures.h"

#include <algorithm>
#include <initializer_list>

namespace wavepath::convert {
namespace {

constexpr const char* kOtherCoordinates =
    "textures of one material with different coordinates: their means are combined instead";

bool same_coordinates(const Texture& a, const Texture& b) {
  return a.uv_scale == b.uv_scale && a.uv_offset == b.uv_offset && a.clamps == b.clamps;
}

// The textures that have images all in the coordinates of the first of them; the others become constants.
struct Aligned {
  std::vector<Texture> textures;
  Texture coordinates; // of the first image
  std::uint32_t width = 1, height = 1;
  bool is_constant = true, nearest = true;
};

Aligned aligned(Description& scene, std::initializer_list<Texture> textures) {
  Aligned all;
  for (Texture texture : textures) {
    if (!texture.is_constant()) {
      if (all.is_constant) {
        all.coordinates = texture;
        all.is_constant = false;
      }
      if (same_coordinates(all.coordinates, texture)) {
        const Pixels& pixels = scene.images.pixels(texture.image);
        all.width = std::max(all.width, pixels.width), all.height = std::max(all.height, pixels.height);
        all.nearest &= texture.nearest;
      } else {
        scene.losses.add(kOtherCoordinates);
        texture = constant(mean(scene, texture));
      }
    }
    all.textures.push_back(texture);
  }
  return all;
}

// `value` of the colours and alphas of all textures at every pixel.
template <class Value>
Texture combined(Description& scene, std::initializer_list<Texture> textures, Holds holds, const Value& value) {
  const Aligned all = aligned(scene, textures);
  std::vector<glm::dvec4> at(all.textures.size(), glm::dvec4(1.0));
  std::vector<const Pixels*> images;
  for (const Texture& texture : all.textures)
    images.push_back(texture.is_constant() ? nullptr : &scene.images.pixels(texture.image));
  const auto fill = [&](double u, double v) {
    for (std::size_t i = 0; i < at.size(); ++i) {
      at[i] = glm::dvec4(all.textures[i].factor, 1.0);
      if (images[i]) at[i] *= glm::dvec4(images[i]->at(u, v));
    }
  };
  if (all.is_constant) {
    fill(0.0, 0.0);
    return constant(glm::dvec3(value(at)));
  }
  Pixels pixels{all.width, all.height, {}};
  pixels.values.reserve(std::size_t{all.width} * all.height);
  for (std::uint32_t y = 0; y < all.height; ++y)
    for (std::uint32_t x = 0; x < all.width; ++x) {
      fill((x + 0.5) / all.width, (y + 0.5) / all.height);
      pixels.values.emplace_back(value(at));
    }
  Texture result = all.coordinates;
  result.factor = glm::dvec3(1.0);
  result.nearest = all.nearest;
  result.image = scene.images.add(scene.images.all()[all.coordinates.image].name, pixels, holds);
  return result;
}

glm::dvec4 opaque(const glm::dvec3& color) { return {color, 1.0}; }

} // namespace

Texture constant(const glm::dvec3& color) {
  Texture texture;
  texture.factor = color;
  return texture;
}

Texture constant(double value) { return constant(glm::dvec3(value)); }

Texture mapped(Description& scene, const Texture& texture, Holds holds, const ColorFunction& change) {
  return combined(scene, {texture}, holds,
                  [&](const std::vector<glm::dvec4>& at) { return glm::dvec4(change(glm::dvec3(at[0])), at[0].a); });
}

Texture as_number(Description& scene, const Texture& texture) {
  if (texture.is_constant()) return constant((texture.factor.x + texture.factor.y + texture.factor.z) / 3.0);
  return mapped(scene, texture, Holds::numbers,
                [](const glm::dvec3& color) { return glm::dvec3((color.x + color.y + color.z) / 3.0); });
}

Texture mixed(Description& scene, const Texture& a, const Texture& b, const Texture& amount, Holds holds) {
  if (a == b) return a;
  return combined(scene, {a, b, amount}, holds, [](const std::vector<glm::dvec4>& at) {
    return opaque(glm::mix(glm::dvec3(at[0]), glm::dvec3(at[1]), glm::dvec3(at[2].r)));
  });
}

Texture product(Description& scene, const Texture& a, const Texture& b, Holds holds) {
  Texture result = a.is_constant() ? b : a;
  if (a.is_constant() || b.is_constant()) {
    result.factor = a.factor * b.factor;
    return result;
  }
  return combined(scene, {a, b}, holds,
                  [](const std::vector<glm::dvec4>& at) { return opaque(glm::dvec3(at[0] * at[1])); });
}

Texture bounded(Description& scene, const Texture& texture, Holds holds) {
  const bool fits = glm::all(glm::lessThanEqual(texture.factor, glm::dvec3(1.0)));
  const double scale = texture.is_constant() ? 1.0 : scene.images.all()[texture.image].scale;
  Texture result = texture;
  if (texture.is_constant()) {
    if (!fits) scene.losses.add("reflectance above 1, cut to 1");
    result.factor = glm::clamp(texture.factor, 0.0, 1.0);
    return result;
  }
  if (fits && glm::all(glm::lessThanEqual(texture.factor * scale, glm::dvec3(1.0)))) return texture;
  return mapped(scene, texture, holds, [](const glm::dvec3& color) { return color; });
}

glm::dvec3 mean(Description& scene, const Texture& texture) {
  if (texture.is_constant()) return texture.factor;
  glm::dvec3 sum(0.0);
  const Pixels& pixels = scene.images.pixels(texture.image);
  for (const glm::vec4& value : pixels.values) sum += glm::dvec3(value);
  return texture.factor * sum / std::max(1.0, static_cast<double>(pixels.values.size()));
}

Texture packed(Description& scene, const Texture& green, const Texture& blue) {
  return combined(scene, {green, blue}, Holds::numbers,
                  [](const std::vector<glm::dvec4>& at) { return glm::dvec4(1.0, at[0].r, at[1].r, 1.0); });
}

Texture with_alpha(Description& scene, const Texture& color, const Texture& alpha) {
  return combined(scene, {color, alpha}, Holds::colors,
                  [](const std::vector<glm::dvec4>& at) { return glm::dvec4(glm::dvec3(at[0]), at[1].r); });
}

Texture checkerboard(Description& scene, const glm::dvec3& even, const glm::dvec3& odd) {
  Pixels pixels{
      2, 2, {glm::vec4(opaque(even)), glm::vec4(opaque(odd)), glm::vec4(opaque(odd)), glm::vec4(opaque(even))}};
  Texture texture;
  texture.image = scene.images.add("checkerboard", pixels, Holds::colors);
  texture.nearest = true;
  return texture;
}

} // namespace wavepath::convert
