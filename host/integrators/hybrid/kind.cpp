#include "host/integrators/hybrid/kind.h"
#include "host/integrators/hybrid/occlusion_radius.h"

#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/integrators/hybrid/antialias/catalogue.h"
#include "host/integrators/hybrid/beams.h"
#include "host/integrators/hybrid/bounce/catalogue.h"
#include "host/integrators/hybrid/bounce/lit_voxels.h"
#include "host/integrators/hybrid/defocus.h"
#include "host/integrators/hybrid/denoise.h"
#include "host/integrators/hybrid/hybrid.h"
#include "host/integrators/hybrid/motion_blur.h"
#include "host/integrators/hybrid/occlusion/catalogue.h"
#include "host/integrators/hybrid/reflections/catalogue.h"
#include "host/integrators/hybrid/rows.h"
#include "host/integrators/hybrid/shading/catalogue.h"
#include "host/integrators/hybrid/shadows/catalogue.h"
#include "host/integrators/hybrid/taa.h"
#include "host/integrators/hybrid/transparency/catalogue.h"
#include "host/integrators/hybrid/transparency/layers.h"
#include "host/integrators/hybrid/voxel_settings.h"
#include "host/integrators/hybrid/voxels/surface_voxels.h"
#include "host/render/render.h"
#include "host/render/settings/mips.h"
#include "host/render/settings/settings_table.h"
#include "host/render/settings/shadow_settings.h"
#include "host/scene/pack/features.h"
#include "host/scene/pack/pack.h"
#include "kernels/hybrid/hybrid_types.h"
#include "kernels/hybrid/reflections/reflection_types.h"

namespace wavepath {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::string_view, 41> kHybridSettings = {"first-hit",
                                                              "lens",
                                                              "shutter",
                                                              "hemisphere",
                                                              "direct",
                                                              "lights",
                                                              "shadow-samples",
                                                              "ao-samples",
                                                              "ao-radius",
                                                              "ambient",
                                                              "denoise",
                                                              "mips",
                                                              "terminator",
                                                              "shadows",
                                                              "shadow-size",
                                                              "shadow-bias",
                                                              "shadow-taps",
                                                              "shadow-pattern",
                                                              "shadow-blur",
                                                              "shadow-cascades",
                                                              "shadow-exponent",
                                                              "shadow-bits",
                                                              "shadow-source",
                                                              "shadow-cookie",
                                                              "shadow-ambient",
                                                              "shading",
                                                              "interpolation",
                                                              "shininess",
                                                              "attenuation",
                                                              "depth-cue",
                                                              "transparency",
                                                              "transparency-layers",
                                                              "transparency-samples",
                                                              "occlusion",
                                                              "ao-bias",
                                                              "ao-thinness",
                                                              "voxels",
                                                              "antialias",
                                                              "reflections",
                                                              "reflection-threshold",
                                                              "bounce"};
constexpr std::array<std::string_view, 10> kAoSettings = {"first-hit",  "ao-samples", "ao-radius", "denoise",
                                                          "terminator", "occlusion",  "ao-bias",   "ao-thinness",
                                                          "antialias",  "voxels"};
constexpr std::array<std::string_view, 1> kAovs = {"ao"};
constexpr std::array<std::string_view, 2> kFirstHitStages = {"raster", "resolve"};

constexpr const char* kDefocusBias =
    "depth of field spreads pixels over their spots, of what one pinhole sees (--aperture)";

// Indexed by the values of --interpolation.
constexpr std::array<std::string_view, 3> kEvaluated = {
    "evaluated once a face", "evaluated at corners and interpolated (Gouraud 1971)", "evaluated in every pixel"};

constexpr const char* kMotionBlurBias =
    "motion blur spreads what one moment shows, the middle of the shutter, along its way in the picture (--shutter)";

constexpr const char* kFilterBias = "direct light and occlusion are filtered over space and time (--denoise)";

// AOVs come from the G-buffer, not from the path tracer's kernels.
gpu::Feature features(const RenderPlan&) { return gpu::kFeatureSharedFirstHit; }

bool lights_voxels(const RenderPlan& settings) {
  const ReflectionKind* bounce = kBounceTechniques.find(settings);
  return bounce && bounce->voxels;
}

// Kernels of light, and of the techniques that stand for a part of it.
void start_lighting_kernels(KernelCompiler& kernels, const RenderPlan& settings, const KernelConfig& config) {
  const ShadingKind* shading = kShadingModels.find(settings);
  const ReflectionKind* reflections = reflecting_technique(settings);
  const std::uint32_t traces = reflections && reflections->traces ? stage_bits({kExtend}) : 0;
  kernels.start({&kPathProgram, (shading ? kLocalPathStages : kLightingStages) | traces, config});
  if (reflections) kernels.start(reflection_need(*reflections, config, false)); // whether mirrors nest is not known yet
  if (lights_voxels(settings)) kernels.start(whole_need(kVoxelLightProgram, config));
  if (shading) kernels.start(whole_need(*shading->program, config));
  if (const ShadowKind* shadows = kShadowTechniques.find(settings))
    kernels.start(whole_need(*shadows->program, config));
}

// Those that draw, trace first hits or filter frames are made with their buffers.
void start_kernels(KernelCompiler& kernels, const DeviceInfo& device, gpu::Feature features,
                   const RenderPlan& settings) {
  const auto start = [&](gpu::Feature bits) {
    const KernelConfig config = kernel_config(bits, kExpectedStack, settings);
    const KernelNeed frame = hybrid_need(settings, config);
    kernels.start(frame);
    if (kAntialiasTechniques.find(settings)->beam) kernels.start(whole_need(kBeamProgram, frame.config));
    if (settings.integrator->finds_light) start_lighting_kernels(kernels, settings, config);
    const OcclusionKind* occlusion = kOcclusionTechniques.find(settings);
    if (occlusion && has_ambient(settings)) kernels.start(whole_need(*occlusion->program, frame.config));
    if (uses_voxels(settings)) kernels.start(whole_need(kVoxelProgram, frame.config));
  };
  if ((features & gpu::kFeatureTextures) && wants_mips(settings)) features |= gpu::kFeatureMips;
  start(features);
  if (generic_first(device)) start(generic_features(features));
}

std::uint64_t layer_bytes(const RenderPlan& settings) {
  const TransparencyKind* kind = kTransparencyTechniques.find(settings);
  return kind && kind->layers ? layer_bytes_per_pixel(*kind->layers) : 0;
}

// Bytes of a pixel for shared colours, or for the parts that beams find.
std::uint64_t shared_color_bytes(const RenderPlan& settings) {
  const AntialiasKind& kind = *kAntialiasTechniques.find(settings);
  if (kind.beam) return gpu::kFractions * (sizeof(glm::uvec2) + sizeof(float));
  return kind.positions > 0 ? gpu::kSharedColors * (sizeof(glm::uvec2) + 2 * sizeof(gpu::vec4)) : 0;
}

std::uint64_t reflection_bytes(const RenderPlan& settings) {
  const ReflectionKind* kind = reflecting_technique(settings);
  return kind ? sizeof(gpu::vec4) + kind->bytes_per_pixel : 0;
}

std::vector<MemoryItem> frame_items(const RenderPlan& settings, const ScenePlan&, gpu::Feature) {
  std::vector<MemoryItem> items;
  if (uses_voxels(settings)) items.push_back({"surface voxels", most_voxel_bytes(settings.voxels)});
  if (lights_voxels(settings)) items.push_back({"light of voxels", most_voxel_light_bytes(settings.voxels)});
  if (kAntialiasTechniques.find(settings)->beam) items.push_back({"triangles of beams", Beams::most_list_bytes()});
  return items;
}

// Bytes of a slot for the ray from the first mirror to the second one; 0 where mirrors do not show mirrors.
std::uint64_t nested_ray_bytes(const RenderPlan& settings) {
  const ReflectionKind* kind = kReflectionTechniques.find(settings);
  return kind && settings.max_depth > 1 && reflection_depth(*kind, settings) > 1 ? sizeof(gpu::NestedRay) : 0;
}

std::uint64_t bytes_per_pixel(const RenderPlan& settings) {
  constexpr std::uint64_t kIds = 2 * sizeof(std::uint32_t), kDepth = sizeof(float); // drawn, and copied once
  return sizeof(gpu::GbufferPixel) + 2 * sizeof(gpu::vec4) + 2 * kIds + kDepth +
         (settings.denoise != kDenoiseOff ? Denoiser::bytes_per_pixel() : 0) +
         (has_lens(settings) ? Defocus::bytes_per_pixel() : 0) +
         (blurs_motion(settings) ? MotionBlur::bytes_per_pixel() : 0) +
         (kAntialiasTechniques.find(settings)->over_time ? Taa::bytes_per_pixel() : 0) + layer_bytes(settings) +
         shared_color_bytes(settings) + reflection_bytes(settings);
}

void add_shading_bias(const RenderPlan& settings, std::vector<std::string>& bias) {
  const ShadingKind* shading = kShadingModels.find(settings);
  if (!shading) return;
  bias.push_back(fmt::format("surfaces reflect by {}, {}, in the place of their glTF materials (--shading {})",
                             shading->summary, kEvaluated[settings.interpolation], shading->name));
  if (settings.attenuation)
    bias.push_back(fmt::format("light falls off by 1 / ({} + {} d + {} d^2) with the distance d (--attenuation)",
                               settings.attenuation->x, settings.attenuation->y, settings.attenuation->z));
  if (settings.depth_cue)
    bias.push_back(fmt::format("surfaces fade into the background between depths of {} and {} metres (--depth-cue)",
                               settings.depth_cue->x, settings.depth_cue->y));
}

void add_transparency_bias(const RenderPlan& settings, std::vector<std::string>& bias) {
  const TransparencyKind* kind = kTransparencyTechniques.find(settings);
  if (!kind) return;
  bias.push_back(fmt::format("{} are {} (--transparency {})", kind->subject, kind->summary, kind->name));
  if (!kind->layers) return;
  bias.push_back(
      fmt::format("light of {} has no shadows, and their ambient term no occlusion "
                  "(--transparency {})",
                  kind->subject, kind->name));
  if (kTransparencyTechniques.supports(settings, "transparency-layers"))
    bias.push_back(fmt::format("of BLEND surfaces that lie behind each other, {} are seen (--transparency-layers)",
                               settings.transparency_layers));
}

// Bias of every frame, whatever it shows.
void add_common_bias(const RenderPlan& settings, std::vector<std::string>& bias) {
  if (settings.denoise != kDenoiseOff) bias.emplace_back(kFilterBias);
  if (has_lens(settings)) bias.emplace_back(kDefocusBias);
  if (blurs_motion(settings)) bias.emplace_back(kMotionBlurBias);
  if (const AntialiasKind& antialias = *kAntialiasTechniques.find(settings); antialias.is_biased)
    bias.push_back(fmt::format("edges are those of {} (--antialias {})", antialias.summary, antialias.name));
  if (const OcclusionKind* occlusion = kOcclusionTechniques.find(settings))
    bias.push_back(fmt::format("ambient occlusion is that of {}, which knows {} (--occlusion {})", occlusion->summary,
                               occlusion->voxels ? "surfaces as voxels" : "nothing but what the picture shows",
                               occlusion->name));
}

std::vector<std::string> hybrid_bias(const RenderPlan& settings, const RenderResult& result) {
  std::vector<std::string> bias;
  if (settings.max_depth <= 1)
    bias.push_back(fmt::format("light paths end after {} bounces (--max-depth)", settings.max_depth));
  else if (const ReflectionKind* bounce = kBounceTechniques.find(settings))
    bias.push_back(
        fmt::format("light of more than one bounce is that of one bounce off matt surfaces, {} (--bounce {})",
                    bounce->summary, bounce->name));
  else
    bias.push_back(
        fmt::format("light of more than one bounce, what {} of it included, is an ambient "
                    "term of radiance {:.3g},{:.3g},{:.3g} (--integrator hybrid, --ambient)",
                    kReflectionTechniques.find(settings) ? "glass shows" : "mirrors and glass show", result.ambient.r,
                    result.ambient.g, result.ambient.b));
  add_common_bias(settings, bias);
  add_shading_bias(settings, bias);
  add_transparency_bias(settings, bias);
  if (const ReflectionKind* reflections = kReflectionTechniques.find(settings))
    bias.push_back(
        fmt::format("what mirrors show of lit surfaces is {}, {} deep (--reflections {})", reflections->summary,
                    reflection_depth(*reflections, settings) == 1 ? "one mirror" : "two mirrors", reflections->name));
  const ShadowKind* shadows = kShadowTechniques.find(settings);
  if (!shadows || !result.shadows) return bias;
  bias.push_back(fmt::format("shadows of {} are those of {} (--shadows {})", result.shadows->covered, shadows->summary,
                             shadows->name));
  if (!result.shadows->smaller.empty()) bias.push_back(result.shadows->smaller);
  if (!result.shadows->traced.empty())
    bias.push_back(fmt::format("shadows of {} are traced: --shadows {} does not cover them", result.shadows->traced,
                               shadows->name));
  return bias;
}

Json cost_json(const FrameCost& cost) { return {{"median", cost.median}, {"least", cost.least}, {"most", cost.most}}; }

Json shadow_json(const RenderPlan& settings, const std::optional<ShadowReport>& shadows) {
  if (!shadows) return nullptr;
  Json json = {{"technique", kShadowTechniques.find(settings)->name},
               {"covered", shadows->covered},
               {"traced", shadows->traced},
               {"views", shadows->views},
               {"size", shadows->size > 0 ? Json(shadows->size) : Json()},
               {"bytes", shadows->bytes},
               {"build_ms", cost_json(shadows->build)},
               {"look_up_ms", cost_json(shadows->look_up)}};
  if (shadows->answers)
    json.update({{"rays_answered", shadows->answers->answered}, {"rays_traced", shadows->answers->traced}});
  if (shadows->pages > 0) json.update({{"pages", shadows->pages}, {"resident_pages", shadows->resident_pages}});
  if (shadows->longest_list > 0) json.update({{"longest_list", shadows->longest_list}}); // shadow rays
  if (shadows->farthest > 0.0f) json.update({{"nearest", shadows->nearest}, {"farthest", shadows->farthest}}); // metres
  return json;
}

Json occlusion_json(const RenderPlan& settings, const std::optional<OcclusionReport>& occlusion) {
  if (!occlusion) return nullptr;
  return {{"technique", kOcclusionTechniques.find(settings)->name}, {"ms", cost_json(occlusion->cost)}};
}

Json reflection_json(const RenderPlan& settings, const std::optional<ReflectionReport>& reflections) {
  if (!reflections) return nullptr;
  const auto asked = static_cast<double>(std::max<std::uint64_t>(reflections->asked, 1));
  return {{"technique", kReflectionTechniques.find(settings)->name},
          {"threshold", settings.reflection_threshold},
          {"asked", reflections->asked},
          {"missed", static_cast<double>(reflections->asked - reflections->answered) / asked}};
}

// Milliseconds, where they are counted apart: a mean of frames, and once for all of them.
Json bounce_json(const RenderPlan& settings, const RenderResult& result) {
  if (!kBounceTechniques.find(settings)) return nullptr;
  const auto ms = [&](std::string_view name, std::uint32_t frames) {
    const auto stage = std::ranges::find(result.stages, name, &StageTime::name);
    return stage == result.stages.end() ? Json() : Json(1000.0 * stage->seconds / frames);
  };
  return {{"technique", kBounceTechniques.name(settings)},
          {"build_ms", ms(kVoxelLightStage, 1)},
          {"ms", ms(kBounceConesStage, std::max(result.spp, 1u))}};
}

Json motion_blur_json(const RenderPlan& settings, const RenderResult& result) {
  if (!blurs_motion(settings)) return nullptr;
  const auto stage = std::ranges::find(result.stages, kMotionBlurStage, &StageTime::name);
  const double seconds = stage == result.stages.end() ? 0.0 : stage->seconds;
  return {{"ms", 1000.0 * seconds / std::max(result.spp, 1u)}}; // mean of a frame
}

Json antialias_json(const RenderPlan& settings, const std::optional<FrameCost>& cost) {
  return {{"technique", kAntialiasTechniques.find(settings)->name}, {"ms", cost ? cost_json(*cost) : Json()}};
}

// Refuses techniques that look at a frame as a whole, where frames see parts of pixels.
void check_parts_of_pixels(const RenderPlan& settings) {
  const AntialiasKind& kind = *kAntialiasTechniques.find(settings);
  if (!kind.beam) return;
  const auto refuse = [&](const char* flag) {
    throw UsageError(flag,
                     fmt::format("is not supported by --antialias {}, whose frames see parts of pixels", kind.name),
                     "leave it out");
  };
  const TransparencyKind* transparency = kTransparencyTechniques.find(settings);
  if (settings.denoise != kDenoiseOff) refuse("--denoise");
  if (has_lens(settings)) refuse("--aperture");
  if (blurs_motion(settings)) refuse("--shutter");
  if (kOcclusionTechniques.find(settings)) refuse("--occlusion");
  if (transparency && transparency->flag == gpu::kHybridRefractive) refuse("--transparency");
  if (const ReflectionKind* reflections = reflecting_technique(settings); reflections && reflections->searches_picture)
    refuse(kBounceTechniques.find(settings) ? "--bounce" : "--reflections");
  if (!settings.aovs.empty()) refuse("--aov");
}

void check_frame_settings(const RenderPlan& settings) {
  if (has_lens(settings) && settings.lens.blades > 0)
    throw UsageError("--blades", "is not known to --integrator hybrid, whose spots are discs",
                     "leave it out, or use --integrator path");
  check_motion_settings(settings);
  check_occlusion_settings(settings);
  check_antialias_settings(settings);
  check_voxel_settings(settings);
  check_parts_of_pixels(settings);
}

bool has_biased_frames(const RenderPlan& settings) {
  return settings.denoise != kDenoiseOff || has_lens(settings) || blurs_motion(settings) ||
         kOcclusionTechniques.find(settings) || kAntialiasTechniques.find(settings)->is_biased;
}

std::string unsupported_reason_of(const RenderPlan& settings, const PackedScene& scene) {
  if (const std::string problem = lacked_lobes(scene, kHybridLacks); !problem.empty()) return problem;
  const ShadowKind* shadows = kShadowTechniques.find(settings);
  return shadows ? unsupported_reason(*shadows, scene) : "";
}

std::vector<std::string> ao_bias(const RenderPlan& settings, const RenderResult&) {
  std::vector<std::string> bias;
  add_common_bias(settings, bias);
  return bias;
}

std::vector<OmittedStage> always_omitted(const RenderPlan& settings) {
  std::vector<OmittedStage> omitted = {
      {"path kernels generate and accumulate", "hybrid frames begin with all first hits and end with composite"}};
  if (const OcclusionKind* occlusion = kOcclusionTechniques.find(settings))
    omitted.push_back({"occlusion rays", fmt::format("--occlusion {} looks at {}; rays find the ambient radiance "
                                                     "alone, where --ambient does not give it",
                                                     occlusion->name, occlusion->voxels ? "voxels" : "depths")});
  if (settings.denoise == kDenoiseOff) omitted.push_back({"filters over space and time", "--denoise is off"});
  return omitted;
}

std::vector<OmittedStage> hybrid_omitted(const RenderPlan& settings) {
  std::vector<OmittedStage> omitted = always_omitted(settings);
  if (settings.shadows == kShadowsTraced) omitted.push_back({"shadow techniques", "--shadows traced sends rays alone"});
  if (kShadingModels.find(settings))
    omitted.push_back({"path kernels shade and extend", "--shading draws no directions from materials"});
  if (!kReflectionTechniques.find(settings)) omitted.push_back({"mirrors of lit surfaces", "--reflections is none"});
  if (const ReflectionKind* bounce = kBounceTechniques.find(settings))
    omitted.push_back({"ambient occlusion", fmt::format("--bounce {} takes the place of its light", bounce->name)});
  else
    omitted.push_back({"a diffuse bounce", "--bounce is none"});
  if (settings.max_depth <= 1) omitted.push_back({"ambient occlusion", "--max-depth 1 asks for direct light alone"});
  return omitted;
}

std::vector<OmittedStage> ao_omitted(const RenderPlan& settings) {
  std::vector<OmittedStage> omitted = always_omitted(settings);
  omitted.push_back({"path kernels shade, connect and extend", "occlusion needs no light"});
  return omitted;
}

Json stats(const RenderPlan& settings, const PackedScene& scene, const RenderResult& result) {
  return {{"first_hit", kFirstHitNames[settings.first_hit]},
          {"shadow_samples", settings.shadow_samples},
          {"ao_samples", settings.ao_samples},
          {"ao_radius", occlusion_radius(scene, settings)},
          {"ambient", {result.ambient.r, result.ambient.g, result.ambient.b}},
          {"denoise", settings.denoise != kDenoiseOff},
          {"shading", kShadingModels.name(settings)},
          {"transparency", kTransparencyTechniques.name(settings)},
          {"shadows", shadow_json(settings, result.shadows)},
          {"occlusion", occlusion_json(settings, result.occlusion)},
          {"reflections", reflection_json(settings, result.reflections)},
          {"bounce", bounce_json(settings, result)},
          {"motion_blur", motion_blur_json(settings, result)},
          {"antialias", antialias_json(settings, result.antialias)},
          {"voxels", uses_voxels(settings) ? Json(settings.voxels) : Json()}};
}

void check(const RenderPlan& settings) {
  check_shadow_settings(settings);
  check_frame_settings(settings);
  check_shading_settings(settings);
  check_transparency_settings(settings);
  check_reflection_settings(settings);
  check_bounce_settings(settings);
}

bool has_effect(const RenderPlan& settings, std::string_view setting) {
  return kShadowTechniques.supports(settings, setting) && kOcclusionTechniques.supports(settings, setting) &&
         kShadingModels.supports(settings, setting) && kTransparencyTechniques.supports(settings, setting) &&
         kReflectionTechniques.supports(settings, setting) && voxels_support(settings, setting);
}

std::unique_ptr<Integrator> make(Workspace& workspace, KernelCompiler& kernels) {
  return std::make_unique<Hybrid>(workspace, kernels);
}

} // namespace

constinit const IntegratorKind kHybrid = {
    .name = "hybrid",
    .summary = "real-time frames of rasterized or traced first hits, direct light and ambient occlusion",
    .settings = kHybridSettings,
    .aovs = kAovs,
    .traces_paths = false,
    .first_hit_stages = kFirstHitStages,
    .rows = technique_rows,
    .check = check,
    .has_effect = has_effect,
    .unsupported_reason = unsupported_reason_of,
    .features = features,
    .start_kernels = start_kernels,
    .bytes_per_slot =
        [](gpu::Feature features, const RenderPlan& settings) {
          return bytes_per_path(features, kCapacityForShadowRays) + nested_ray_bytes(settings);
        },
    .largest_record = [](const RenderPlan&) { return kMostShadowRayBytes; }, // a window may turn to `path`
    .slots_per_pixel = [](const RenderPlan& settings) { return settings.shadow_samples; },
    .bytes_per_pixel = bytes_per_pixel,
    .items = frame_items,
    .is_biased =
        [](const RenderPlan& settings) {
          return has_biased_frames(settings) || settings.max_depth > 1 || uses_mips(settings) ||
                 kShadowTechniques.find(settings) || kShadingModels.find(settings) ||
                 kTransparencyTechniques.find(settings) || kReflectionTechniques.find(settings);
        },
    .bias = hybrid_bias,
    .omitted = hybrid_omitted,
    .stats = stats,
    .make = make,
};

constinit const IntegratorKind kAo = {
    .name = "ao",
    .summary = "only ambient occlusion",
    .settings = kAoSettings,
    .aovs = kAovs,
    .finds_light = false,
    .traces_paths = false,
    .walks_light_tree = false,
    .first_hit_stages = kFirstHitStages,
    .check = check_frame_settings,
    .has_effect =
        [](const RenderPlan& settings, std::string_view setting) {
          return kOcclusionTechniques.supports(settings, setting) && voxels_support(settings, setting);
        },
    .features = features,
    .start_kernels = start_kernels,
    .bytes_per_slot = [](gpu::Feature features,
                         const RenderPlan&) { return bytes_per_path(features, kCapacityForShadowRays); },
    .largest_record = [](const RenderPlan&) { return kMostShadowRayBytes; }, // a window may turn to `path`
    .slots_per_pixel = [](const RenderPlan&) { return 1u; },
    .bytes_per_pixel = bytes_per_pixel,
    .items = frame_items,
    .is_biased = has_biased_frames,
    .bias = ao_bias,
    .omitted = ao_omitted,
    .stats = stats,
    .make = make,
};

} // namespace wavepath
