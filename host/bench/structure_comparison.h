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
  Structure (*build)(std::span<const bvh::Triangle>, bvh::Quality);
  std::span<const std::uint32_t> spirv;
};
std::span<const StructureKind> structure_kinds();

// The product's kernels come first, with alpha, panes and facing left out, which the others know nothing of. Instances
// are laid out as triangles for the others. Empty if the scene has no triangle. Throws Error if the device cannot hold
// a structure.
std::vector<StructureRow> compare_structures(Device& device, const PackedScene& scene, const View& view,
                                             const RenderPlan& settings, const RaySets& rays,
                                             std::uint32_t repetitions);

} // namespace wavepath
