#include "host/render/workspace/workspace.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "host/base/clock.h"
#include "host/render/settings/adaptivity.h"
#include "host/render/settings/cover.h"
#include "host/render/settings/denoising.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/light_groups.h"
#include "host/render/settings/path_reuse.h"
#include "host/render/settings/probing.h"
#include "host/render/settings/traversal.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/render/workspace/levels.h"
#include "host/render/workspace/resources.h"
#include "host/scene/pack/bodies.h"
#include "host/scene/pack/pick.h"
#include "kernels/base/error_probes.h"
#include "kernels/base/features.h"
#include "kernels/base/frame_types.h"
#include "kernels/base/tile_order.h"
#include "kernels/film/cover_types.h"

namespace wavepath {
namespace {

// Bodies at the eye, packed as in path_media, see kernels/path/bodies.glsl.
glm::uvec2 bodies_at_eye(const PackedScene& scene, const glm::dvec3& eye, std::uint32_t lobes) {
  if (!(scene.features & gpu::kFeatureVolume)) return glm::uvec2(gpu::kNone);
  const std::vector<std::uint32_t> bodies = bodies_at(scene, eye);
  const bool nested = (lobes & static_cast<std::uint32_t>(gpu::kLobeNested >> 32)) != 0;
  if (!nested) return {bodies.empty() ? gpu::kNone : bodies[0], gpu::kNone};
  std::uint32_t list[4];
  for (std::size_t i = 0; i < 4; ++i) list[i] = i < bodies.size() ? bodies[i] : 0xffffu;
  return {list[0] | list[1] << 16, list[2] | list[3] << 16};
}

// The device's world has `origin` at zero: subtract in double, then round once.
gpu::Frame make_frame(const PackedScene& scene, const View& view, const RenderPlan& settings, std::uint32_t slots) {
  gpu::Frame frame{};
  set_camera(view, scene.origin, frame);
  frame.width = settings.width;
  frame.height = settings.height;
  const FilmShape film = film_shape(settings);
  frame.film_left = film.place.left, frame.film_top = film.place.top;
  frame.film_width = film.width, frame.film_height = film.height;
  frame.max_depth = settings.max_depth;
  frame.seed = settings.seed;
  frame.environment_radiance = scene.environment_radiance;
  frame.environment_probability = scene.environment_probability;
  frame.environment_rotation = glm::vec2(std::cos(scene.environment_rotation), std::sin(scene.environment_rotation));
  frame.environment_width = scene.environment_width;
  frame.environment_height = scene.environment_height;
  frame.light_count = static_cast<std::uint32_t>(scene.lights.size());
  frame.root = scene.root;
  frame.root_is_top = scene.root_is_top ? 1u : 0u;
  frame.sample_total = settings.sample_total > 0 ? settings.sample_total : settings.last_sample;
  frame.slot_count = slots;
  frame.scene_features = static_cast<std::uint32_t>(scene.features);
  frame.scene_lobes = static_cast<std::uint32_t>(scene.features >> 32);
  frame.first_layers = static_cast<std::uint32_t>(scene.materials.size() * gpu::kMaterialTexels);
  if (!walks_light_tree(settings)) frame.scene_features &= ~gpu::kFeatureLightTree;
  if (!passes_panes(settings)) {
    frame.scene_features &= ~gpu::kFeaturePanes;
    frame.scene_lobes &= ~static_cast<std::uint32_t>(gpu::kFeatureWalls >> 32);
  }
  if (!settings.integrator->nests_bodies) frame.scene_lobes &= ~static_cast<std::uint32_t>(gpu::kLobeNested >> 32);
  frame.bodies_at_eye = bodies_at_eye(scene, glm::dvec3(view.position - scene.origin), frame.scene_lobes);
  frame.quad_scale = static_cast<float>(settings.quad_scale);
  frame.reuses_paths = reuses_paths(settings) ? 1u : 0u;
  frame.probes = film.probes();
  frame.local_light_count = scene.local_light_count;
  frame.motion_texel = static_cast<std::uint32_t>(scene.triangles.size()) * gpu::kTriangleTexels;
  frame.end_normals = scene.end_normals;
  frame.cover = cover_bits(settings);
  if (settings.catches) {
    frame.first_catcher = scene.first_catcher;
    frame.end_catcher = scene.end_catcher;
  }
  if (settings.lens.aperture > 0.0) {
    const bool passes_backs = settings.cull != gpu::kCullNone;
    frame.lens_radius = static_cast<float>(0.5 * settings.lens.aperture);
    frame.focus_distance =
        static_cast<float>(settings.lens.focus ? *settings.lens.focus : depth_of_middle(scene, view, passes_backs));
  }
  return frame;
}

// Paths in flight. Dispatches of late bounces last as long as their longest ray, so that large GPUs want many paths: on
// an NVIDIA H200, 2^23 take 0.6 to 0.8 of the time of 2^21, and 2^24 no less.
std::uint64_t usual_slots(const DeviceInfo& info) {
  return info.type == "cpu" ? 1u << 17 : info.type == "integrated" ? 1u << 21 : 1u << 23;
}

} // namespace

Workspace::Workspace(Device& device_, const PackedScene& scene_, std::uint32_t slots_, std::uint32_t traversal,
                     std::shared_ptr<const DeviceScene> uploaded)
    : device(device_),
      scene(scene_),
      on_device([&] {
        const Clock::time_point start = Clock::now();
        const bool by_query = traces_by_query(traversal, device_.info());
        auto result =
            uploaded ? uploaded : std::make_shared<const DeviceScene>(upload_scene(device_, scene_, by_query));
        upload_seconds = seconds_since(start);
        return result;
      }()),
      slots(slots_),
      film(device_),
      frame_buffer_(device_, sizeof(gpu::Frame)),
      counters_(device_, sizeof(gpu::Counters)) {}

void Workspace::change(const View& view, const RenderPlan& settings) {
  frame = make_frame(scene, view, settings, slots);
  if (on_device->queries) frame.top_level = words_of_address(on_device->queries->address());
}

bool Workspace::fit(const RenderPlan& settings, gpu::Feature features) {
  bool moved = film.fit(film_shape(settings), features & gpu::kFeatureAovs);
  std::uint64_t entries = features & gpu::kFeatureAdaptive ? film.shape().entries() : 0;
  if (entries > 0 && film.shape().is_part()) // pilots show the whole picture
    entries = std::max(entries, std::uint64_t{settings.width} * settings.height);
  moved |= reserve(device, entries_buffer_, entries * sizeof(std::uint32_t));
  if (film.shape().groups > 0) {
    moved |= reserve(device, groups_.paths, slots * group_bytes_per_slot(settings));
    const std::uint64_t table_bytes = scene.light_groups.size() * sizeof(std::uint32_t);
    moved |= reserve(device, groups_.table, table_bytes);
    groups_.table.write(scene.light_groups.data(), table_bytes);
  }
  frame_buffer_.write(&frame, sizeof(frame));
  entries_.clear();
  if (entries > 0) { // until samples are shared out
    std::vector<std::uint32_t> all(entries);
    std::iota(all.begin(), all.end(), 0u);
    set_entries(std::move(all));
  }
  return moved;
}

void Workspace::send_frame() { frame_buffer_.write(&frame, sizeof(frame)); }

void Workspace::set_entries(std::vector<std::uint32_t> entries) {
  entries_ = std::move(entries);
  entries_buffer_.write(entries_.data(), entries_.size() * sizeof(std::uint32_t));
}

std::uint32_t Workspace::entry_at(std::uint32_t index) const { return entries_.empty() ? index : entries_[index]; }

PixelReplicate Workspace::pixel_at(std::uint32_t index) const {
  const std::uint32_t entry = entry_at(index);
  const bool is_probe = film.shape().has_probes && entry >= film.shape().pixels();
  return {in_picture(film.shape(), entry), is_probe ? 1u : 0u};
}

std::vector<Binding> Workspace::bindings(const FilmBand& band) const {
  std::vector<Binding> bindings = on_device->bindings();
  bindings.insert(bindings.end(), {{gpu::kBindFrame, BindingKind::uniform, &frame_buffer_},
                                   {gpu::kBindEntries, BindingKind::texels_r32ui, &entries_buffer_},
                                   {gpu::kBindCounters, BindingKind::storage, &counters_}});
  add_bindings(band, bindings);
  if (film.shape().groups > 0)
    for (const Binding& binding : group_bindings(groups_, band.groups)) bindings.push_back(binding);
  if (film.shape().cover) bindings.push_back({gpu::kBindFilmCover, BindingKind::storage, &band.cover});
  return bindings;
}

void set_camera(const View& view, const glm::dvec3& origin, gpu::Frame& frame) {
  frame.camera_position = glm::vec3(view.position - origin);
  frame.camera_right = glm::vec3(view.right);
  frame.camera_up = glm::vec3(view.up);
  frame.camera_forward = glm::vec3(view.forward);
  frame.orthographic = view.orthographic ? 1u : 0u;
  if (!has_camera_model(view)) return;
  constexpr std::uint32_t kModels[] = {gpu::kCameraPlane, gpu::kCameraFisheye, gpu::kCameraSphere};
  frame.camera_model = kModels[static_cast<std::size_t>(view.panorama)];
  frame.camera_shift = glm::vec2(view.shift);
  frame.clip_near = static_cast<float>(view.clip.near);
  frame.clip_far = view.clip.far < double{gpu::kFar} ? static_cast<float>(view.clip.far) : gpu::kFar;
  frame.angle_limit = static_cast<float>(view.angle_limit);
  if (const double speed = glm::length(view.velocity); speed > 0.0) {
    frame.boost_axis = glm::vec3(view.velocity / speed);
    frame.boost_scale = static_cast<float>(std::sqrt((1.0 - speed) / (1.0 + speed)));
  }
  if (view.eye_distance == 0.0) return;
  frame.eyes = stacks_eyes(view.panorama) ? gpu::kEyesStacked : gpu::kEyesBeside;
  frame.eye_offset = static_cast<float>(0.5 * view.eye_distance);
}

gpu::Feature camera_features(const gpu::Frame& frame) {
  return (frame.orthographic ? gpu::kFeatureOrthographic : 0) |
         (frame.camera_model != gpu::kCameraPlain ? gpu::kFeatureCameraModel : 0) |
         (frame.boost_scale > 0.0f ? gpu::kFeatureRelativity : 0);
}

std::vector<Binding> workspace_layout() {
  std::vector<Binding> layout = DeviceScene{}.bindings();
  layout.insert(layout.end(), {{gpu::kBindFrame, BindingKind::uniform, nullptr},
                               {gpu::kBindEntries, BindingKind::texels_r32ui, nullptr},
                               {gpu::kBindCounters, BindingKind::storage, nullptr}});
  for (const Binding& binding : film_layout()) layout.push_back(binding);
  for (Binding& binding : layout) binding.buffer = nullptr;
  return layout;
}

std::vector<std::unique_ptr<BindingSet>> bind_bands(const Workspace& workspace, const std::vector<Binding>& own) {
  std::vector<std::unique_ptr<BindingSet>> sets;
  for (const FilmBand& band : workspace.film.bands()) {
    std::vector<Binding> bindings = workspace.bindings(band);
    bindings.insert(bindings.end(), own.begin(), own.end());
    sets.push_back(
        std::make_unique<BindingSet>(workspace.device, bindings, static_cast<std::uint32_t>(sizeof(gpu::Wave))));
  }
  return sets;
}

std::uint32_t choose_slots(const DeviceInfo& info, gpu::Feature features, const RenderPlan& settings) {
  RenderPlan whole = settings; // which pilots show
  whole.crop.reset();
  const std::uint64_t entries = film_shape(whole).entries();
  const std::uint64_t samples = settings.last_sample - settings.first_sample;
  const IntegratorKind& kind = *settings.integrator;
  std::uint64_t slots = usual_slots(info);
  if (settings.wave_slots) slots = settings.wave_slots;
  const std::uint64_t together = reuses_paths(settings) ? gpu::kQuadPixels : 1; // pixels that no wave parts
  const std::uint64_t least = together * kind.slots_per_pixel(settings);        // paths of a wave's smallest unit
  slots = std::max(std::min(slots, entries * samples), least);
  if (is_adaptive(settings)) slots = std::max(slots, kAdaptiveStep * kHighestFactor * least); // least: of one sample
  const std::uint64_t record = kind.largest_record(settings);
  slots = std::min(slots, info.max_storage_range / record);
  slots = std::min(slots, info.max_texels(16) / std::max<std::uint64_t>(record / 16, 4));
  slots = std::min<std::uint64_t>(slots, std::uint64_t{info.max_groups} * gpu::kWorkgroupSize);
  slots =
      std::min(slots, std::max<std::uint64_t>(info.memory_bytes / 8 / kind.bytes_per_slot(features, settings), 1024));
  return static_cast<std::uint32_t>(std::max(slots, least));
}

} // namespace wavepath
