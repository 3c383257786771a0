// Predicts the memory that a scene takes on the device, before anything is packed.
#pragma once

#include <cstdint>

#include "host/scene/pack/packing.h"
#include "host/scene/scene.h"

namespace wavepath {

// Bytes. Exact except for tree nodes (an average of real scenes), lights (every triangle of a textured emitter counts,
// though most may prove black) and spatial splits (the largest number of copies).
struct ScenePlan {
  std::uint64_t triangle_bytes = 0, node_bytes = 0, vertex_bytes = 0, texel_bytes = 0, environment_bytes = 0,
                light_bytes = 0, light_tree_bytes = 0, voxel_bytes = 0;
  std::uint64_t triangles_stored = 0, triangles_seen = 0, instances = 0;
  std::uint64_t largest_buffer = 0; // bytes of the largest single array
  bool smooth_surfaces = false;     // some material in use reflects or refracts into a single direction
  std::uint64_t total() const {
    return triangle_bytes + node_bytes + vertex_bytes + texel_bytes + environment_bytes + light_bytes +
           light_tree_bytes + voxel_bytes;
  }
};
// Predicts the result of pack(), whatever eye, direct and lights are.
ScenePlan plan(const Scene& scene, const Packing& packing = {});

} // namespace wavepath
