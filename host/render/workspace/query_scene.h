// A packed scene as the device's ray queries see it.
#pragma once

#include <cstdint>
#include <vector>

#include "host/gpu/acceleration.h"
#include "host/scene/pack/packed_scene.h"

namespace wavepath {

// `items` stand where kernels have the nodes of our own tree otherwise. For every object: where the triangles of its
// geometries 0 and 1 begin in `items`; then, by geometry, indices into PackedScene::triangles. `instances` are those of
// the scene, but for Instance::root, which is the index of the object in `items`.
struct QueryScene {
  QueryStructures structures;
  std::vector<std::uint32_t> items; // a multiple of four
  std::vector<gpu::Instance> instances;
};

// What kernels/bvh/ray_query.glsl traces rays through. Instances are numbered as in the scene; copies that spatial
// splits made are left out. The scene does not move; the device has ray queries. Throws Error if the device cannot hold
// it.
QueryScene make_query_scene(Device& device, const PackedScene& scene);

} // namespace wavepath
