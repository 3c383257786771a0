// The product's BVH beside an 8-wide one and the textbooks' structures, on the same rays.
#pragma once

#include <span>
#include <vector>

#include "host/bench/ray_replay.h"
#include "host/bench/structures/row.h"
#include "host/bench/structures/structure.h"

namespace wavepath {

// A structure: how it is built, at the quality of the product's if it has such, and the kernel that walks it.
struct StructureKind {
  const char* name;
  Structure (*build)(const StructureInput&);
  std::span<const std::uint32_t> spirv;
};
std::span<const StructureKind> structure_kinds(); // for all rays
const StructureKind& light_buffer_kind();         // for rays that end at a lamp

// Rays to one point light from where the camera's rays end, and its place in the device's world space.
struct LampRays {
  glm::vec3 lamp{0.0f};
  RaySets rays{}; // shadow rays alone
};

// To the first point or spot light of the scene. Without one the lamp is above the eye, by a quarter of the distance
// between the eye and the middle of what it sees.
LampRays rays_to_lamp(const PackedScene& scene, const View& view, const RaySets& rays);

// The product's kernels come first, with alpha, panes and facing left out, which the others know nothing of. Instances
// are laid out as triangles for the others. `lamp`: where all rays end, null if they do not; light buffers are for such
// rays alone. Empty if the scene has no triangle. Throws Error if the device cannot hold
// a structure.
std::vector<StructureRow> compare_structures(Device& device, const PackedScene& scene, const View& view,
                                             const RenderPlan& settings, const RaySets& rays, std::uint32_t repetitions,
                                             const glm::vec3* lamp = nullptr);

} // namespace wavepath
