// Counts the uses of a scene's data by its instances: meshes, materials, and each mesh's position in the vertex arrays.
#pragma once

#include <cstdint>
#include <vector>

#include "host/scene/scene.h"

namespace wavepath {

struct Usage {
  std::vector<std::uint32_t> mesh_instances; // for each mesh, the number of its instances; 0 also if it has no triangle
  // For each mesh, its first index in the packed vertex arrays; kNoIndex if unused.
  std::vector<std::uint32_t> first_vertex;
  std::vector<bool> material_used;    // for each material
  std::uint64_t vertex_count = 0;     // vertices of all used meshes, each mesh once
  std::uint64_t triangles_stored = 0; // triangles of all used meshes, each mesh once, before any is dropped
  std::uint64_t triangles_seen = 0;   // triangles of all instances
  std::uint64_t shared_instances = 0; // instances of meshes that are shown more than once
  bool smooth = false;                // some primitive has vertex normals
  bool colored = false;               // some mesh has vertex colours

  bool two_level() const { return shared_instances > 0; }
};

// Counts the uses. The indices of the scene must be in range, which the loader has checked. Throws Error if there are
// more than 2^32 - 1 vertices.
Usage find_usage(const Scene& scene);

// Estimated number of triangles that will be lights, in all instances. Of textured emitters it counts the lit part of
// the texture; all of them if the texture is not decoded yet.
std::uint64_t count_emitters(const Scene& scene, const Usage& usage);

} // namespace wavepath
