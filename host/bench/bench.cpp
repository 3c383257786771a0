#include "host/bench/bench.h"

#include <algorithm>
#include <memory>

#include "host/bench/contest.h"
#include "host/bench/frames.h"
#include "host/bench/ray_replay.h"
#include "host/bench/structure_comparison.h"
#include "host/bench/work.h"
#include "host/render/settings/traversal.h"
#ifdef WAVEPATH_EMBREE
#include "benchmarks/embree.h"
#endif

namespace wavepath {
namespace {

// Float operations of kernels/bvh/bvh.glsl and its walk in step, for all devices. A visit: 4 children x 6 planes, each
// scaled and moved (2) and compared (1), and the last comparison, padded (2). A test: 3 vertices moved (3) and sheared
// (5), 3 edge functions (3), their sum and signs (8), and the place of the hit (about 80).
constexpr double kVisitFlops = 4 * (6 * 3 + 2), kTestFlops = 3 * 8 + 3 * 3 + 8 + 80;

RayRate describe(RayKind kind, std::size_t count, const std::vector<double>& seconds, const RayWork& work,
                 const Ceilings& ceilings) {
  RayRate rate;
  rate.kind = kRayKindNames[kind];
  rate.count = count;
  if (count == 0) return rate;
  const Summary summary = summarize(seconds);
  const auto n = static_cast<double>(count), rays_per_second = n / summary.median;
  rate.mrays_per_second = 1e-6 * rays_per_second;
  rate.spread = summary.spread;
  rate.visits = static_cast<double>(work.total.visits) / n;
  rate.tests = static_cast<double>(work.total.tests) / n;
  rate.lanes_in_use = work.lanes_in_use;
  rate.bytes = rate.visits * 16 * gpu::kNodeTexels + rate.tests * 16 * gpu::kTriangleTexels +
               (kind == kShadowRaysKind ? sizeof(gpu::ShadowRay) : sizeof(gpu::Ray) + sizeof(gpu::Hit));
  rate.roofline_fraction = roofline_fraction(ceilings, rays_per_second * (rate.visits + rate.tests),
                                             rays_per_second * (rate.visits * kVisitFlops + rate.tests * kTestFlops));
  return rate;
}

std::array<RayRate, kRayKindCount> measure_rays(const PackedScene& scene, RayReplay& replay, const RaySets& rays,
                                                const Ceilings& ceilings, std::uint32_t repetitions,
                                                std::uint32_t lanes) {
  std::vector<Contestant> alone{replaying(replay, rays)};
  take_turns(alone, repetitions);
  const RayWork work[] = {count_closest(scene, rays.camera, lanes), count_closest(scene, rays.bounce, lanes),
                          count_any(scene, rays.shadow, lanes)};
  std::array<RayRate, kRayKindCount> rates;
  for (std::size_t kind = 0; kind < kRayKindCount; ++kind)
    rates[kind] =
        describe(static_cast<RayKind>(kind), count_rays(rays)[kind], alone[0].measured[kind], work[kind], ceilings);
  return rates;
}

#ifdef WAVEPATH_EMBREE
double agreement_with(const EmbreeScene& embree, RayKind kind, const PackedScene& scene, RayReplay& replay,
                      const RaySets& rays) {
  if (kind == kShadowRaysKind) {
    std::vector<bool> theirs;
    replay.connect(rays.shadow);
    embree.occluded(rays.shadow, &theirs);
    return agreement(replay.blocked(rays.shadow), theirs);
  }
  const std::vector<gpu::Ray>& set = kind == kCameraRays ? rays.camera : rays.bounce;
  std::vector<float> theirs;
  replay.extend(set, kind == kCameraRays);
  embree.intersect(set, &theirs);
  return agreement(replay.distances(scene, set), theirs);
}

// Embree tests neither alpha, panes nor facing, so the kernels that it is compared with leave that out too.
void compare_with_embree(Device& device, const PackedScene& scene, const View& view, const BenchSettings& settings,
                         const RaySets& rays, BenchResult& result) {
  RenderPlan opaque = settings.render;
  opaque.traversal = kTraversalCompute;
  opaque.kernels.removed = gpu::kFeatureAlpha | gpu::kFeaturePanes | gpu::kFeatureCull;
  KernelCompiler kernels(device);
  RayReplay replay(device, scene, view, opaque, kernels);
  const EmbreeScene fast(scene, false), robust(scene, true);
  result.embree_build_seconds = fast.build_seconds();
  const auto embree = [&rays](const EmbreeScene& rival) {
    return Contestant{[&](RayKind kind) {
      return kind == kShadowRaysKind ? rival.occluded(rays.shadow)
                                     : rival.intersect(kind == kCameraRays ? rays.camera : rays.bounce);
    }};
  };
  std::vector<Contestant> contestants{replaying(replay, rays), embree(fast), embree(robust)};
  take_turns(contestants, settings.repetitions);
  for (std::size_t kind = 0; kind < kRayKindCount; ++kind) {
    if (count_rays(rays)[kind] == 0) continue;
    const auto over = [&](std::size_t rival) {
      return ratio_of_medians(contestants[rival].measured[kind], contestants[0].measured[kind]);
    };
    result.rays[kind].embree = {over(1), over(2),
                                agreement_with(robust, static_cast<RayKind>(kind), scene, replay, rays)};
  }
}
#endif

void measure_renders(WarmLoop& warm, const RenderPlan& settings, const PackedScene& scene, std::uint32_t repetitions,
                     BenchResult& result) {
  PathTracing& tracing = result.path_tracing;
  tracing.spp = choose_spp(warm);
  std::vector<double> seconds;
  std::vector<std::vector<double>> stage_ms;
  RenderTime time;
  for (std::uint32_t i = 0; i < repetitions; ++i) {
    time = time_render(warm, tracing.spp);
    seconds.push_back(time.seconds);
    stage_ms.resize(time.stages.size());
    for (std::size_t s = 0; s < time.stages.size(); ++s) stage_ms[s].push_back(1e3 * time.stages[s].seconds);
  }
  double all = 0.0, traversal = 0.0;
  for (std::size_t s = 0; s < stage_ms.size(); ++s) {
    const double ms = summarize(stage_ms[s]).median;
    result.stages.push_back({time.stages[s].name, ms, time.stages[s].dispatches});
    all += ms;
    if (result.stages.back().name == "extend" || result.stages.back().name == "connect") traversal += ms;
  }
  tracing.seconds = summarize(seconds);
  tracing.mrays_per_second = 1e-6 * static_cast<double>(time.rays.total()) / tracing.seconds.median;
  tracing.traversal_fraction = all > 0.0 ? traversal / all : 0.0;
  tracing.bytes_per_path = settings.integrator->bytes_per_slot(scene.features, settings);
}

} // namespace

BenchResult bench(Device& device, const PackedScene& scene, const View& view, const BenchSettings& settings,
                  const std::function<void(const std::string&)>& progress) {
  BenchSettings all = settings;
  all.render.kernels.shadow_rays = true;
  BenchResult result;
  progress("the limits of the device");
  result.ceilings = measure_ceilings(
      device, scene.nodes.size() * sizeof(bvh::WideNode) + scene.triangles.size() * sizeof(gpu::Triangle));
  progress("compiling kernels");
  WarmLoop warm = make_loop(device, scene, view, all.render);
  result.compile_seconds = warm.compile_seconds;
  progress("whole renders");
  measure_renders(warm, all.render, scene, all.repetitions, result);
  progress("rays by kind");
  RenderPlan by_compute = all.render;
  by_compute.traversal = kTraversalCompute;
  const bool by_query = traces_by_query(traversal_of(all.render), device.info());
  RayReplay replay(device, scene, view, by_compute, *warm.kernels,
                   by_query ? nullptr : warm.loop->workspace().on_device);
  const RaySets rays = replay.capture();
  result.rays = measure_rays(scene, replay, rays, result.ceilings, all.repetitions, device.info().subgroup_size);
  if (by_query) {
    progress("the same rays by ray queries");
    result.queries = compare_with_queries(device, scene, view, all.render, replay, rays, all.repetitions);
  }
#ifdef WAVEPATH_EMBREE
  progress("the same rays in Embree");
  compare_with_embree(device, scene, view, all, rays, result);
#endif
  if (all.structures) {
    progress("the same rays in other structures");
    result.structures = compare_structures(device, scene, view, all.render, rays, all.repetitions);
    progress("rays to one lamp in all structures");
    const LampRays to_lamp = rays_to_lamp(scene, view, rays);
    result.lamp_structures =
        compare_structures(device, scene, view, all.render, to_lamp.rays, all.repetitions, &to_lamp.lamp);
  }
  if (all.ablate)
    result.ablation = ablate(device, scene, view, all.render, warm, result.path_tracing.spp, all.repetitions, progress);
  return result;
}

} // namespace wavepath
