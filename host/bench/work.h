// How much work rays are, by the CPU reference traversal: the same visits and tests as the kernels'.
#pragma once

#include <span>

#include "bvh/traverse.h"
#include "host/scene/pack/pack.h"
#include "kernels/frame_types.h"
#include "kernels/path/path_types.h"

namespace wavepath {

// Totals over the rays; nodes of the top-level tree count as well. Alpha is ignored: holes stop rays here.
bvh::Counters count_closest(const PackedScene& scene, std::span<const gpu::Ray> rays);
bvh::Counters count_any(const PackedScene& scene, std::span<const gpu::ShadowRay> rays);

} // namespace wavepath
