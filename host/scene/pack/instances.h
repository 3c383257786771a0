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
};

// Appends the tree over `placements` to packed.nodes and fills packed.instances in its leaf order; sets root,
// root_is_top and stack_size. Returns by instance: its object. Placements of empty objects are skipped, those that
// float matrices cannot hold are skipped and counted in `skipped`.
std::vector<std::uint32_t> pack_instances(std::span<const Object> objects, std::span<const Placement> placements,
                                          PackedScene& packed, std::size_t& skipped);

} // namespace wavepath
