// Runs the stages of a wave of one path, with a look at its state after each.
#include "host/integrators/path/path_replay.h"

#include <cmath>

#include "kernels/frame_types.h"
#include "kernels/path/path_types.h"
#include "kernels/scene_types.h"
#include "kernels/tile_order.h"

namespace wavepath {
namespace {

bool is_finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

RenderSettings without_extras(RenderSettings settings) {
  settings.aovs.clear();
  return settings;
}

} // namespace

glm::dvec3 hit_position(const PackedScene& scene, const gpu::Hit& hit) {
  const gpu::Triangle& t = scene.triangles[hit.triangle];
  const double b1 = hit.b1, b2 = hit.b2;
  const glm::dvec3 p = (1.0 - b1 - b2) * glm::dvec3(t.v0) + b1 * glm::dvec3(t.v1) + b2 * glm::dvec3(t.v2);
  if (!scene.root_is_top) return p;
  const auto& rows = scene.instances[hit.instance].world_from_object;
  const glm::dvec4 q(p, 1.0);
  return {glm::dot(glm::dvec4(rows[0]), q), glm::dot(glm::dvec4(rows[1]), q), glm::dot(glm::dvec4(rows[2]), q)};
}

PathReplay::PathReplay(Device& device, const PackedScene& scene, const View& view, const RenderSettings& settings,
                       KernelCompiler& kernels)
    : scene_(scene), tracer_(device, scene, view, without_extras(settings), 1, kernels) {}

void PathReplay::run(Stage stage, std::uint32_t bounce) {
  const KernelSet& kernels = tracer_.kernels_.best(tracer_.config_);
  wave_.bounce = bounce;
  Commands commands(tracer_.device_);
  commands.bind(*tracer_.bands_.front().bindings); // whichever: nothing is added to the film
  commands.dispatch(kernels[stage], 1, &wave_);
  commands.submit_and_wait();
}

gpu::PathState PathReplay::state() const { return download<gpu::PathState>(tracer_.paths_.states, 1).front(); }

// What connect adds can be too small to change the radiance, so it shows with none what it lets through.
ShadowTrace PathReplay::connect(std::uint32_t bounce, const gpu::PathState& state_) {
  ShadowTrace shadow{download<gpu::ShadowRay>(tracer_.paths_.shadow_rays, 1).front()};
  gpu::PathState dark = state_;
  dark.radiance = glm::vec3(0.0f);
  tracer_.paths_.states.write(&dark, sizeof(dark));
  run(kConnect, bounce);
  shadow.blocked = state().radiance == glm::vec3(0.0f);
  tracer_.paths_.states.write(&state_, sizeof(state_));
  run(kConnect, bounce);
  return shadow;
}

// Why shade sent no further ray. Whether it was for roulette, it says itself: a path whose eta_scale is beyond all
// bounds survives that, and does only that.
PathEnd PathReplay::reason(std::uint32_t bounce, const PathVertex& vertex, gpu::PathState arrived) {
  if (!is_finite(vertex.radiance)) return PathEnd::nonfinite;
  if (vertex.hit.triangle == gpu::kNone) return PathEnd::escaped;
  const gpu::Triangle& triangle = scene_.triangles[vertex.hit.triangle];
  const gpu::Material& material = scene_.materials[triangle.surface & gpu::kTriangleMaterialMask];
  if (material.flags & gpu::kMaterialUnlit) return PathEnd::unlit;
  if (bounce == tracer_.frame_.max_depth) return PathEnd::depth;
  arrived.eta_scale = gpu::kFar;
  tracer_.paths_.states.write(&arrived, sizeof(arrived));
  run(kAdvance, 2 * bounce);
  run(kShade, bounce);
  return tracer_.counters().ray_count[(bounce + 1) & 1] > 0 ? PathEnd::roulette : PathEnd::absorbed;
}

PathTrace PathReplay::trace(glm::uvec2 pixel, std::uint32_t sample) {
  const gpu::Frame& frame = tracer_.frame_;
  const std::uint32_t place = gpu::tile_order_of(pixel, frame.width, frame.height);
  wave_ = {place, 1, sample, 1, 0, place};
  PathTrace trace{pixel, sample};
  const auto note = [&](const glm::vec3& radiance, std::uint32_t maker) {
    if (!trace.maker && !is_finite(radiance)) trace.maker = maker;
  };

  tracer_.get_ready();
  run(kGenerate, 0);
  gpu::PathState arrived = state();
  note(arrived.radiance, gpu::kMakerGenerate);
  for (std::uint32_t bounce = 0;; ++bounce) {
    run(kAdvance, 2 * bounce);
    PathVertex& vertex = trace.vertices.emplace_back();
    vertex.ray = download<gpu::Ray>(tracer_.paths_.rays, 1, (bounce & 1) * sizeof(gpu::Ray)).front();
    run(kExtend, bounce);
    vertex.hit = download<gpu::Hit>(tracer_.paths_.hits, 1).front();
    run(kShade, bounce);
    vertex.scattered = state();
    note(vertex.scattered.radiance, gpu::kMakerShade);
    const gpu::Queues queues = tracer_.counters();
    if (queues.shadow_count > 0) vertex.shadow = connect(bounce, vertex.scattered);
    vertex.radiance = trace.radiance = state().radiance;
    note(vertex.radiance, gpu::kMakerConnect);
    if (queues.ray_count[(bounce + 1) & 1] == 0 || trace.maker) {
      trace.end = reason(bounce, vertex, arrived);
      return trace;
    }
    arrived = vertex.scattered;
  }
}

} // namespace wavepath
