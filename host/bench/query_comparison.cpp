#include "host/bench/query_comparison.h"

#include <vector>

#include "host/bench/summary.h"
#include "host/render/workspace/kernel_compiler.h"

namespace wavepath {

QueryComparison compare_with_queries(Device& device, const PackedScene& scene, const View& view,
                                     const RenderPlan& settings, RayReplay& replay, const RaySets& rays,
                                     std::uint32_t repetitions) {
  RenderPlan by_query = settings;
  by_query.traversal = kTraversalHardware;
  KernelCompiler kernels(device);
  RayReplay queries(device, scene, view, by_query, kernels);
  QueryComparison result;
  result.upload_seconds = queries.upload_seconds();
  result.bytes = queries.device_scene().bvh_bytes();
  std::vector<Contestant> contestants{replaying(replay, rays), replaying(queries, rays)};
  take_turns(contestants, repetitions);
  for (std::size_t i = 0; i < kRayKindCount; ++i) {
    const auto kind = static_cast<RayKind>(i);
    const std::size_t count = count_rays(rays)[kind];
    if (count == 0) continue;
    QueryRate& rate = result.rays[kind];
    const double ours = summarize(contestants[0].measured[kind]).median;
    const double theirs = summarize(contestants[1].measured[kind]).median;
    rate.mrays_per_second = 1e-6 * static_cast<double>(count) / theirs;
    rate.ratio = theirs / ours;
    for (Contestant& contestant : contestants) contestant.seconds(kind); // the last one that each has traced
    if (kind == kShadowRaysKind) {
      rate.agreement = agreement(replay.blocked(rays.shadow), queries.blocked(rays.shadow));
    } else {
      const std::vector<gpu::Ray>& set = kind == kCameraRays ? rays.camera : rays.bounce;
      rate.agreement = agreement(replay.distances(scene, set), queries.distances(scene, set));
    }
  }
  return result;
}

} // namespace wavepath
