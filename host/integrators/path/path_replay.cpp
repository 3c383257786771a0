// Runs the stages of a wave of one path, and reads its state after each.
#include "host/integrators/path/path_replay.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/render/settings/probing.h"
#include "host/render/settings/traversal.h"
#include "kernels/base/error_probes.h"
#include "kernels/base/frame_types.h"
#include "kernels/base/scene_types.h"
#include "kernels/base/tile_order.h"
#include "kernels/base/wave.h"
#include "kernels/path/path_types.h"

namespace wavepath {
namespace {

bool is_finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

RenderPlan without_extras(RenderPlan settings) {
  settings.probes_from = has_error_probes(settings) ? 0 : std::numeric_limits<std::uint32_t>::max();
  settings.aovs.clear();
  return settings;
}

} // namespace

PathReplay::PathReplay(Device& device, const PackedScene& scene, const View& view, const RenderPlan& settings,
                       KernelCompiler& kernels)
    : workspace_(device, scene, 1, traversal_of(settings)),
      paths_(workspace_, kernels),
      trainer_(workspace_, kernels, paths_) {
  const RenderPlan plain = without_extras(settings);
  workspace_.change(view, plain);
  workspace_.frame.reuses_paths = 0; // a path by itself shares nothing
  if (plain.training.found) trainer_.change(plain);
  paths_.change(plain, kAllPathStages, 0);
  if (plain.training.found) trainer_.start();
}

void PathReplay::run(PathStage stage, std::uint32_t bounce) {
  const KernelSet& kernels = paths_.kernels();
  wave_.bounce = bounce;
  Commands commands(workspace_.device);
  commands.bind(paths_.bindings(0)); // whichever: nothing is added to the film
  commands.dispatch(kernels[stage], 1, &wave_);
  commands.submit_and_wait();
}

// Or, where rays are sorted and it escaped, ends the path.
void PathReplay::shade(std::uint32_t bounce) {
  if (paths_.config().features & gpu::kFeatureVoxels) run(kCollide, bounce);
  run(kShade, bounce);
  if (paths_.config().sort == gpu::kSortEscapes) run(kEscape, bounce);
}

gpu::Queues PathReplay::queues() const { return download<gpu::Queues>(paths_.buffers[kQueues], 1).front(); }

gpu::PathState PathReplay::state() const { return download<gpu::PathState>(paths_.buffers[kStates], 1).front(); }

// The shadow ray of one light sample. What connect adds can be too small to change the radiance; so it first adds to a
// radiance of zero, which shows whether the ray is blocked.
ShadowTrace PathReplay::connect(std::uint32_t bounce, std::uint32_t light_sample, const gpu::PathState& state_) {
  const std::uint64_t queue = std::uint64_t{light_sample} * workspace_.slots * sizeof(gpu::ShadowRay);
  ShadowTrace shadow{download<gpu::ShadowRay>(paths_.buffers[kShadowRays], 1, queue).front()};
  gpu::PathState dark = state_;
  dark.radiance = glm::vec3(0.0f);
  paths_.buffers[kStates].write(&dark, sizeof(dark));
  const std::uint32_t prepare = gpu::kAdvanceSteps * bounce + gpu::kBeforeConnect + light_sample;
  run(kAdvance, prepare);
  run(kConnect, bounce);
  shadow.blocked = state().radiance == glm::vec3(0.0f);
  paths_.buffers[kStates].write(&state_, sizeof(state_));
  run(kAdvance, prepare);
  run(kConnect, bounce);
  return shadow;
}

// Why shade sent no further ray. Shade is executed again with the largest eta_scale, with which a path always survives
// Russian roulette: if it then sends a ray, roulette had ended the path.
PathEnd PathReplay::reason(std::uint32_t bounce, const PathVertex& vertex, gpu::PathState arrived) {
  if (!is_finite(vertex.radiance)) return PathEnd::nonfinite;
  if (vertex.hit.triangle == gpu::kNone) return PathEnd::escaped;
  if (vertex.hit.triangle == gpu::kScattered && bounce == workspace_.frame.max_depth) return PathEnd::depth;
  if (vertex.hit.triangle == gpu::kScattered) return PathEnd::roulette;
  const gpu::Triangle& triangle = workspace_.scene.triangles[vertex.hit.triangle];
  const gpu::Material& material = workspace_.scene.materials[triangle.surface & gpu::kTriangleMaterialMask];
  if (material.flags & gpu::kMaterialUnlit) return PathEnd::unlit;
  if (bounce == workspace_.frame.max_depth) return PathEnd::depth;
  arrived.eta_scale = gpu::kFar;
  paths_.buffers[kStates].write(&arrived, sizeof(arrived));
  run(kAdvance, gpu::kAdvanceSteps * bounce + gpu::kBeforeExtend);
  run(kExtend, bounce);
  shade(bounce);
  return queues().ray_count[(bounce + 1) & 1] > 0 ? PathEnd::roulette : PathEnd::absorbed;
}

std::uint32_t PathReplay::entry_of(glm::uvec2 pixel, std::uint32_t replicate) const {
  const gpu::Frame& frame = workspace_.frame;
  if (replicate == 0) return gpu::tile_order_of(pixel, frame.width, frame.height);
  const FilmShape& shape = workspace_.film.shape();
  const std::uint32_t block = gpu::probe_block_of(pixel, frame.width, frame.height, shape.probes());
  if (!shape.has_probes || gpu::probed_pixel(block, frame.width, frame.height, shape.seed, shape.probes()) != pixel)
    throw Error("--net", fmt::format("pixel {},{} is not probed: it has no second replicate", pixel.x, pixel.y),
                "leave it out");
  return frame.width * frame.height + block;
}

PathTrace PathReplay::trace(glm::uvec2 pixel, std::uint32_t sample, std::uint32_t replicate) {
  const std::uint32_t entry = entry_of(pixel, replicate);
  wave_ = gpu::even_wave(entry, 1, sample, 1, entry);
  PathTrace trace{pixel, sample};
  const auto note = [&](const glm::vec3& radiance, std::uint32_t maker) {
    if (!trace.maker && !is_finite(radiance)) trace.maker = maker;
  };

  paths_.get_ready();
  run(kGenerate, 0);
  gpu::PathState arrived = state();
  note(arrived.radiance, gpu::kMakerGenerate);
  std::uint32_t sharing = 1; // light samples among which the density of the path's direction is divided
  for (std::uint32_t bounce = 0;; ++bounce) {
    run(kAdvance, gpu::kAdvanceSteps * bounce + gpu::kBeforeExtend);
    PathVertex& vertex = trace.vertices.emplace_back();
    vertex.ray = download<gpu::Ray>(paths_.buffers[kRays], 1, (bounce & 1) * sizeof(gpu::Ray)).front();
    run(kExtend, bounce);
    shade(bounce);
    vertex.hit = download<gpu::Hit>(paths_.buffers[kHits], 1).front();
    vertex.scattered = state();
    note(vertex.scattered.radiance, gpu::kMakerShade);
    const gpu::Queues counts = queues();
    const float pdf = vertex.scattered.bsdf_pdf;
    if (pdf != arrived.bsdf_pdf)
      sharing = paths_.sampling().light_rays_at(bounce); // else the path went straight through a pane, or ends here
    if (!(pdf < 0.0f)) vertex.pdf = pdf * static_cast<float>(sharing);
    for (std::uint32_t i = 0; i < paths_.sampling().queues(); ++i) {
      run(kAdvance, gpu::kAdvanceSteps * bounce + gpu::kBeforeConnect + i);
      if (queues().shadow_count[0] > 0) vertex.shadows.push_back(connect(bounce, i, state()));
    }
    vertex.radiance = trace.radiance = state().radiance;
    note(vertex.radiance, gpu::kMakerConnect);
    if (counts.ray_count[(bounce + 1) & 1] == 0 || trace.maker) {
      trace.end = reason(bounce, vertex, arrived);
      return trace;
    }
    arrived = vertex.scattered;
  }
}

} // namespace wavepath
