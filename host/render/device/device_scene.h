// A packed scene on the device: the only place where host arrays become device buffers.
#pragma once

#include <cstdint>
#include <vector>

#include "host/gpu/kernel.h"
#include "host/scene/pack/pack.h"

namespace wavepath {

struct DeviceScene {
  Buffer nodes, triangles, triangle_vertices, vertex_normals, vertex_uvs, vertex_colors, instances;
  Buffer materials, textures, srgb_table, lights, light_tree, environment, environment_ends;
  std::vector<Buffer> texels; // pages of 1 << gpu::kTexelPageShift words, at least one

  std::vector<Binding> bindings() const;
  std::uint64_t bvh_bytes() const; // nodes, triangles and instances
  std::uint64_t other_bytes() const;
};

// Throws Error before allocating anything if the device's limits or memory cannot hold it.
DeviceScene upload_scene(Device& device, const PackedScene& scene);

} // namespace wavepath
