#include "host/integrators/hybrid/hybrid.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/integrators/hybrid/antialias/catalogue.h"
#include "host/integrators/hybrid/beams.h"
#include "host/integrators/hybrid/bounce/catalogue.h"
#include "host/integrators/hybrid/defocus.h"
#include "host/integrators/hybrid/denoise.h"
#include "host/integrators/hybrid/frame_filter.h"
#include "host/integrators/hybrid/motion_blur.h"
#include "host/integrators/hybrid/occlusion/catalogue.h"
#include "host/integrators/hybrid/occlusion/screen_space.h"
#include "host/integrators/hybrid/occlusion_radius.h"
#include "host/integrators/hybrid/reflections/catalogue.h"
#include "host/integrators/hybrid/shading/catalogue.h"
#include "host/integrators/hybrid/shadows/catalogue.h"
#include "host/integrators/hybrid/shadows/sources.h"
#include "host/integrators/hybrid/taa.h"
#include "host/integrators/hybrid/transparency/catalogue.h"
#include "host/integrators/hybrid/voxel_settings.h"
#include "host/integrators/hybrid/voxels/surface_voxels.h"
#include "host/render/settings/mips.h"
#include "host/scene/pack/features.h"
#include "kernels/base/tile_order.h"
#include "kernels/base/wave.h"
#include "kernels/hybrid/antialias/add_upscaled.spv.h"
#include "kernels/hybrid/composite.spv.h"
#include "kernels/hybrid/gather.spv.h"
#include "kernels/hybrid/jitter.spv.h"
#include "kernels/hybrid/occlusion.spv.h"
#include "kernels/hybrid/occlusion_query.spv.h"
#include "kernels/hybrid/resolve.spv.h"
#include "kernels/hybrid/share_shading.spv.h"
#include "kernels/hybrid/velocity.spv.h"

namespace wavepath {
namespace {

constexpr const char* kAntialiasStage = "anti-aliasing";
constexpr const char* kDefocusStage = "depth of field";
constexpr std::uint32_t kAmbientPilotSeed = 0x6a09e667u;
constexpr std::uint32_t kPilotPixels = 1u << 14, kPilotBlock = 1u << 10; // enough for a mean, in a moment
constexpr std::uint32_t kCompositePixels = 1u << 16; // pixels of a dispatch: some tens of milliseconds on two cores

enum Stage : std::size_t {
  kJitter,
  kResolve,
  kOcclusion,
  kGather,
  kShare,
  kVelocity,
  kComposite,
  kAddUpscaled,
  kStageCount
};
const std::array<KernelCode, kStageCount> kStages = {
    {{"jitter", wavepath_jitter_spv},
     {"resolve", wavepath_resolve_spv},
     {"occlusion", wavepath_occlusion_spv, {}, wavepath_occlusion_query_spv},
     {"gather", wavepath_gather_spv},
     {"share shading", wavepath_share_shading_spv},
     {"velocity", wavepath_velocity_spv},
     {"composite", wavepath_composite_spv},
     {"add upscaled", wavepath_add_upscaled_spv}}};
constexpr std::array<std::size_t, kStageCount> kCompileOrder = {kOcclusion, kResolve, kComposite, kAddUpscaled,
                                                                kGather,    kShare,   kVelocity,  kJitter};

enum OwnBuffer : std::size_t {
  kFrame,
  kGbuffer,
  kSignals,
  kJitters,
  kLayers,
  kColorIdsOrFractions,
  kColorSeen,
  kColorSignals,
  kReflectedOrVelocities
};
constexpr std::uint32_t kAnyLayers = gpu::kHybridLayers | gpu::kHybridRefractive;
constexpr std::uint32_t kCapacityForLayers = 1u << 0, kCapacityForSharedColors = 1u << 1,
                        kCapacityForReflections = 1u << 2, kCapacityForVelocities = 1u << 3,
                        kCapacityForParts = 1u << 4; // bits of BufferDimensions::options

std::uint64_t shared_colors(const BufferDimensions& e) {
  return e.options & kCapacityForSharedColors ? e.pixels * gpu::kSharedColors : 0;
}

// Indexed by OwnBuffer. Data of pixels are row-major from the top left.
const std::vector<BufferRule> kHybridRules = {
    {"frame",
     [](const BufferDimensions&) { return std::uint64_t{sizeof(gpu::HybridFrame)}; },
     {{gpu::kBindHybrid, BindingKind::uniform}}},
    {"G-buffer",
     [](const BufferDimensions& e) { return e.pixels * sizeof(gpu::GbufferPixel); },
     {{gpu::kBindGbuffer, BindingKind::storage}}},
    {"signals",
     [](const BufferDimensions& e) { return e.pixels * sizeof(gpu::vec4); },
     {{gpu::kBindSignals, BindingKind::storage}}},
    {"jitters",
     [](const BufferDimensions&) { return std::uint64_t{gpu::kJitters * sizeof(gpu::vec2)}; },
     {{gpu::kBindJitters, BindingKind::storage}}},
    {"layers",
     [](const BufferDimensions& e) { return e.options & kCapacityForLayers ? e.pixels * sizeof(gpu::vec4) : 0; },
     {{gpu::kBindLayers, BindingKind::storage}}},
    {"triangles of shared colours, or fractions of pixels",
     [](const BufferDimensions& e) {
       return e.options & kCapacityForParts ? e.pixels * gpu::kFractions * sizeof(float)
                                            : shared_colors(e) * sizeof(glm::uvec2);
     },
     {{gpu::kBindColorIds, BindingKind::storage}}},
    {"emission of shared colours",
     [](const BufferDimensions& e) { return shared_colors(e) * sizeof(gpu::vec4); },
     {{gpu::kBindColorSeen, BindingKind::storage}}},
    {"signals of shared colours",
     [](const BufferDimensions& e) { return shared_colors(e) * sizeof(gpu::vec4); },
     {{gpu::kBindColorSignals, BindingKind::storage}}},
    {"reflections, or velocities",
     [](const BufferDimensions& e) {
       if (e.options & kCapacityForVelocities) return e.pixels * sizeof(gpu::vec2);
       return e.options & kCapacityForReflections ? e.pixels * sizeof(gpu::vec4) : 0;
     },
     {{gpu::kBindReflections, BindingKind::storage}}},
};

std::vector<Binding> hybrid_layout() {
  std::vector<Binding> layout = path_layout();
  add_layout(kHybridRules, layout);
  layout.push_back({gpu::kBindVisibility, BindingKind::texels_rg32ui, nullptr});
  return layout;
}

const KernelProgram kHybridProgram = {kStages, kCompileOrder, hybrid_layout};

// Flags for surfaces that are seen through, if the scene has any.
std::uint32_t transparency_flags(const RenderPlan& settings, const PackedScene& scene) {
  const TransparencyKind* kind = settings.integrator->finds_light ? kTransparencyTechniques.find(settings) : nullptr;
  if (!kind) return 0;
  return std::ranges::any_of(scene.materials, kind->layers ? kind->layers->holds : is_blended) ? kind->flag : 0;
}

// Over time, for smooth edges.
bool joins_frames(const RenderPlan& settings) {
  return settings.antialias_over_time || kAntialiasTechniques.find(settings)->over_time;
}

bool upscales(const RenderPlan& settings) { return kAntialiasTechniques.find(settings)->halves; }

// The view of frames of half the size, and that size in the settings. Of an odd size, the last pixels reach beyond the
// picture: so do the sides of the view, about the same middle.
void halve(View& view, RenderPlan& settings) {
  const glm::uvec2 whole(settings.width, settings.height);
  settings.width = (whole.x + 1) / 2;
  settings.height = (whole.y + 1) / 2;
  view.right *= 2.0 * settings.width / whole.x;
  view.up *= 2.0 * settings.height / whole.y;
}

// Flags that depend on the settings alone.
std::uint32_t frame_flags(const RenderPlan& settings) {
  const AntialiasKind& antialias = *kAntialiasTechniques.find(settings);
  const bool together = antialias.positions > 0 && !joins_frames(settings);
  const std::uint32_t shared = !together ? 0 : antialias.beam ? gpu::kHybridFractions : gpu::kHybridMultisample;
  const std::uint32_t ambient = has_ambient(settings) ? gpu::kHybridAmbient : 0;
  const std::uint32_t mirrors = reflecting_technique(settings) ? gpu::kHybridReflections : 0;
  return (settings.integrator->finds_light ? gpu::kHybridLights : 0) | ambient | shared | mirrors;
}

// By rays, in the pilot or in frames. How enclosed a position is beyond the picture and a radius, which the ambient
// radiance follows from, rays alone can tell; so it is the same for all techniques.
bool traces_occlusion(const RenderPlan& settings) {
  const std::uint32_t flags = frame_flags(settings);
  return flags & gpu::kHybridAmbient &&
         (!kOcclusionTechniques.find(settings) || (flags & gpu::kHybridLights && !settings.ambient));
}

std::uint32_t stages_of(const RenderPlan& settings) {
  const std::uint32_t flags = frame_flags(settings);
  std::uint32_t stages = 1u << kJitter | 1u << kResolve | 1u << kComposite;
  if (traces_occlusion(settings)) stages |= 1u << kOcclusion;
  if (flags & gpu::kHybridLights) stages |= 1u << kGather;
  if (flags & gpu::kHybridMultisample) stages |= 1u << kShare;
  if (blurs_motion(settings)) stages |= 1u << kVelocity;
  if (upscales(settings)) stages |= 1u << kAddUpscaled;
  return stages;
}

float ray_length(double radius) {
  return radius > 0.0 ? static_cast<float>(std::min<double>(radius, gpu::kFar)) : gpu::kFar;
}

// Width of a pixel's cone in metres: perspective cameras at a distance of 1 m, orthographic ones everywhere. Cones are
// narrower than pixels, because trilinear look-ups blur more than a box: Sponza's relMSE is within 1 % of that of full
// width, and ornaments keep their lines.
float cone_width(const View& view, const RenderPlan& settings) {
  constexpr double kFraction = 0.7;
  return static_cast<float>(kFraction * 2.0 * glm::length(view.right) / settings.width);
}

// All that goes from a point back to its pixel is for pinholes and parallel rays about the picture's middle. First hits
// can be drawn off the middle and between planes as well. Any camera can trace its rays.
void refuse_what_is_not_traced(const RenderPlan& settings, const View& view) {
  const auto refuse = [](const char* flag) {
    throw UsageError(flag, "is not for cameras with --projection, --shift, --intrinsics, --clip or --stereo",
                     "leave it out, or use --integrator path");
  };
  if (view.velocity != glm::dvec3(0.0))
    throw UsageError("--velocity", fmt::format("is not known to --integrator {}", settings.integrator->name),
                     "use --integrator path");
  if (settings.first_hit == kFirstHitRaster && !is_rasterizable(view))
    throw UsageError("--first-hit raster", "cannot draw a fisheye, a sphere or a stereo pair",
                     "leave it out: their first hits are traced");
  if (kShadowTechniques.find(settings)) refuse("--shadows");
  if (kOcclusionTechniques.find(settings)) refuse("--occlusion");
  if (kTransparencyTechniques.find(settings)) refuse("--transparency");
  if (kReflectionTechniques.find(settings)) refuse("--reflections");
  if (kBounceTechniques.find(settings)) refuse("--bounce");
  if (kShadingModels.find(settings)) refuse("--shading");
  if (settings.antialias != 0) refuse("--antialias");
  if (has_lens(settings)) refuse("--aperture");
  if (blurs_motion(settings)) refuse("--shutter");
  if (settings.denoise != kDenoiseOff) refuse("--denoise");
}

} // namespace

// Light beyond the direct one is wanted where paths would be longer than it. A bounce takes its place.
bool has_ambient(const RenderPlan& settings) {
  return !settings.integrator->finds_light || (settings.max_depth > 1 && !kBounceTechniques.find(settings));
}

bool rasterizes_first_hits(const RenderPlan& settings, std::uint64_t triangles, const DeviceInfo& device) {
  if (settings.first_hit != kFirstHitAuto) return settings.first_hit == kFirstHitRaster;
  const std::uint64_t rays = std::uint64_t{settings.width} * settings.height;
  return device.rasterizes && !device.draws_slowly && (device.type != "cpu" || triangles <= rays);
}

KernelNeed hybrid_need(const RenderPlan& settings, const KernelConfig& config) {
  KernelNeed need{&kHybridProgram, stages_of(settings), config};
  if (!settings.aovs.empty()) need.config.features |= gpu::kFeatureAovs; // which come from the G-buffer
  return need;
}

struct Hybrid::Filters { // null = not wanted
  std::unique_ptr<Denoiser> denoiser;
  std::unique_ptr<Taa> taa;
  std::unique_ptr<FrameFilter> each; // by itself
  std::unique_ptr<Defocus> defocus;
  std::unique_ptr<MotionBlur> motion_blur;
};

Hybrid::Hybrid(Workspace& workspace, KernelCompiler& kernels)
    : workspace_(workspace),
      kernels_(kernels),
      paths_(workspace, kernels),
      buffers_(workspace.device, kHybridRules),
      antialias_times_(kAntialiasStage) {}

Hybrid::~Hybrid() = default;

void Hybrid::change(const View& view, const RenderPlan& settings, TemporalHistory history) {
  refuse_lobes(workspace_.scene, kHybridLacks, settings.integrator->name);
  if (has_camera_model(view)) refuse_what_is_not_traced(settings, view);
  shown_ = {view.shift, view.clip};
  shown_size_ = {settings.width, settings.height};
  shown_camera_ = camera_of(workspace_.scene, view);
  settings_ = settings;
  View seen = view;
  if (upscales(settings)) halve(seen, settings_);
  make_frame(seen, settings_, history);
  allocate(seen, history);
}

void Hybrid::make_frame(const View& view, const RenderPlan& settings, TemporalHistory history) {
  const PackedScene& scene = workspace_.scene;
  const glm::vec3 ambient = history == TemporalHistory::keep ? frame_.ambient : glm::vec3(0.0f);
  knows_ambient_ = history == TemporalHistory::keep && ambient != glm::vec3(0.0f);
  camera_ = camera_of(scene, view);
  frame_ = {};
  frame_.film_width = shown_size_.x, frame_.film_height = shown_size_.y;
  frame_.flags = frame_flags(settings) | transparency_flags(settings, scene);
  next_sample_ = gpu::kNone;
  frame_.shadow_samples = lights() ? settings.shadow_samples : 1;
  frame_.ao_samples = settings.ao_samples;
  frame_.ao_radius = ray_length(occlusion_radius(scene, settings));
  frame_.ao_bias = static_cast<float>(glm::radians(settings.ao_bias));
  frame_.ao_thinness = static_cast<float>(settings.ao_thinness);
  frame_.ambient = settings.ambient.value_or(ambient);
  const ClipPlanes planes = clip_planes(scene, view);
  frame_.near = planes.near;
  const ReflectionKind* mirrors = kReflectionTechniques.find(settings); // which show what is farther away
  frame_.far =
      planes.far + (mirrors ? static_cast<float>(2.0 * reflection_depth(*mirrors, settings) * scene.radius) : 0.0f);
  rasterizes_ = refracts() || (is_rasterizable(view) && !blurs_motion(settings) &&
                               rasterizes_first_hits(settings, scene.triangle_count, workspace_.device.info()) &&
                               edges_hold(scene, view, settings.width, settings.height));
  jitters_.clear();
  gpu::Frame& shared = workspace_.frame;
  const bool mips = uses_mips(settings) && (scene.features & gpu::kFeatureMips);
  shared.pixel_spread = mips ? cone_width(view, settings) : 0.0f;
  if (upscales(settings)) {
    set_camera(view, scene.origin, shared);
    shared.width = shared.film_width = settings.width;
    shared.height = shared.film_height = settings.height;
    shared.pixel_spread *= 0.5f; // textures of the picture's pixels
  }
  shared.max_depth = std::min(settings.max_depth, 1u); // the rest is the ambient term's
  shared.sample_total = static_cast<std::uint32_t>(
      std::min<std::uint64_t>(std::uint64_t{shared.sample_total} * frame_.shadow_samples, gpu::kNone));
}

void Hybrid::allocate(const View& view, TemporalHistory history) {
  const PackedScene& scene = workspace_.scene;
  const KernelConfig config = kernel_config(needed_features(scene, view, settings_), scene.stack_size, settings_);
  need_ = hybrid_need(settings_, config);
  kernels_.start(need_);
  std::uint32_t path_stages = !lights() ? 0 : kShadingModels.find(settings_) ? kLocalPathStages : kLightingStages;
  if (const ReflectionKind* kind = reflecting_technique(settings_); kind && kind->traces)
    path_stages |= stage_bits({kExtend});
  const std::uint32_t options =
      lights() || joins_frames(settings_) || filters_frames() || has_lens(settings_) || blurs_motion(settings_)
          ? kCapacityForSeen
          : 0;
  RenderPlan of_film = settings_; // it fits the film, and `seen` for every pixel of that
  of_film.width = shown_size_.x, of_film.height = shown_size_.y;
  bool moved = paths_.change(of_film, path_stages, options, kernels_.features(kHybridProgram));
  assert(!(reflects() && blurs_motion(settings_)) && !(multisamples() && sees_parts())); // they share buffers
  const bool layers = frame_.flags & kAnyLayers;
  moved |= buffers_.fit(
      {.pixels = workspace_.film.pixels(),
       .options = (layers ? kCapacityForLayers : 0) | (multisamples() ? kCapacityForSharedColors : 0) |
                  (reflects() ? kCapacityForReflections : 0) | (blurs_motion(settings_) ? kCapacityForVelocities : 0) |
                  (sees_parts() ? kCapacityForParts : 0)});
  // Glass is passed through like what has alpha.
  const gpu::Feature visible_features = config.features | (refracts() ? gpu::kFeatureAlpha : 0);
  const glm::u64vec4 made_for(settings_.width, settings_.height, visible_features,
                              settings_.cull << 2 | (blurs_motion(settings_) ? 2u : 0u) | (rasterizes_ ? 1u : 0u));
  if (moved) visibility_.reset();
  moved |= visibility_.keep(made_for, [&] {
    return std::make_unique<Visibility>(workspace_.device, scene, *workspace_.on_device, workspace_.frame_buffer(),
                                        buffers_[kFrame], visible_features, settings_.width, settings_.height,
                                        rasterizes_, settings_.cull, blurs_motion(settings_));
  });
  remake_beams();
  std::vector<Binding> own;
  paths_.buffers.add_bindings(own);
  const std::vector<Binding> path_bindings = own;
  remake_voxels();
  remake_shadows(view, own);
  remake_shading(own);
  if (moved || sets_.empty()) {
    buffers_.add_bindings(own);
    own.push_back({gpu::kBindVisibility, BindingKind::texels_rg32ui, &visibility_->ids()});
    sets_ = bind_bands(workspace_, own);
  }
  remake_occlusion();
  remake_reflections(view, path_bindings);
  remake_layers(moved);
  remake_filters(moved, history);
}

void Hybrid::remake_beams() {
  if (!sees_parts()) return beams_.reset();
  const std::uint32_t shape = *kAntialiasTechniques.find(settings_)->beam;
  beams_.keep(shape, [&] { return std::make_unique<Beams>(workspace_, kernels_, shape); });
  beams_->change(need_.config, buffers_[kFrame], buffers_[kColorIdsOrFractions], visibility_->ids());
}

void Hybrid::remake_occlusion() {
  piloting_ = false;
  const OcclusionKind* kind = ambient() ? kOcclusionTechniques.find(settings_) : nullptr;
  if (!kind) return occlusion_.reset();
  occlusion_.keep(kind, [&] { return std::make_unique<ScreenSpaceOcclusion>(workspace_, kernels_, *kind); });
  std::vector<Binding> frame = {{gpu::kBindHybrid, BindingKind::uniform, &buffers_[kFrame]},
                                {gpu::kBindGbuffer, BindingKind::storage, &buffers_[kGbuffer]},
                                {gpu::kBindSignals, BindingKind::storage, &buffers_[kSignals]}};
  if (kind->voxels) voxels_->add_bindings(frame);
  occlusion_->change(need_.config, frame);
}

void Hybrid::remake_reflections(const View& view, const std::vector<Binding>& own) {
  const ReflectionKind* kind = reflecting_technique(settings_);
  if (!kind) return reflections_.reset();
  reflections_.keep({kind, kind->voxels ? settings_.voxels : 0}, [&] {
    return kind->make(
        {*kind, workspace_, kernels_, paths_,
         // Techniques of shadows answer for first hits, by slot or pixel. What a mirror shows has its shadows traced.
         [this](Commands& commands, std::size_t band, const gpu::Wave& wave) { light(commands, band, wave, nullptr); },
         [this](std::uint32_t first, std::uint32_t count) { return wave({}, first, count, 0, 0); },
         kind->voxels ? voxels_.get() : nullptr});
  });
  using enum BindingKind;
  std::vector<Binding> shared = own;
  shared.insert(shared.end(), {{gpu::kBindHybrid, uniform, &buffers_[kFrame]},
                               {gpu::kBindVisibility, texels_rg32ui, &visibility_->ids()},
                               {gpu::kBindGbuffer, storage, &buffers_[kGbuffer]},
                               {gpu::kBindSignals, storage, &buffers_[kSignals]},
                               {gpu::kBindReflections, storage, &buffers_[kReflectedOrVelocities]}});
  reflections_->change(view, settings_, paths_.config(), shared);
}

void Hybrid::remake_layers(bool moved) {
  const bool wanted = frame_.flags & kAnyLayers;
  if (!wanted || moved) layers_.reset();
  if (!wanted) return;
  const LayersMadeFor made_for{kTransparencyTechniques.find(settings_)->layers, paths_.config(), settings_.width,
                               settings_.height, settings_.transparency_layers};
  layers_.keep(made_for, [&] {
    return std::make_unique<Layers>(
        workspace_, *made_for.recipe, made_for.config,
        LayerFrame{buffers_[kFrame], buffers_[kGbuffer], paths_.buffers[kSeen], buffers_[kLayers]}, settings_);
  });
  layers_->turn_to(camera_);
}

void Hybrid::remake_voxels() {
  if (!uses_voxels(settings_)) return voxels_.reset();
  voxels_.keep(settings_.voxels,
               [&] { return std::make_unique<SurfaceVoxels>(workspace_, kernels_, need_.config, settings_.voxels); });
}

void Hybrid::remake_shadows(const View& view, const std::vector<Binding>& own) {
  const ShadowKind* kind = lights() ? kShadowTechniques.find(settings_) : nullptr;
  if (!kind) return shadows_.reset();
  shadows_.keep(kind, [&] {
    return kind->make({*kind, workspace_, kernels_, covered_sources(*kind, workspace_.scene)});
  });
  std::vector<Binding> shared = own;
  shared.push_back({gpu::kBindHybrid, BindingKind::uniform, &buffers_[kFrame]});
  shared.push_back({gpu::kBindVisibility, BindingKind::texels_rg32ui, &visibility_->ids()});
  if (kind->voxels) voxels_->add_bindings(shared);
  shadows_->change(view, settings_, shared);
}

void Hybrid::remake_shading(const std::vector<Binding>& own) {
  const ShadingKind* kind = lights() ? kShadingModels.find(settings_) : nullptr;
  if (!kind) return shading_.reset();
  shading_.keep(kind, [&] { return std::make_unique<LocalShading>(workspace_, kernels_, *kind); });
  shading_->change(settings_, paths_.config(), own);
}

// Frames of a camera in motion are joined instead.
bool Hybrid::filters_frames() const {
  return !joins_frames(settings_) && !kAntialiasTechniques.find(settings_)->passes.empty();
}

// Memory and kernels stay, unless size or buffers are others.
void Hybrid::remake_filters(bool moved, TemporalHistory history) {
  const std::uint32_t which = (settings_.denoise != kDenoiseOff ? 1u : 0u) | (joins_frames(settings_) ? 2u : 0u) |
                              (has_lens(settings_) ? 4u : 0u) | (blurs_motion(settings_) ? 1u << 16 : 0u) |
                              (filters_frames() ? 8u * (1u + settings_.antialias) : 0u) |
                              (upscales(settings_) ? 1u << 17 : 0u);
  const glm::uvec4 made_for = which ? glm::uvec4(shown_size_, frame_.flags, which) : glm::uvec4(0);
  if (moved) filters_.reset();
  const bool made = filters_.keep(made_for, [&] { return std::make_unique<Filters>(make_filters()); });
  if (made || history == TemporalHistory::keep) return;
  if (filters_->denoiser) filters_->denoiser->forget();
  if (filters_->taa) filters_->taa->forget();
}

Hybrid::Filters Hybrid::make_filters() {
  const Buffer &gbuffer = buffers_[kGbuffer], &seen = paths_.buffers[kSeen];
  Device& device = workspace_.device;
  const std::uint32_t width = settings_.width, height = settings_.height;
  Filters filters;
  if (settings_.denoise != kDenoiseOff)
    filters.denoiser = std::make_unique<Denoiser>(device, width, height, gbuffer, buffers_[kSignals], frame_.flags);
  if (filters_frames())
    filters.each = std::make_unique<FrameFilter>(device, kAntialiasTechniques.find(settings_)->passes, width, height,
                                                 gbuffer, seen);
  if (has_lens(settings_)) filters.defocus = std::make_unique<Defocus>(device, width, height, gbuffer, seen);
  if (blurs_motion(settings_))
    filters.motion_blur =
        std::make_unique<MotionBlur>(device, width, height, gbuffer, buffers_[kReflectedOrVelocities], seen);
  if (joins_frames(settings_))
    filters.taa = std::make_unique<Taa>(device, shown_size_.x, shown_size_.y, gbuffer, seen,
                                        kAntialiasTechniques.find(settings_)->joining());
  return filters;
}

bool Hybrid::is_ready() {
  const bool paths = !lights() || paths_.is_ready(); // asks for both, so that both are begun
  const bool voxels = !voxels_ || voxels_->is_ready();
  const bool shadows = !shadows_ || shadows_->is_ready();
  const bool occlusion = !occlusion_ || occlusion_->is_ready();
  const bool shading = !shading_ || shading_->is_ready();
  const bool reflections = !reflections_ || reflections_->is_ready();
  const bool beams = !beams_ || beams_->is_ready();
  return kernels_.ready(need_) && paths && voxels && shadows && occlusion && shading && reflections && beams;
}

double Hybrid::get_ready() {
  return (lights() ? paths_.get_ready() : 0.0) + (shadows_ ? shadows_->get_ready() : 0.0) +
         (voxels_ ? voxels_->get_ready() : 0.0) + (occlusion_ ? occlusion_->get_ready() : 0.0) +
         (shading_ ? shading_->get_ready() : 0.0) + (reflections_ ? reflections_->get_ready() : 0.0) +
         (beams_ ? beams_->get_ready() : 0.0) + kernels_.best(need_).seconds();
}

std::uint64_t Hybrid::bytes() const {
  const auto of = [](const auto& part) { return part ? part->bytes() : 0; };
  return paths_.buffers.bytes() + buffers_.bytes() + visibility_->bytes() + of(filters_->denoiser) + of(filters_->taa) +
         of(filters_->each) + of(filters_->defocus) + of(filters_->motion_blur) + of(shadows_) + of(shading_) +
         of(layers_) + of(reflections_) + of(voxels_) + of(beams_);
}

// kJitters frames at a time, because asking the device costs a round trip.
glm::vec2 Hybrid::jitter(WaveQueue& queue, std::uint32_t sample) {
  const auto position = kAntialiasTechniques.find(settings_)->position;
  if (position && !settings_.antialias_over_time) return position(sample, whole_samples(settings_));
  if (jitters_.empty() || sample < first_jitter_ || sample - first_jitter_ >= jitters_.size()) {
    first_jitter_ = sample;
    gpu::Wave wave{};
    wave.first_sample = sample;
    const auto record = [&](Commands& commands) {
      commands.write(buffers_[kFrame], &frame_, sizeof(frame_));
      commands.bind(*sets_.front());
      commands.dispatch(kernels_.best(need_)[kJitter], groups_for(gpu::kJitters), &wave);
    };
    queue.submit(record, {.timed_dispatches = 1});
    queue.drain();
    jitters_ = download<glm::vec2>(buffers_[kJitters], gpu::kJitters);
  }
  return jitters_[sample - first_jitter_];
}

// Position in a pixel of the frame, for a position in a pixel of the picture, of which a frame's pixel has 2x2. Their
// places take turns, the second one across from the first, and begin a place later every four frames: every fourth
// position of a sequence lies in the same quarter of the pixel, and each place is to see all quarters.
glm::vec2 Hybrid::jitter_of_half(glm::vec2 jitter, std::uint32_t sample) {
  constexpr std::uint32_t kPlaces[] = {0, 3, 1, 2};
  place_ = kPlaces[(sample + sample / 4) % 4];
  shown_camera_.jitter_x = jitter.x;
  shown_camera_.jitter_y = jitter.y;
  const glm::vec2 beyond = 2.0f * glm::vec2(settings_.width, settings_.height) - glm::vec2(shown_size_); // see halve()
  return 0.5f * (glm::vec2(place_ & 1, place_ >> 1) + 0.5f + jitter) - 0.5f + 0.25f * beyond;
}

void Hybrid::begin_pass(WaveQueue& queue, std::uint32_t sample) {
  frame_.sample_index = sample;
  if (multisamples() || sees_parts()) {
    frame_.sample_position = sample % kAntialiasTechniques.find(settings_)->positions;
    if (sample != next_sample_ || frame_.sample_position == 0) frame_.first_position = frame_.sample_position;
    next_sample_ = sample + 1;
  }
  frame_.jitter = jitter(queue, sample);
  if (upscales(settings_)) frame_.jitter = jitter_of_half(frame_.jitter, sample);
  see(queue);
  if (voxels_) voxels_->build(queue);
  if (shadows_) shadows_->build(queue, sample);
  if (reflections_ && !piloting_) reflections_->build(queue);
}

void Hybrid::see(WaveQueue& queue) {
  const auto prepare = [this](Commands& commands) { commands.write(buffers_[kFrame], &frame_, sizeof(frame_)); };
  if (!beams_) {
    visibility_->render(queue, camera_, prepare, shown_);
  } else {
    if (frame_.sample_position == frame_.first_position) {
      beams_->find(queue, kAntialiasStage, prepare);
      queue.afterwards([this, &queue] { antialias_times_.note_frame(queue.totals); });
    }
    beams_->show(queue, frame_.sample_position, prepare);
  }
  if (!multisamples()) return;
  frame_.jitter = glm::vec2(0.0f); // positions are seen, centres are shaded
  queue.submit(prepare, {});
}

void Hybrid::describe(RenderResult& result) const {
  result.ambient = frame_.ambient;
  if (filters_->taa || filters_->each || beams_) result.antialias = antialias_times_.cost();
  if (occlusion_) result.occlusion = {.radius = frame_.ao_radius, .cost = occlusion_->cost()};
  if (reflections_ && kReflectionTechniques.find(settings_)) result.reflections = reflections_->report();
  if (!shadows_) return;
  const ShadowKind& kind = *kShadowTechniques.find(settings_);
  const LightCover cover = light_cover(kind, workspace_.scene);
  result.shadows = {.covered = names_of(cover.covered),
                    .traced = cover.traced,
                    .build = shadow_times_.build.cost(),
                    .look_up = shadow_times_.look_up.cost(),
                    .views = shadows_->view_count(),
                    .bytes = shadows_->bytes() + (kind.voxels ? voxels_->bytes() : 0)};
  ShadowReport& report = *result.shadows;
  shadows_->describe(report);
  if (report.size != 0 && report.size != settings_.shadow_size)
    report.smaller = fmt::format(
        "shadow maps have {} texels along a side instead of {}, as the device cannot hold {} "
        "larger ones (--shadow-size)",
        report.size, settings_.shadow_size, report.views);
}

// Paths of a pixel in a wave: its light samples, each of which takes a slot, or its occlusion rays if those are more.
std::uint32_t Hybrid::paths_per_pixel(std::uint32_t) const {
  return std::max(frame_.shadow_samples, ambient() ? frame_.ao_samples : 0);
}

// Samples as hybrid_sample() of kernels/hybrid/frame_terms.glsl numbers them.
gpu::Wave Hybrid::wave(const FilmBand& band, std::uint32_t first_entry, std::uint32_t pixel_count, std::uint32_t,
                       std::uint32_t) const {
  const std::uint32_t samples = frame_.shadow_samples, round = frame_.sample_index / gpu::kReplicates,
                      replicate = frame_.sample_index % gpu::kReplicates;
  return gpu::even_wave(first_entry, pixel_count, round * samples * gpu::kReplicates + replicate, samples,
                        band.first_pixel);
}

// Index in the frame of a pixel of the film, both in tile order: the same, but for frames of half the size. Those are
// cut where the film is, in proportion.
std::uint32_t Hybrid::frame_index(std::uint32_t film_index) const {
  const std::uint64_t pixels = std::uint64_t{settings_.width} * settings_.height,
                      whole = std::uint64_t{shown_size_.x} * shown_size_.y;
  return static_cast<std::uint32_t>(film_index * pixels / whole);
}

gpu::Wave Hybrid::wave_of_frame(gpu::Wave wave) const {
  const std::uint32_t end = frame_index(wave.first_pixel + wave.pixel_count);
  wave.first_pixel = frame_index(wave.first_pixel);
  wave.pixel_count = end - wave.first_pixel;
  return wave;
}

void Hybrid::record_wave(Commands& commands, std::size_t band, const gpu::Wave& film_wave) {
  const gpu::Wave wave = wave_of_frame(film_wave);
  if (wave.pixel_count == 0) return;
  const KernelSet& kernels = kernels_.best(need_);
  commands.bind(*sets_[band]);
  commands.dispatch(kernels[kResolve], groups_for(wave.pixel_count), &wave);
  commands.barrier();
  if (ambient() && (!occlusion_ || piloting_)) {
    commands.dispatch(kernels[kOcclusion], groups_for(wave.pixel_count), &wave);
    commands.barrier(); // it reads the rays that shading replaces
  }
  if (!lights()) return;
  light(commands, band, wave, shadows_.get());
  commands.barrier();
  commands.bind(*sets_[band]);
  commands.dispatch(kernels[kGather], groups_for(wave.pixel_count), &wave);
  if (!reflections_ || piloting_) return;
  commands.barrier();
  reflections_->record(commands, band, wave);
}

// Direct light as the path tracer finds it, from the first hit on; local illumination finds it by shadow rays alone.
void Hybrid::light(Commands& commands, std::size_t band, const gpu::Wave& wave, ShadowTechnique* shadows) {
  const KernelSet& kernels = paths_.kernels();
  if (shading_) shading_->record(commands, band, wave);
  commands.bind(paths_.bindings(band));
  if (!shading_)
    commands.dispatch(kernels[kShade], groups_for(std::uint64_t{wave.pixel_count} * wave.sample_count), &wave);
  if (workspace_.frame.max_depth == 0) return;
  if (workspace_.frame.light_count > 0) {
    if (shadows) {
      commands.barrier();
      shadows->record_look_up(commands, band, wave);
      commands.barrier();
      commands.bind(paths_.bindings(band));
    }
    paths_.connect(commands, kernels, wave, 0);
  }
  if (shading_) return;
  paths_.extend(commands, kernels, wave, 1); // emission that BSDF samples hit
  paths_.shade(commands, kernels, kernels, wave, 1);
}

void Hybrid::end_pass(WaveQueue& queue) {
  if (shadows_) queue.afterwards([this, &queue] { shadow_times_.note_frame(queue.totals); });
  camera_.jitter_x = frame_.jitter.x;
  camera_.jitter_y = frame_.jitter.y;
  if (occlusion_) occlusion_->submit(queue);
  if (multisamples()) for_all_pixels(queue, kShare, {.timed_dispatches = 1});
  if (reflections_ && !piloting_) reflections_->finish(queue);
  if (layers_ && !refracts()) layers_->render(queue);
  if (Denoiser* denoiser = filters_->denoiser.get())
    queue.submit([&](Commands& commands) { denoiser->record(commands, camera_); },
                 {.timed_dispatches = denoiser->dispatches()});
  const bool filters_edges = filters_->taa || filters_->each,
             filters = filters_edges || filters_->defocus || filters_->motion_blur;
  if (!filters && !refracts()) return composite(queue, frame_.flags);
  composite(queue, frame_.flags | gpu::kHybridToColor);
  const std::uint32_t again = (frame_.flags & ~gpu::kHybridLayers) | gpu::kHybridFromColor;
  if (refracts()) { // opaque surfaces are seen through layers, so they come first
    layers_->render(queue);
    composite(queue, again | gpu::kHybridLayers | (filters ? gpu::kHybridToColor : 0));
    if (!filters) return;
  }
  if (filters_->defocus) spread_spots(queue);
  if (filters_->motion_blur) blur_motion(queue);
  if (filters_edges) antialias(queue);
  if (upscales(settings_)) return add_to_film(queue, kAddUpscaled, frame_.flags);
  composite(queue, again);
}

void Hybrid::for_all_pixels(WaveQueue& queue, std::size_t stage, const WaveQueue::Work& work) {
  const KernelSet& kernels = kernels_.best(need_);
  const std::uint32_t pixels = settings_.width * settings_.height;
  for (std::uint32_t first = 0; first < pixels; first += kCompositePixels) {
    gpu::Wave wave{};
    wave.first_pixel = first;
    wave.pixel_count = std::min(kCompositePixels, pixels - first);
    const auto record = [&](Commands& commands) {
      commands.bind(*sets_.front());
      commands.dispatch(kernels[stage], groups_for(wave.pixel_count), &wave);
    };
    queue.submit(record, work);
  }
}

void Hybrid::spread_spots(WaveQueue& queue) {
  Defocus& defocus = *filters_->defocus;
  const auto find = [&](Commands& commands) { defocus.record_spots(commands, defocus_lens(workspace_.frame)); };
  queue.submit(find, {.stage = kDefocusStage});
  for (std::uint32_t band = 0; band < defocus.bands(); ++band) {
    const auto spread = [&](Commands& commands) {
      defocus.record_spread(commands, band);
      if (band + 1 == defocus.bands())
        commands.copy(defocus.result(), paths_.buffers[kSeen],
                      std::uint64_t{settings_.width} * settings_.height * sizeof(glm::vec4));
    };
    queue.submit(spread, {.stage = kDefocusStage});
  }
}

void Hybrid::blur_motion(WaveQueue& queue) {
  MotionBlur& blur = *filters_->motion_blur;
  for_all_pixels(queue, kVelocity, {.stage = kMotionBlurStage});
  queue.submit([&](Commands& commands) { blur.record_tiles(commands); }, {.stage = kMotionBlurStage});
  for (std::uint32_t band = 0; band < blur.bands(); ++band) {
    const auto record = [&](Commands& commands) {
      blur.record_blur(commands, band);
      if (band + 1 == blur.bands())
        commands.copy(blur.result(), paths_.buffers[kSeen],
                      std::uint64_t{settings_.width} * settings_.height * sizeof(glm::vec4));
    };
    queue.submit(record, {.stage = kMotionBlurStage});
  }
}

void Hybrid::antialias(WaveQueue& queue) {
  const auto record = [&, taa = filters_->taa.get(), each = filters_->each.get()](Commands& commands) {
    if (taa)
      taa->record(commands, upscales(settings_) ? shown_camera_ : camera_, place_);
    else
      each->record(commands);
    commands.copy(taa ? taa->result() : each->result(), paths_.buffers[kSeen],
                  std::uint64_t{shown_size_.x} * shown_size_.y * sizeof(glm::vec4));
  };
  queue.submit(record, {.stage = kAntialiasStage});
  queue.afterwards([this, &queue] { antialias_times_.note_frame(queue.totals); });
}

void Hybrid::composite(WaveQueue& queue, std::uint32_t flags) { add_to_film(queue, kComposite, flags); }

void Hybrid::add_to_film(WaveQueue& queue, std::size_t stage, std::uint32_t flags) {
  const KernelSet& kernels = kernels_.best(need_);
  gpu::HybridFrame frame = frame_;
  frame.flags = flags;
  const std::vector<FilmBand>& bands = workspace_.film.bands();
  for (std::size_t i = 0; i < bands.size(); ++i) {
    const FilmBand& band = bands[i];
    if (band.pixel_count == 0) continue;
    const auto record = [&](Commands& commands) {
      commands.write(buffers_[kFrame], &frame, sizeof(frame));
      commands.bind(*sets_[i]);
      for (std::uint32_t done = 0; done < band.pixel_count; done += kCompositePixels) {
        const std::uint32_t count = std::min(kCompositePixels, band.pixel_count - done);
        const gpu::Wave of_film{band.first_pixel + done, count, 0, 1, 0, band.first_pixel};
        const gpu::Wave wave = stage == kAddUpscaled ? of_film : wave_of_frame(of_film);
        if (wave.pixel_count > 0) commands.dispatch(kernels[stage], groups_for(wave.pixel_count), &wave);
      }
    };
    queue.submit(record, {.timed_dispatches = (band.pixel_count + kCompositePixels - 1) / kCompositePixels});
  }
}

// Blocks of pixels spread evenly over the picture. Until end_pilot(), occlusion rays measure how enclosed the scene is.
std::optional<Pilot> Hybrid::pilot() {
  if (!lights() || settings_.ambient || !ambient() || knows_ambient_) return std::nullopt;
  Pilot pilot{.segments = {}, .samples = 1, .seed = kAmbientPilotSeed};
  const std::uint32_t width = settings_.width, height = settings_.height, pixels = shown_size_.x * shown_size_.y;
  const std::uint32_t blocks = std::max(std::min(kPilotPixels, pixels + kPilotBlock - 1) / kPilotBlock, 1u);
  const std::vector<FilmBand>& bands = workspace_.film.bands();
  pilot_pixels_.clear();
  for (std::uint32_t block = 0; block < blocks; ++block) {
    const auto first = static_cast<std::uint32_t>(std::uint64_t{pixels} * block / blocks);
    const auto band = std::ranges::find_if(
        bands, [&](const FilmBand& b) { return first >= b.first_pixel && first - b.first_pixel < b.pixel_count; });
    const std::uint32_t end = std::min(first + kPilotBlock, band->first_pixel + band->pixel_count);
    pilot.segments.push_back({static_cast<std::size_t>(band - bands.begin()), first, end - first, 0});
    for (std::uint32_t pixel = frame_index(first); pixel < frame_index(end); ++pixel) {
      const glm::uvec2 at = gpu::pixel_in_tile_order(pixel, width, height);
      pilot_pixels_.push_back(at.y * width + at.x);
    }
  }
  jitters_.clear();
  frame_.ao_radius = gpu::kFar;
  piloting_ = true;
  return pilot;
}

bool Hybrid::end_pilot() {
  piloting_ = false;
  next_sample_ = gpu::kNone;
  frame_.ambient = enclosed_light();
  frame_.ao_radius = ray_length(occlusion_radius(workspace_.scene, settings_));
  jitters_.clear();
  return false;
}

// The light inside an integrating sphere: of the light that surfaces send out, the fraction that meets surfaces again
// is sent out once more, L = direct + albedo * enclosure * L. The surfaces in the picture receive that L from the
// enclosed directions.
glm::vec3 Hybrid::enclosed_light() const {
  const auto gbuffer = download<gpu::GbufferPixel>(buffers_[kGbuffer], workspace_.film.pixels());
  const auto signals = download<glm::vec4>(buffers_[kSignals], workspace_.film.pixels());
  glm::dvec3 direct(0.0), albedo(0.0);
  double unoccluded = 0.0, count = 0.0;
  for (const std::uint32_t i : pilot_pixels_) {
    const glm::dvec3 light = glm::dvec3(signals[i]) * glm::dvec3(glm::max(gbuffer[i].albedo, gpu::kDemodulationFloor));
    if (!(gbuffer[i].depth > 0.0f) || !std::isfinite(light.x + light.y + light.z)) continue;
    direct += light;
    albedo += gbuffer[i].albedo;
    unoccluded += signals[i].w;
    ++count;
  }
  if (count == 0.0) return glm::vec3(0.0f);
  const double enclosure = 1.0 - unoccluded / count;
  const glm::dvec3 sent_out = direct / (count - glm::min(albedo, count * 0.99) * enclosure);
  return glm::vec3(sent_out * enclosure);
}

} // namespace wavepath
