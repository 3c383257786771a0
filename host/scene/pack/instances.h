// The top level of a two-level scene: placed objects, and the tree over them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "host/scene/pack/geometry.h"
#include "host/scene/pack/packed_scene.h"

namespace wavepath {

struct Placement {
  std::uint32_t object = 0; // index into the objects
  glm::dmat4 device_from_object{1.0};
  std::uint32_t node = kNoIndex;   // of the file, that shows it
  std::uint32_t source = kNoIndex; // index in Scene::instances
};

// Appends the tree over `placements` to packed.nodes and fills packed.instances in leaf order; sets root, root_is_top,
// stack_size, and instance_nodes and instance_sources by Instance::id. Returns the object of each instance. Skips
// placements of empty objects, and those that float matrices cannot hold, which are counted in `skipped`.
std::vector<std::uint32_t> pack_instances(std::span<const Object> objects, std::span<const Placement> placements,
                                          PackedScene& packed, std::size_t& skipped);

} // namespace wavepath
