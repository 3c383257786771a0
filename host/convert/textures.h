// Arithmetic with textures: on constants exactly, on images pixel by pixel, as new images.
#pragma once

#include <functional>
#include <string>

#include "host/convert/described.h"

namespace wavepath::convert {

using ColorFunction = std::function<glm::dvec3(const glm::dvec3&)>;

Texture constant(const glm::dvec3& color);
Texture constant(double value);

// `change` of every value.
Texture mapped(Description& scene, const Texture& texture, Holds holds, const ColorFunction& change);
// Red, green and blue of a texture all become its mean: a number of a picture of colours.
Texture as_number(Description& scene, const Texture& texture);
// a (1 - amount) + b amount. Images of other coordinates than those of the first count with their mean, and are told.
Texture mixed(Description& scene, const Texture& a, const Texture& b, const Texture& amount, Holds holds);
Texture product(Description& scene, const Texture& a, const Texture& b, Holds holds);
// Factors within 0..1, as glTF has them.
Texture bounded(Description& scene, const Texture& texture, Holds holds);
// Factor times the mean of the image.
glm::dvec3 mean(Description& scene, const Texture& texture);
// One image of several numbers, each the red of a texture: glTF's roughness (G) and metallic (B).
Texture packed(Description& scene, const Texture& green, const Texture& blue);
// The colours of one texture with the red of another as alpha.
Texture with_alpha(Description& scene, const Texture& color, const Texture& alpha);

// `even` and `odd` in squares of half the unit of texture coordinates.
Texture checkerboard(Description& scene, const glm::dvec3& even, const glm::dvec3& odd);

} // namespace wavepath::convert
