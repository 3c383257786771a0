// Classifies triangles of MASK and BLEND surfaces by bounds of alpha over all texels that look-ups on them can read. If
// no texel lets rays through, traversal need not look alpha up; if all do, the triangle is left out.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "host/scene/scene.h"
#include "host/scene/usage.h"

namespace wavepath {

// Kinds of coverage; bits. A surface that is partly a hole is both.
enum class Coverage : std::uint8_t { none = 0, opaque = 1, hole = 2, mixed = 3 };

// Smallest and largest alpha over squares of 2, 4, ... texels of an image: a quadtree, whose leaves are the texels.
// Values are bytes; those of a float image are rounded outwards.
class AlphaPyramid {
public:
  struct Range {
    std::uint8_t lo = 255, hi = 0;
  };

  explicit AlphaPyramid(const Image& image);

  glm::uvec2 size() const { return sizes_.front(); }                                  // size in texels
  glm::uvec2 size(std::uint32_t level) const { return sizes_[level]; }                // number of squares of that level
  std::uint32_t top() const { return static_cast<std::uint32_t>(sizes_.size() - 1); } // level of one square
  Range at(std::uint32_t level, std::uint32_t x, std::uint32_t y) const;
  Range whole() const { return at(top(), 0, 0); }

private:
  const Image* image_;
  std::vector<glm::uvec2> sizes_;          // one for each level
  std::vector<std::vector<Range>> levels_; // from level 1 on, row by row
};

class AlphaCoverage {
public:
  // Reads the base colour textures of all used MASK and BLEND materials. `scene` must outlive this object.
  AlphaCoverage(const Scene& scene, const Usage& usage);

  // Coverage of a mesh with this material, from the whole image and all vertices. BLEND is never `hole`, but `mixed`.
  Coverage of_mesh(const Mesh& mesh, const Material& material) const;

  // Coverage of the triangle whose indices start at `first_index`. It is conservative: `opaque` or `hole` only if all
  // texels that look-ups can read say so, whatever the wrap mode, filter, texture transform and rounding of
  // coordinates.
  Coverage of_triangle(const Mesh& mesh, const Material& material, std::uint32_t first_index) const;

private:
  std::vector<std::optional<AlphaPyramid>> images_; // one for each image; empty if not needed
};

} // namespace wavepath
