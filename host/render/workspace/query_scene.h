// A packed scene for the device's ray queries.
#pragma once

#include <cstdint>
#include <vector>

#include "host/gpu/acceleration.h"
#include "host/scene/pack/packed_scene.h"

namespace wavepath {

// Data of ray queries. `items` is bound in place of the BVH's nodes. For every object it has the positions in `items`
// where the triangles of its geometries 0 and 1 begin; then, for each geometry, indices into PackedScene::triangles.
// `instances` are those of the scene, except that Instance::root is the index of the object in `items`.
struct QueryScene {
  QueryStructures structures;
  std::vector<std::uint32_t> items; // size: a multiple of four
  std::vector<gpu::Instance> instances;
};

// Builds the structures for kernels/bvh/ray_query.glsl. Instances keep their numbers; copies made by spatial splits are
// left out. The scene must not move, and the device must have ray queries. Throws Error if the device cannot hold it.
QueryScene make_query_scene(Device& device, const PackedScene& scene);

} // namespace wavepath
