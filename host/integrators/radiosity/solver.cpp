#include "host/integrators/radiosity/solver.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <numbers>

#include "host/base/clock.h"
#include "host/gpu/commands.h"
#include "host/integrators/radiosity/adaptive_patches.h"
#include "host/integrators/radiosity/hemicube.h"
#include "host/integrators/radiosity/settings.h"
#include "host/render/workspace/resources.h"
#include "host/render/workspace/wave_queue.h"
#include "host/render/workspace/workspace.h"
#include "host/scene/pack/packed_scene.h"

namespace wavepath {
namespace {

constexpr std::uint32_t kLightRays = 64;       // shadow rays of a face, at least one to every light
constexpr std::uint64_t kMostLinks = 1u << 22; // 100 MB, and some seconds on the host between two solutions
constexpr std::uint32_t kLightDispatches = 4;  // of shadow rays, before the render may be stopped
// Rays of a dispatch: on two cores of a CPU 2^15 take 30 ms.
constexpr std::uint32_t kRaysOfCpu = 1u << 15, kRaysOfGpu = 1u << 20;

std::uint32_t rays_at_once(const Workspace& workspace) {
  return workspace.device.info().type == "cpu" ? kRaysOfCpu : kRaysOfGpu;
}

std::uint32_t triangle_lights(const PackedScene& scene) {
  return static_cast<std::uint32_t>(std::ranges::count(scene.lights, gpu::kLightTriangle, &gpu::Light::kind));
}

// Calls `submit` for as many items at a time as a dispatch holds; the wave says which.
template <class Submit>
void for_parts(std::uint32_t items, std::uint32_t at_once, gpu::Wave& wave, const Submit& submit) {
  for (wave.first_pixel = 0; wave.first_pixel < items; wave.first_pixel += at_once) {
    wave.pixel_count = std::min(at_once, items - wave.first_pixel);
    submit();
  }
}

} // namespace

std::vector<Binding> Solver::layout() {
  return {{gpu::kBindPatchRoots, BindingKind::texels_r32ui}, {gpu::kBindPatchNodes, BindingKind::texels_r32ui},
          {gpu::kBindPatches, BindingKind::texels_rgba32ui}, {gpu::kBindPatchSurfaces, BindingKind::storage},
          {gpu::kBindPatchLight, BindingKind::storage},      {gpu::kBindShotBlocks, BindingKind::texels_rgba32ui},
          {gpu::kBindShotHits, BindingKind::storage},        {gpu::kBindCornerLight, BindingKind::texels_rgba32f}};
}

void Solver::add_bindings(std::vector<Binding>& bindings) const {
  std::vector<Binding> own = layout();
  const Buffer* buffers[] = {&roots_, &nodes_, &patches_, &surfaces_, &lamp_light_, &blocks_, &hits_, &corners_};
  for (std::size_t i = 0; i < own.size(); ++i) own[i].buffer = buffers[i];
  bindings.insert(bindings.end(), own.begin(), own.end());
}

std::uint64_t Solver::bytes() const {
  return roots_.bytes() + nodes_.bytes() + patches_.bytes() + surfaces_.bytes() + lamp_light_.bytes() +
         blocks_.bytes() + hits_.bytes() + corners_.bytes();
}

void Solver::upload(const PatchTree& tree) {
  Device& device = workspace_.device;
  const std::uint64_t faces = 2 * std::uint64_t{tree.size()}, rays = rays_at_once(workspace_);
  roots_ = wavepath::upload(device, tree.roots);
  nodes_ = wavepath::upload(device, tree.nodes);
  if (work_->nodes.empty()) {
    patches_ = wavepath::upload(device, tree.patches);
  } else {
    std::vector<gpu::Patch> patches = tree.patches;
    for (const LinkNode& node : work_->nodes) patches.push_back(node.part);
    patches_ = wavepath::upload(device, patches);
  }
  surfaces_ = Buffer(device, tree.size() * sizeof(gpu::PatchSurface));
  lamp_light_ = Buffer(device, faces * sizeof(gpu::vec4));
  corners_ = Buffer(device, faces * 3 * sizeof(gpu::vec4));
  reserve(device, blocks_, rays / gpu::kBlockRays * sizeof(gpu::ShotBlock));
  reserve(device, hits_, rays * sizeof(std::uint32_t));
}

void Solver::submit(const Kernel& kernel, const gpu::Wave& wave, WaveQueue& queue) {
  queue.submit(
      [&](Commands& commands) {
        commands.bind(*set_);
        commands.dispatch(kernel, groups_for(wave.pixel_count), &wave);
      },
      {.timed_dispatches = 1});
}

// Irradiance of faces by lamps without a surface and by the environment: some dispatches of it. Returns true when all
// faces have theirs.
bool Solver::measure_light(const KernelSet& kernels, WaveQueue& queue) {
  const PackedScene& scene = workspace_.scene;
  const std::uint32_t faces = 2 * work_->tree.size(), first = triangle_lights(scene);
  const bool sky = (scene.features & gpu::kFeatureEnvironment) && scene.environment_probability == 0.0f;
  const std::uint32_t lights = static_cast<std::uint32_t>(scene.lights.size()) - first + sky;
  by_lamps_.assign(faces, glm::dvec3(0.0));
  if (lights == 0 || !is_looked_up(settings_)) return true;
  gpu::Wave wave{.bounce = first, .first_film_pixel = lights}; // see radiosity_light.comp
  wave.sample_count = lights * ((kLightRays + lights - 1) / lights);
  const std::uint32_t at_once = rays_at_once(workspace_) / gpu::kPatchLightSamples;
  for (std::uint32_t i = 0; i < kLightDispatches && work_->lit_faces < faces; ++i) {
    wave.first_pixel = work_->lit_faces;
    wave.pixel_count = std::min(at_once, faces - work_->lit_faces);
    wave.first_sample = work_->lit_samples;
    submit(kernels[kPatchLight], wave, queue);
    work_->lit_samples += gpu::kPatchLightSamples;
    if (work_->lit_samples < wave.sample_count) continue;
    work_->lit_samples = 0;
    work_->lit_faces += wave.pixel_count;
  }
  queue.drain();
  if (work_->lit_faces < faces) return false;
  std::vector<gpu::vec4> copy;
  const std::span<const gpu::vec4> light = look_at(lamp_light_, faces, copy);
  for (std::uint32_t i = 0; i < faces; ++i) by_lamps_[i] = glm::dvec3(light[i]);
  return true;
}

void Solver::measure_surfaces(const KernelSet& kernels, WaveQueue& queue) {
  gpu::Wave wave{};
  for_parts(work_->tree.size(), rays_at_once(workspace_), wave, [&] { submit(kernels[kPatchMeasure], wave, queue); });
  queue.drain();
}

std::vector<Face> Solver::make_faces() {
  const std::uint32_t patches = work_->tree.size();
  std::vector<gpu::PatchSurface> copy;
  const std::span<const gpu::PatchSurface> surfaces = look_at(surfaces_, patches, copy);
  std::vector<Face> faces;
  faces.reserve(2 * std::size_t{patches});
  for (std::uint32_t i = 0; i < patches; ++i)
    for (std::uint32_t side = 0; side < 2; ++side) {
      const gpu::PatchSurface& surface = surfaces[i];
      Face face = {.area = work_->mesh.areas[i] * static_cast<double>(surface.opacity),
                   .reflectance = glm::dvec3(surface.reflectance)};
      if (reflects()) face.unshot = face.reflectance * by_lamps_[faces.size()];
      if (side == 0 || surface.both_sides) face.unshot += std::numbers::pi * glm::dvec3(surface.emission);
      faces.push_back(face);
    }
  return faces;
}

// Shots go to the device in blocks of kBlockRays, as many at once as a dispatch holds.
void Solver::trace(const std::vector<Shot>& shots, const KernelSet& kernels, WaveQueue& queue) {
  Refinement& refinement = *work_->refinement;
  const bool by_hemicube = settings_.form_factors == kFormFactorsHemicube;
  struct Sent {
    const Shot* shot;
    std::uint32_t first, side; // side 0: rays
  };
  std::vector<Sent> sent;
  std::vector<gpu::ShotBlock> blocks;
  std::map<std::uint32_t, std::vector<double>> weights; // of hemicubes, by side
  const std::uint32_t most = rays_at_once(workspace_) / gpu::kBlockRays;
  const auto flush = [&] {
    if (blocks.empty()) return;
    blocks_.write(blocks.data(), blocks.size() * sizeof(gpu::ShotBlock));
    submit(kernels[kShoot], {.pixel_count = static_cast<std::uint32_t>(blocks.size()) * gpu::kBlockRays}, queue);
    queue.drain();
    std::vector<std::uint32_t> copy;
    const std::span<const std::uint32_t> hits = look_at(hits_, blocks.size() * gpu::kBlockRays, copy);
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      const auto& [shot, first, side] = sent[b];
      const std::uint32_t rays = side ? 3 * side * side : shot->rays;
      for (std::uint32_t i = 0; i < gpu::kBlockRays && first + i < rays; ++i) {
        const std::uint32_t face = hits[b * gpu::kBlockRays + i];
        const glm::dvec3 power = shot->power * (side ? weights[side][first + i] : 1.0 / rays);
        if (face == gpu::kNone)
          refinement.lose(power);
        else
          refinement.receive(face, power);
      }
    }
    report_.rays += blocks.size() * gpu::kBlockRays;
    blocks.clear(), sent.clear();
  };
  for (const Shot& shot : shots) {
    const std::uint32_t side = by_hemicube ? hemicube_side(shot.rays) : 0;
    if (side && !weights.contains(side)) weights[side] = delta_form_factors(side);
    const std::uint32_t rays = side ? 3 * side * side : shot.rays;
    for (std::uint32_t first = 0; first < rays; first += gpu::kBlockRays) {
      blocks.push_back({shot.face, first, side ? side | gpu::kHemicube : rays, shot.number});
      sent.push_back({&shot, first, side});
      if (blocks.size() == most) flush();
    }
  }
  flush();
}

// The next links, in blocks as well. Returns false when there are none left.
bool Solver::trace_links(const KernelSet& kernels, WaveQueue& queue) {
  Links& links = *work_->links;
  const std::span<const Link> next = links.next(rays_at_once(workspace_) / gpu::kBlockRays);
  if (next.empty()) return false;
  const std::uint32_t first_face = 2 * work_->tree.size(); // of nodes, behind those of patches
  auto number = static_cast<std::uint32_t>(links.measured());
  std::vector<gpu::LinkBlock> blocks;
  for (const Link& link : next) blocks.push_back({first_face + link.a, first_face + link.b, number++, 0});
  blocks_.write(blocks.data(), blocks.size() * sizeof(gpu::LinkBlock));
  submit(kernels[kLink], {.pixel_count = static_cast<std::uint32_t>(blocks.size()) * gpu::kBlockRays}, queue);
  queue.drain();
  std::vector<std::uint32_t> copy;
  std::span<const std::uint32_t> light = look_at(hits_, blocks.size() * gpu::kBlockRays, copy);
  std::vector<float> visible;
  for (std::size_t i = 0; i < next.size(); ++i, light = light.subspan(gpu::kBlockRays)) {
    double all = 0.0, arrives = 0.0;
    for (const std::uint32_t bits : light.first(gpu::kBlockRays)) {
      const float along_ray = std::bit_cast<float>(bits);
      all += std::abs(along_ray);
      arrives += std::max(along_ray, 0.0f);
    }
    visible.push_back(all > 0.0 ? static_cast<float>(arrives / all) : 0.5f); // unknown: no ray leaves both in front
  }
  report_.rays += blocks.size() * gpu::kBlockRays;
  links.measure(visible);
  return true;
}

void Solver::begin(const RenderPlan& settings) {
  settings_ = settings;
  report_ = {};
  const bool adapts = settings.subdivision == kSubdivisionAdaptive && is_looked_up(settings);
  const std::uint32_t patches = adapts ? settings.patches / kCoarseShare : settings.patches;
  work_.emplace(Mesh{.tree = uniform_patches(workspace_.scene, patches), .is_coarse = adapts});
}

std::vector<Shot> Solver::next_shots() {
  if (!is_looked_up(settings_)) return {};
  return work_->refinement->next_shots(rays_at_once(workspace_));
}

void Solver::begin_light() {
  const std::uint64_t rays = std::uint64_t{settings_.patch_rays} * work_->tree.size();
  if (by_links())
    work_->links.emplace(std::move(work_->nodes), make_faces(), std::min(rays / gpu::kBlockRays, kMostLinks),
                         reflects());
  else
    work_->refinement.emplace(make_faces(), static_cast<double>(rays), reflects());
}

bool Solver::step(const KernelSet& kernels, WaveQueue& queue, const Bind& bind) {
  const Clock::time_point start = Clock::now();
  bool is_solved = false;
  if (!work_->is_uploaded) {
    work_->mesh = make_mesh(workspace_.scene, work_->tree);
    if (by_links()) work_->nodes = make_link_nodes(workspace_.scene, work_->tree, settings_.cull == gpu::kCullAll);
    upload(work_->tree);
    set_ = &bind();
    measure_surfaces(kernels, queue);
    work_->is_uploaded = true;
  } else if (!work_->refinement && !work_->links) {
    if (measure_light(kernels, queue)) begin_light();
  } else if (work_->links) {
    if (!trace_links(kernels, queue)) is_solved = finish_mesh(*work_->links);
  } else if (const auto shots = next_shots(); !shots.empty()) {
    trace(shots, kernels, queue);
  } else {
    is_solved = finish_mesh(*work_->refinement);
  }
  report_.seconds += seconds_since(start);
  return is_solved;
}

// Leaves the light at the corners, or makes the tree of the final mesh of that on the coarse one.
template <class Solution>
bool Solver::finish_mesh(const Solution& solution) {
  std::vector<glm::dvec3> light = solution.irradiance();
  report_.absorbed = solution.absorbed(light);
  for (std::size_t i = 0; i < light.size(); ++i) light[i] += by_lamps_[i];
  const std::vector<glm::vec4> corners = light_at_corners(work_->mesh, light);
  if (work_->is_coarse) {
    refine(work_->tree, work_->mesh, solution.faces(), corners, settings_.patches);
    *work_ = Mesh{.tree = std::move(work_->tree)};
    return false;
  }
  corners_.write(corners.data(), corners.size() * sizeof(glm::vec4));
  report_.patches = work_->tree.size();
  report_.shots = solution.shots();
  report_.links = work_->links ? work_->links->count() : 0;
  report_.remaining = solution.remaining();
  report_.lost = solution.lost();
  report_.bytes = bytes();
  work_.reset();
  return true;
}

} // namespace wavepath
