#include "host/integrators/hybrid/reflections/maps.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/integrators/hybrid/raster/placed_triangles.h"
#include "host/integrators/hybrid/reflections/mirror_planes.h"
#include "kernels/hybrid/reflections/map_answer.spv.h"
#include "kernels/hybrid/reflections/map_look_up.spv.h"
#include "kernels/hybrid/reflections/map_rays.spv.h"
#include "kernels/hybrid/reflections/map_rays_query.spv.h"
#include "kernels/hybrid/reflections/reflect_meet.spv.h"

namespace wavepath {
namespace {

enum MapStage : std::size_t { kMapRays, kMapMeet, kMapAnswer, kMapLookUp, kMapStageCount };
const std::array<KernelCode, kMapStageCount> kMapStages = {
    {{"reflection map", wavepath_map_rays_spv, {}, wavepath_map_rays_query_spv},
     {"meet reflected", wavepath_reflect_meet_spv},
     {"answer map", wavepath_map_answer_spv},
     {"look up map", wavepath_map_look_up_spv}}};
constexpr std::array<std::size_t, kMapStageCount> kMapOrder = {kMapRays, kMapLookUp, kMapMeet, kMapAnswer};

std::vector<Binding> map_layout() {
  std::vector<Binding> layout = reflection_layout();
  layout.push_back({gpu::kBindReflectionMap, BindingKind::storage, nullptr});
  return layout;
}

constexpr const char* kMapStageName = "reflection map";
constexpr std::uint64_t kFirstTexels = 1u << 12, kFirstMapPixels = 1u << 14; // of a slice: guesses

using Box = MapReflections::Box;

// Of the mirrors, or of the whole scene.
Box box_of(const PackedScene& scene, bool of_mirrors, double threshold) {
  Box box;
  for (const Draw& draw : scene.draws)
    for_each_triangle(scene, draw, [&](std::uint32_t t) {
      const gpu::Triangle& triangle = scene.triangles[t];
      if (of_mirrors && !is_mirror(scene.materials[triangle.surface & gpu::kTriangleMaterialMask], threshold)) return;
      for (std::uint32_t i = draw.first_instance; i < draw.first_instance + draw.instance_count; ++i)
        for (const glm::dvec3& corner : placed_corners(triangle, instance_of(scene, i)))
          box.low = glm::min(box.low, corner), box.high = glm::max(box.high, corner);
    });
  return box;
}

} // namespace

const KernelProgram kMapProgram = {kMapStages, kMapOrder, map_layout};

MapReflections::MapReflections(const ReflectionContext& context, std::uint32_t map_kind)
    : Reflections(context), texels_a_slice_(kFirstTexels), pixels_a_slice_(kFirstMapPixels) {
  frame_.map_kind = map_kind;
}

// Texels stand in the places of pixels while they are shaded, so there are as many of them at most.
void MapReflections::change(const View& view, const RenderPlan& settings, const KernelConfig& config,
                            const std::vector<Binding>& shared) {
  const PackedScene& scene = context_.workspace.scene;
  const std::uint32_t faces = frame_.map_kind == gpu::kMapBall ? 1 : 6;
  const auto pixels = static_cast<double>(context_.workspace.film.pixels());
  frame_.map_side = std::max(static_cast<std::uint32_t>(std::sqrt(pixels / faces)), 1u);
  texels_ = pixels < faces ? 0 : faces * frame_.map_side * frame_.map_side;
  if (whole_.is_empty()) whole_ = box_of(scene, false, 0.0);
  if (threshold_ != settings.reflection_threshold) mirrors_ = box_of(scene, true, settings.reflection_threshold);
  threshold_ = settings.reflection_threshold;
  const bool of_scene = frame_.map_kind == gpu::kMapBox || mirrors_.is_empty();
  frame_.box_low = glm::vec3(whole_.low);
  frame_.box_high = glm::vec3(whole_.high);
  frame_.centre = glm::vec3(of_scene ? whole_.middle() : mirrors_.middle());
  frame_.axis = -context_.workspace.frame.camera_forward;
  reserve(context_.workspace.device, map_,
          std::uint64_t{faces} * frame_.map_side * frame_.map_side * sizeof(gpu::vec4));
  Reflections::change(view, settings, config, shared);
}

void MapReflections::build(WaveQueue& queue) {
  const gpu::Wave one = context_.wave(0, 1);
  const std::uint64_t most =
      std::min<std::uint64_t>(texels_a_slice_.next_frame(), context_.workspace.slots / one.sample_count);
  for (std::uint32_t first = 0; first < texels_; first += static_cast<std::uint32_t>(most)) {
    const auto count = static_cast<std::uint32_t>(std::min<std::uint64_t>(most, texels_ - first));
    const gpu::Wave wave = context_.wave(first, count);
    queue.submit(
        [&](Commands& commands) { record_texels(commands, wave); },
        {.stage = kMapStageName, .done = [this](const Finished& finished) { texels_a_slice_.note(finished.seconds); }});
  }
}

void MapReflections::record_texels(Commands& commands, const gpu::Wave& wave) {
  const std::uint32_t slots = groups_for(std::uint64_t{wave.pixel_count} * wave.sample_count);
  const std::array<std::uint32_t, 2> empty{}; // Queues::ray_count
  commands.write(context_.paths.buffers[kQueues], empty.data(), sizeof(empty));
  commands.bind(bindings(0));
  commands.dispatch(kernels()[kMapRays], slots, &wave);
  commands.barrier();
  commands.dispatch(kernels()[kMapMeet], slots, &wave);
  commands.barrier();
  context_.light(commands, 0, wave);
  commands.barrier();
  commands.bind(bindings(0));
  commands.dispatch(kernels()[kMapAnswer], groups_for(wave.pixel_count), &wave);
}

void MapReflections::finish(WaveQueue& queue) { submit_pixels(queue, kMapLookUp, kMapStageName, pixels_a_slice_); }

} // namespace wavepath
