// Usage of data by the instances of a scene: meshes with their instance counts, materials, and the index of each mesh's
// vertices.
#pragma once

#include <cstdint>
#include <vector>

#include "host/scene/scene.h"

namespace wavepath {

struct Usage {
  std::vector<std::uint32_t> mesh_instances; // by mesh: how many instances show it; 0 too if it has no triangle
  std::vector<std::uint32_t> first_vertex;   // by mesh: its index in the packed vertex streams; kNoIndex if unused
  std::vector<bool> material_used;           // by material
  std::uint64_t vertex_count = 0;            // of all meshes in use, each once
  std::uint64_t triangles_stored = 0;        // each mesh once, before any is dropped
  std::uint64_t triangles_seen = 0;          // instances counted
  std::uint64_t shared_instances = 0;        // instances of meshes that are shown more than once
  bool smooth = false;                       // some primitive has vertex normals
  bool colored = false;                      // some mesh has vertex colours

  bool two_level() const { return shared_instances > 0; }
};

// Indices of the scene are in range: the loader has checked them. Throws Error if there are more than 2^32 - 1
// vertices.
Usage find_usage(const Scene& scene);

// About how many triangles will be lights, instances counted: of textured emitters, by what of the texture shines,
// all of them while it is not decoded.
std::uint64_t count_emitters(const Scene& scene, const Usage& usage);

} // namespace wavepath
