// Work of rays, counted by the CPU reference traversal: the same visits and tests as in the kernels.
#pragma once

#include <cstdint>
#include <span>

#include "bvh/traverse.h"
#include "host/scene/pack/pack.h"
#include "kernels/base/frame_types.h"
#include "kernels/path/path_types.h"

namespace wavepath {

// Nodes of the top-level tree count as well. Alpha is ignored: holes stop rays here.
struct RayWork {
  bvh::Counters total; // over the rays
  // Fraction of the visits and tests of all lanes that are a ray's own, if subgroups take rays in order and each lane
  // waits for the one with the most visits and for the one with the most tests. At most 1, which is also that of no
  // rays.
  double lanes_in_use = 1.0;
};

// `lanes` of a subgroup are at least 1. A device tells one number; its compiler may take fewer lanes for a kernel.
RayWork count_closest(const PackedScene& scene, std::span<const gpu::Ray> rays, std::uint32_t lanes);
RayWork count_any(const PackedScene& scene, std::span<const gpu::ShadowRay> rays, std::uint32_t lanes);

} // namespace wavepath
