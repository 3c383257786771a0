// What the alpha of MASK and BLEND surfaces does to rays, triangle by triangle, from bounds over all texels that
// look-ups on a triangle can meet. Where no texel lets rays through, traversal need not ask; where all do, it need not
// know.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "host/scene/scene.h"
#include "host/scene/usage.h"

namespace wavepath {

// Bits: a surface that is partly a hole is both.
enum class Coverage : std::uint8_t { none = 0, opaque = 1, hole = 2, mixed = 3 };

// Smallest and largest alpha of squares of 2, 4, ... texels of an image, up to the whole: a quadtree, whose leaves are
// the texels. Values are bytes; those of an image of floats are rounded outwards.
class AlphaPyramid {
public:
  struct Range {
    std::uint8_t lo = 255, hi = 0;
  };

  explicit AlphaPyramid(const Image& image);

  glm::uvec2 size() const { return sizes_.front(); }                                  // texels
  glm::uvec2 size(std::uint32_t level) const { return sizes_[level]; }                // squares of that level
  std::uint32_t top() const { return static_cast<std::uint32_t>(sizes_.size() - 1); } // level of one square
  Range at(std::uint32_t level, std::uint32_t x, std::uint32_t y) const;
  Range whole() const { return at(top(), 0, 0); }

private:
  const Image* image_;
  std::vector<glm::uvec2> sizes_;          // by level
  std::vector<std::vector<Range>> levels_; // from level 1, row by row
};

class AlphaCoverage {
public:
  // Reads the base colours of the MASK and BLEND materials in use. `scene` is to outlive it.
  AlphaCoverage(const Scene& scene, const Usage& usage);

  // Of all that the material can show on a mesh, as far as the whole image and all vertices tell. Never a hole of
  // BLEND: that is mixed, like what may be a hole.
  Coverage of_mesh(const Mesh& mesh, const Material& material) const;

  // Of the triangle whose indices start at `first_index`. Conservative: opaque or a hole only if all texels that
  // look-ups there can read say so, whatever wrap mode, filter, texture transform and the rounding of coordinates.
  Coverage of_triangle(const Mesh& mesh, const Material& material, std::uint32_t first_index) const;

private:
  std::vector<std::optional<AlphaPyramid>> images_; // by image; none where nothing asks
};

} // namespace wavepath
