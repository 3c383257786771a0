// The device's ray queries beside our own traversal, on the same rays.
#pragma once

#include <array>
#include <cstdint>

#include "host/bench/contest.h"
#include "host/bench/ray_replay.h"

namespace wavepath {

struct QueryRate {
  double mrays_per_second = 0.0; // 0 = there are no rays of the kind
  double ratio = 0.0;            // our rays a second over those by ray queries
  double agreement = 0.0;        // fraction of the rays for which both find the same
};

struct QueryComparison {
  double upload_seconds = 0.0; // seconds of uploading the scene and building the driver's structures
  std::uint64_t bytes = 0;     // bytes of these structures, the triangles and the instances
  std::array<QueryRate, kRayKindCount> rays;
};

// `replay`: by our traversal, under `settings`. The device has ray queries, the scene does not move. Throws Error if
// the device cannot hold the structures.
QueryComparison compare_with_queries(Device& device, const PackedScene& scene, const View& view,
                                     const RenderPlan& settings, RayReplay& replay, const RaySets& rays,
                                     std::uint32_t repetitions);

} // namespace wavepath
