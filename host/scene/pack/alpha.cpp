// Bounds alpha over the texels of a triangle, by a quadtree of its image; see alpha.h.
#include "host/scene/pack/alpha.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <span>

#include <tbb/parallel_for.h>

namespace wavepath {
namespace {

// Texel coordinates beyond this, and triangles that span more copies of their image: the whole image counts.
constexpr double kLargestTexel = 1 << 20;
constexpr double kMostCopies = 16;

// Range of the vertices' alpha, by which look-ups multiply that of a texel.
struct ColorRange {
  float lo = 1.0f, hi = 1.0f;
};

ColorRange color_range(std::span<const glm::vec4> colors) {
  if (colors.empty()) return {};
  ColorRange range{std::numeric_limits<float>::max(), std::numeric_limits<float>::lowest()};
  for (const glm::vec4& color : colors) {
    if (std::isnan(color.a)) return {std::numeric_limits<float>::lowest(), std::numeric_limits<float>::max()};
    range = {std::min(range.lo, color.a), std::max(range.hi, color.a)};
  }
  return range;
}

ColorRange color_range(const Mesh& mesh, std::uint32_t first_index) {
  if (mesh.colors.empty()) return {};
  std::array<glm::vec4, 3> corners;
  for (std::uint32_t i = 0; i < 3; ++i) corners[i] = mesh.colors[mesh.indices[first_index + i]];
  return color_range(corners);
}

// Coverage of a material with texels whose alpha lies in a range: opacity() of kernels/surface/surface.glsl, with its
// arithmetic.
Coverage coverage(const Material& m, const ColorRange& color, const AlphaPyramid::Range& texels) {
  if (m.alpha_mode == AlphaMode::opaque) return Coverage::opaque;
  float lo = std::numeric_limits<float>::max(), hi = std::numeric_limits<float>::lowest();
  for (const float vertex : {color.lo, color.hi})
    for (const std::uint8_t texel : {texels.lo, texels.hi}) {
      const float alpha = m.base_color.a * vertex * (static_cast<float>(texel) / 255.0f);
      lo = std::min(lo, alpha), hi = std::max(hi, alpha);
    }
  const bool is_mask = m.alpha_mode == AlphaMode::mask;
  const float wanted = is_mask ? m.alpha_cutoff : 1.0f;
  if (lo >= wanted) return Coverage::opaque;
  constexpr float kRounding = 1.0f + 0x1p-20f; // rounding of filtering and interpolation
  return is_mask && hi * kRounding < wanted ? Coverage::hole : Coverage::mixed;
}

AlphaPyramid::Range merge(const AlphaPyramid::Range& a, const AlphaPyramid::Range& b) {
  return {std::min(a.lo, b.lo), std::max(a.hi, b.hi)};
}

// A triangle in an image, in texels from the corner of one of its copies. A texel counts where a look-up within `reach`
// of its edges reads it.
struct Footprint {
  glm::dvec2 corner[3];
  glm::dvec2 lo, hi; // bounds of the corners
  glm::dvec2 reach;
};

void set_box(Footprint& f) {
  f.lo = glm::min(f.corner[0], glm::min(f.corner[1], f.corner[2]));
  f.hi = glm::max(f.corner[0], glm::max(f.corner[1], f.corner[2]));
}

// The coordinates of texture_uv() in kernels/surface/texture.glsl, times the image's size.
Footprint make_footprint(const Mesh& mesh, const TextureSlot& slot, std::uint32_t first_index, glm::uvec2 image_size) {
  Footprint f;
  const glm::dvec2 size(image_size);
  const glm::dmat2 matrix(slot.uv_matrix);
  glm::dvec2 magnitude(0.0); // magnitudes of the terms of a coordinate
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::vector<glm::vec2>& uvs = mesh.uvs[slot.uv_set];
    const glm::dvec2 uv = uvs.empty() ? glm::dvec2(0.0) : glm::dvec2(uvs[mesh.indices[first_index + k]]);
    f.corner[k] = (matrix * uv + glm::dvec2(slot.uv_offset)) * size;
    const glm::dmat2 absolute(glm::abs(matrix[0]), glm::abs(matrix[1]));
    magnitude = glm::max(magnitude, absolute * glm::abs(uv) + glm::abs(glm::dvec2(slot.uv_offset)));
  }
  set_box(f);
  // A filter blends texels whose centres are less than one texel away. Coordinates are interpolated, moved and wrapped
  // in some sixteen operations of single precision; the samplers of devices have steps of a 256th of a texel.
  f.reach = glm::dvec2((slot.nearest ? 0.0 : 0.5) + 0x1p-6) + (magnitude + 1.0) * size * 0x1p-20;
  return f;
}

// False for coordinates that are not finite, which kernels set to zero.
bool is_near(const Footprint& f) {
  return std::ranges::all_of(f.corner, [](const glm::dvec2& corner) {
    return glm::all(glm::lessThan(glm::abs(corner), glm::dvec2(kLargestTexel)));
  });
}

// Separating axes: those of the box, which holds the texels lo..hi, and those across the triangle's edges.
bool meets(const Footprint& f, const glm::dvec2& lo, const glm::dvec2& hi) {
  const glm::dvec2 middle = 0.5 * (lo + hi), half = 0.5 * (hi - lo) + f.reach;
  if (glm::any(glm::lessThan(f.hi, middle - half)) || glm::any(glm::greaterThan(f.lo, middle + half))) return false;
  for (int k = 0; k < 3; ++k) {
    const glm::dvec2 edge = f.corner[(k + 1) % 3] - f.corner[k];
    const glm::dvec2 across(-edge.y, edge.x);
    const double on_edge = glm::dot(across, f.corner[k]), apex = glm::dot(across, f.corner[(k + 2) % 3]);
    const double at = glm::dot(across, middle), width = glm::dot(glm::abs(across), half);
    if (at - width > std::max(on_edge, apex) || at + width < std::min(on_edge, apex)) return false;
  }
  return true;
}

// Descent of one triangle through the quadtree of its image.
struct Descent {
  const Material& material;
  const AlphaPyramid& pyramid;
  ColorRange color;
  Footprint footprint; // in the copy of the image that is looked at
  unsigned seen = 0;   // Coverage bits

  bool is_mixed() const { return seen == static_cast<unsigned>(Coverage::mixed); }

  void visit(std::uint32_t level, std::uint32_t x, std::uint32_t y) {
    const glm::dvec2 lo(glm::dvec2(x, y) * std::exp2(level)), hi(glm::dvec2(x + 1, y + 1) * std::exp2(level));
    if (is_mixed() || !touches(lo, glm::min(hi, glm::dvec2(pyramid.size())))) return;
    const Coverage found = coverage(material, color, pyramid.at(level, x, y));
    if (found != Coverage::mixed || level == 0) {
      seen |= static_cast<unsigned>(found);
      return;
    }
    const glm::uvec2 end = glm::min(pyramid.size(level - 1), glm::uvec2(2 * x + 2, 2 * y + 2));
    for (std::uint32_t v = 2 * y; v < end.y; ++v)
      for (std::uint32_t u = 2 * x; u < end.x; ++u) visit(level - 1, u, v);
  }

  // A clamped image goes on with the texels of its edge.
  bool touches(glm::dvec2 lo, glm::dvec2 hi) const {
    const Wrap wrap[2] = {material.base_color_texture.wrap_u, material.base_color_texture.wrap_v};
    for (int axis = 0; axis < 2; ++axis) {
      if (wrap[axis] != Wrap::clamp) continue;
      if (lo[axis] == 0.0) lo[axis] = std::min(lo[axis], footprint.lo[axis]);
      if (hi[axis] == pyramid.size()[axis]) hi[axis] = std::max(hi[axis], footprint.hi[axis]);
    }
    return meets(footprint, lo, hi);
  }
};

// The copies of the image, along an axis, that the footprint meets: an image that is clamped has one.
struct Copies {
  double first, last;
  double count() const { return last - first + 1.0; }
};

Copies copies_along(const Footprint& f, int axis, double size, Wrap wrap) {
  if (wrap == Wrap::clamp) return {0.0, 0.0};
  return {std::floor((f.lo[axis] - f.reach[axis]) / size), std::floor((f.hi[axis] + f.reach[axis]) / size)};
}

// A corner's position in a copy; every other copy of a mirrored image is turned round.
double position_in_copy(double texel, double copy, double size, Wrap wrap) {
  const bool turned = wrap == Wrap::mirror && std::fmod(copy, 2.0) != 0.0;
  return turned ? (copy + 1.0) * size - texel : texel - copy * size;
}

std::uint8_t byte_below(float value) { return static_cast<std::uint8_t>(std::clamp(value, 0.0f, 1.0f) * 255.0f); }
std::uint8_t byte_above(float value) {
  return static_cast<std::uint8_t>(std::ceil(std::clamp(value, 0.0f, 1.0f) * 255.0f));
}

} // namespace

AlphaPyramid::AlphaPyramid(const Image& image) : image_(&image), sizes_{{image.width, image.height}} {
  while (sizes_.back().x > 1 || sizes_.back().y > 1) {
    const std::uint32_t finer = top();
    const glm::uvec2 ends = sizes_[finer], size = (ends + 1u) / 2u;
    std::vector<Range> level(std::size_t{size.x} * size.y);
    tbb::parallel_for(std::uint32_t{0}, size.y, [&](std::uint32_t y) {
      for (std::uint32_t x = 0; x < size.x; ++x) {
        const std::uint32_t right = std::min(2 * x + 1, ends.x - 1), below = std::min(2 * y + 1, ends.y - 1);
        level[std::size_t{y} * size.x + x] = merge(merge(at(finer, 2 * x, 2 * y), at(finer, right, 2 * y)),
                                                   merge(at(finer, 2 * x, below), at(finer, right, below)));
      }
    });
    sizes_.push_back(size);
    levels_.push_back(std::move(level));
  }
}

AlphaPyramid::Range AlphaPyramid::at(std::uint32_t level, std::uint32_t x, std::uint32_t y) const {
  const std::size_t i = std::size_t{y} * sizes_[level].x + x;
  if (level > 0) return levels_[level - 1][i];
  if (image_->floats.empty()) return {image_->bytes[4 * i + 3], image_->bytes[4 * i + 3]};
  return {byte_below(image_->floats[4 * i + 3]), byte_above(image_->floats[4 * i + 3])};
}

AlphaCoverage::AlphaCoverage(const Scene& scene, const Usage& usage) : images_(scene.images.size()) {
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    const Material& material = scene.materials[m];
    const std::uint32_t image = material.base_color_texture.image;
    const bool asks = usage.material_used[m] && material.alpha_mode != AlphaMode::opaque && image != kNoIndex;
    if (asks && !images_[image]) images_[image].emplace(scene.images[image]);
  }
}

Coverage AlphaCoverage::of_mesh(const Mesh& mesh, const Material& material) const {
  if (material.alpha_mode == AlphaMode::opaque) return Coverage::opaque;
  const ColorRange color = color_range(mesh.colors);
  const bool textured = material.base_color_texture.present();
  return coverage(material, color,
                  textured ? images_[material.base_color_texture.image]->whole() : AlphaPyramid::Range{255, 255});
}

Coverage AlphaCoverage::of_triangle(const Mesh& mesh, const Material& material, std::uint32_t first_index) const {
  if (material.alpha_mode == AlphaMode::opaque) return Coverage::opaque;
  const ColorRange color = color_range(mesh, first_index);
  const TextureSlot& slot = material.base_color_texture;
  if (!slot.present()) return coverage(material, color, {255, 255});
  const AlphaPyramid& pyramid = *images_[slot.image];
  const Coverage whole = coverage(material, color, pyramid.whole());
  const glm::dvec2 size(pyramid.size());
  const Footprint placed = make_footprint(mesh, slot, first_index, pyramid.size());
  if (whole != Coverage::mixed || !is_near(placed)) return whole;

  const Copies columns = copies_along(placed, 0, size.x, slot.wrap_u),
               rows = copies_along(placed, 1, size.y, slot.wrap_v);
  if (columns.count() * rows.count() > kMostCopies) return whole;
  Descent descent{material, pyramid, color, placed};
  for (double row = rows.first; row <= rows.last; ++row)
    for (double column = columns.first; column <= columns.last; ++column) {
      for (int k = 0; k < 3; ++k)
        descent.footprint.corner[k] = {position_in_copy(placed.corner[k].x, column, size.x, slot.wrap_u),
                                       position_in_copy(placed.corner[k].y, row, size.y, slot.wrap_v)};
      set_box(descent.footprint);
      descent.visit(pyramid.top(), 0, 0);
    }
  return static_cast<Coverage>(descent.seen);
}

} // namespace wavepath
