#include "host/integrators/path/first_hits.h"

#include <algorithm>
#include <vector>

#include "host/integrators/path/paths.h"
#include "host/render/settings/cover.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/pass_names.h"
#include "host/render/settings/traversal.h"
#include "kernels/base/tile_order.h"
#include "kernels/base/wave.h"

namespace wavepath {
namespace {

RenderPlan first_hit_settings(const RenderPlan& asked, RaysThrough through, HitData data) {
  RenderPlan settings = without_cover(asked);
  settings.integrator = find_integrator("path");
  settings.max_depth = 0; // a path ends at its first vertex, before it looks for lights
  settings.guide = false;
  settings.adaptive = kAdaptiveOff;
  settings.reuse = kReuseOff; // pixels that share paths also share the positions of their rays
  settings.looks_for_noise = false;
  settings.aovs.clear();
  if (data == HitData::surface) settings.aovs = {"normal"}; // one stands for all: they are recorded together
  settings.aov_through = false;
  settings.denoise = kDenoiseOff;
  if (through == RaysThrough::centres) {
    settings.filter = gpu::kFilterCentre;
    settings.lens.aperture = 0.0;
    settings.moving = false;
    settings.first_sample = 0;
    settings.last_sample = 1;
  }
  return settings;
}

} // namespace

bool trace_first_hits(Device& device, const PackedScene& scene, const View& view, const RenderPlan& settings,
                      RaysThrough through, HitData data, KernelCompiler& kernels, SceneOnDevice& shared,
                      const std::function<bool()>& progress,
                      const std::function<void(std::span<const FirstHit>)>& visit) {
  const RenderPlan own = first_hit_settings(settings, through, data);
  const std::uint32_t slots = std::min(choose_slots(device.info(), scene.features, own), kMostPassRays);
  Workspace workspace(device, scene, slots, traversal_of(own), shared.scene);
  if (!shared.scene) shared.scene = workspace.on_device;
  Paths paths(workspace, kernels);
  workspace.change(view, own);
  workspace.frame.reuses_paths = 0;
  const std::uint32_t shading = data == HitData::surface ? stage_bits({kShade, kEscape}) : 0;
  paths.change(own, stage_bits({kGenerate, kAdvance, kExtend}) | shading, 0);
  paths.get_ready();

  const FilmShape& film = workspace.film.shape();
  const gpu::FilmArea shown = picture_shape(own).area();
  const auto pixel_count = static_cast<std::uint32_t>(film.pixels());
  const std::uint32_t most_samples = std::max(slots / std::min(pixel_count, slots), 1u);
  std::vector<FirstHit> found;
  for (std::uint32_t first = 0; first < pixel_count; first += slots) {
    const std::uint32_t count = std::min(slots, pixel_count - first);
    for (std::uint32_t sample = own.first_sample; sample < own.last_sample; sample += most_samples) {
      if (!progress()) return false;
      const std::uint32_t samples = std::min(most_samples, own.last_sample - sample);
      const gpu::Wave wave = gpu::even_wave(first, count, sample, samples, first);
      const KernelSet& set = paths.kernels();
      Commands commands(device);
      commands.bind(paths.bindings(0)); // whichever: nothing is added to the film
      commands.dispatch(set[kGenerate], groups_for(count * samples), &wave);
      paths.extend(commands, set, wave, 0);
      if (shading) paths.shade(commands, set, set, wave, 0);
      commands.submit_and_wait();

      const auto rays = download<gpu::Ray>(paths.buffers[kRays], count * samples);
      const auto hits = download<gpu::Hit>(paths.buffers[kHits], count * samples);
      const auto surfaces = download<gpu::PathAovs>(paths.buffers[kPathAovs], shading ? count * samples : 0);
      found.clear();
      for (std::uint32_t i = 0; i < rays.size(); ++i) {
        const glm::uvec2 at = gpu::pixel_in_tile_order(first + i % count, film.width, film.height) +
                              glm::uvec2(film.place.left, film.place.top) - glm::uvec2(shown.left, shown.top);
        if (at.x >= shown.width || at.y >= shown.height) continue; // beside the picture
        found.push_back({at.y * shown.width + at.x, rays[i], hits[i], shading ? surfaces[i] : gpu::PathAovs{}});
      }
      visit(found);
    }
  }
  return true;
}

} // namespace wavepath
