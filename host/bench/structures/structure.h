// A structure over triangles as its kernel in kernels/bench/ reads it, and the builders of those that are compared with
// the product's. Each is built on one thread, the product's binary tree excepted; not for rendering.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "bvh/build_config.h"
#include "bvh/geometry.h"

namespace wavepath {

// A ray as the kernels read it.
struct StructureRay {
  glm::vec3 origin;
  float t_max;
  glm::vec3 direction;
  float unused = 0.0f;
};

// Input of all builders.
struct StructureInput {
  std::span<const bvh::Triangle> triangles;
  bvh::Quality quality = bvh::Quality::best; // of those that the product's build has a part in
  std::span<const StructureRay> rays{};      // rays that will be traced, for structures over them
  glm::vec3 lamp{0.0f};                      // where all rays end, for structures about a lamp
};

struct Structure {
  glm::vec3 lo{0.0f}, size{0.0f};   // box around all triangles
  glm::uvec3 resolution{0};         // cells of a grid
  std::uint32_t depth = 0;          // levels of a tree below the root
  std::uint32_t words_per_node = 2; // 1, 2 or 4
  std::vector<std::uint32_t> nodes; // layout: see the kernel's comment
  std::vector<std::uint32_t> items; // numbers of triangles, leaf by leaf or cell by cell
  std::vector<float> item_depths{}; // by item, of sorted lists: how near it comes; empty for other structures
  bool items_in_place = false;      // the kernel reads the triangles themselves in this order, not their numbers
};

// About four cells a triangle, nearly cubes (Cleary and Wyvill 1988; Lagae and Dutre 2008), at most 2^24.
Structure build_uniform_grid(std::span<const bvh::Triangle> triangles);

// Builds a k-d tree by the surface area heuristic over 32 planes an axis, with triangles cut to their cells (Wald and
// Havran 2006).
Structure build_kd_tree(std::span<const bvh::Triangle> triangles);

// Cubes halved on all axes until eight triangles or fewer are in one, or halving no longer separates them.
Structure build_octree(std::span<const bvh::Triangle> triangles);

// The binary tree that the product's BVH is collapsed from: binned SAH alone, no spatial splits, no reinsertion.
Structure build_sah_bvh(std::span<const bvh::Triangle> triangles);

// The product's build at that quality, collapsed to nodes of eight children in place of four (Ylitie, Karras, Laine
// 2017).
Structure build_wide_bvh(std::span<const bvh::Triangle> triangles, bvh::Quality quality);

// Triangles in the order of Morton codes of 21 bits an axis, cut where the codes first differ (Lauterbach et al. 2009).
Structure build_linear_bvh(std::span<const bvh::Triangle> triangles);

// Hypercubes of rays, halved where rays of `input` are and their lists are long (Arvo and Kirk 1987). It answers these
// rays; without any it has lists of all triangles, one for each face of the cube of directions.
Structure build_ray_classification(const StructureInput& input);

// A cube of directions about the lamp, about four cells a triangle (Haines and Greenberg 1986). It answers shadow rays
// that end at the lamp.
Structure build_light_buffer(const StructureInput& input);

} // namespace wavepath
