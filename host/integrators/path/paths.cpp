#include "host/integrators/path/paths.h"

#include <array>
#include <cstddef>

#include "host/integrators/path/guiding.h"
#include "host/integrators/path/light_histograms.h"
#include "host/integrators/path/sky_histograms.h"
#include "host/render/settings/cover.h"
#include "host/render/settings/denoising.h"
#include "host/render/settings/light_groups.h"
#include "kernels/film/cover_types.h"
#include "kernels/path/accumulate.spv.h"
#include "kernels/path/advance.spv.h"
#include "kernels/path/collide.spv.h"
#include "kernels/path/connect.spv.h"
#include "kernels/path/connect_layered.spv.h"
#include "kernels/path/connect_layered_query.spv.h"
#include "kernels/path/connect_query.spv.h"
#include "kernels/path/escape.spv.h"
#include "kernels/path/escape_layered.spv.h"
#include "kernels/path/extend.spv.h"
#include "kernels/path/extend_query.spv.h"
#include "kernels/path/generate.spv.h"
#include "kernels/path/guide_note.spv.h"
#include "kernels/path/reuse.spv.h"
#include "kernels/path/reuse_query.spv.h"
#include "kernels/path/shade.spv.h"
#include "kernels/path/shade_layered.spv.h"

namespace wavepath {
namespace {

const std::array<KernelCode, kPathStageCount> kStages = {
    {{"generate", wavepath_generate_spv},
     {"advance", wavepath_advance_spv},
     {"extend", wavepath_extend_spv, {}, wavepath_extend_query_spv},
     {"collide", wavepath_collide_spv},
     {"shade", wavepath_shade_spv, wavepath_shade_layered_spv},
     {"escape", wavepath_escape_spv, wavepath_escape_layered_spv},
     {"connect", wavepath_connect_spv, wavepath_connect_layered_spv, wavepath_connect_query_spv,
      wavepath_connect_layered_query_spv},
     {"accumulate", wavepath_accumulate_spv},
     {"guide note", wavepath_guide_note_spv},
     {"reuse", wavepath_reuse_spv, {}, wavepath_reuse_query_spv}}};

// Shade takes as long to compile as all others together.
constexpr std::array<std::size_t, kPathStageCount> kCompileOrder = {
    kShade, kExtend, kCollide, kConnect, kEscape, kGenerate, kAccumulate, kAdvance, kReuse, kGuideNote};

// True if paths store the vertex where they were scattered: see the function of this name in
// kernels/path/receiver.glsl. Light paths store which soft lamp they began at.
bool keeps_receivers(const BufferDimensions& e) {
  const auto has = [&](gpu::Feature feature) { return (e.features & feature) != 0; };
  const bool through_panes = has(gpu::kFeaturePanes) && has(gpu::kFeatureTriangleLights);
  return !(e.options & kStatesAlone) &&
         (has(gpu::kFeatureLightTree) || has(gpu::kFeatureLearnedSky) || through_panes || has(gpu::kFeatureSoftLamps));
}

// Words of lights, followed by those of parts of the sky.
std::uint64_t learned_bytes(const BufferDimensions& e, std::uint64_t of_lights, std::uint64_t of_sky) {
  return (e.features & gpu::kFeatureLightCells ? of_lights : 0) + (e.features & gpu::kFeatureLearnedSky ? of_sky : 0);
}

using enum BindingKind;

// Indexed by PathBuffer.
const std::vector<BufferRule> kRules = {
    {"path states",
     [](const BufferDimensions& e) { return e.slots * sizeof(gpu::PathState); },
     {{gpu::kBindPaths, storage}, {gpu::kBindPathTexels, texels_rgba32f}}},
    {"samplers, receivers of light",
     [](const BufferDimensions& e) {
       const bool samplers = e.features & gpu::kFeatureAdaptive && !(e.options & kStatesAlone);
       return (samplers + keeps_receivers(e)) * e.slots * sizeof(glm::uvec4);
     },
     {{gpu::kBindReceivers, storage}, {gpu::kBindReceiverTexels, texels_rgba32ui}}},
    {"learned probabilities",
     [](const BufferDimensions& e) { return learned_bytes(e, kLightCellBytes, kSkyCellBytes); },
     {{gpu::kBindLightCells, texels_r32ui}}},
    {"sums of the light pilot",
     [](const BufferDimensions& e) {
       return e.options & kCapacityForLightSums ? learned_bytes(e, kLightSumBytes, kSkySumBytes) : 0;
     },
     {{gpu::kBindLightSums, storage}}},
    {"path media",
     [](const BufferDimensions& e) {
       const std::uint64_t words = (e.features & gpu::kLobeNested ? 2 : 1) * (e.features & gpu::kFeatureWalls ? 3 : 1);
       return e.features & gpu::kFeatureVolume ? e.slots * words * sizeof(std::uint32_t) : 0;
     },
     {{gpu::kBindPathMedia, storage}}},
    {"path AOVs",
     [](const BufferDimensions& e) { return e.features & gpu::kFeatureAovs ? e.slots * sizeof(gpu::PathAovs) : 0; },
     {{gpu::kBindPathAovs, storage}, {gpu::kBindPathAovTexels, texels_rgba32ui}}},
    {"rays",
     [](const BufferDimensions& e) {
       return e.options & kStatesAlone ? 0 : 2 * e.slots * sizeof(gpu::Ray);
     }, // two queues, which take turns
     {{gpu::kBindRays, storage}, {gpu::kBindRayTexels, texels_rgba32f}}},
    {"hits",
     [](const BufferDimensions& e) { return e.options & kStatesAlone ? 0 : e.slots * sizeof(gpu::Hit); },
     {{gpu::kBindHits, storage}, {gpu::kBindHitTexels, texels_rgba32ui}}},
    {"order of hits",
     [](const BufferDimensions& e) { return e.options & kCapacityForSortedRays ? e.slots * sizeof(std::uint32_t) : 0; },
     {{gpu::kBindSortedRays, storage}, {gpu::kBindSortedRayTexels, texels_r32ui}}},
    {"shadow rays",
     [](const BufferDimensions& e) {
       return e.options & kCapacityForShadowRays ? e.slots * e.shadow_queues * sizeof(gpu::ShadowRay) : 0;
     },
     {{gpu::kBindShadowRays, storage}, {gpu::kBindShadowRayTexels, texels_rgba32ui}}},
    {"queues",
     [](const BufferDimensions&) { return std::uint64_t{sizeof(gpu::Queues)}; },
     {{gpu::kBindQueues, storage}}},
    {"light seen directly",
     [](const BufferDimensions& e) { return e.options & kCapacityForSeen ? e.pixels * sizeof(gpu::vec4) : 0; },
     {{gpu::kBindSeen, storage}}},
    {"guide tree",
     [](const BufferDimensions& e) { return e.options & kCapacityForGuide ? kGuideTreeBytes : 0; },
     {{gpu::kBindGuideTree, texels_rgba32ui}}},
    {"guide maps",
     [](const BufferDimensions& e) { return e.options & kCapacityForGuide ? kGuideMapBytes : 0; },
     {{gpu::kBindGuideMaps, texels_rgba32ui}}},
    {"records for guiding, or for neighbours",
     [](const BufferDimensions& e) -> std::uint64_t {
       if (e.options & kCapacityForGuideRecords) return kGuideRecordBytes;
       return e.options & kCapacityForReuse ? e.slots * gpu::reuse_texel_count(e.features) * sizeof(glm::uvec4) : 0;
     },
     {{gpu::kBindGuideRecords, storage}, {gpu::kBindReuseTexels, texels_rgba32ui}}},
};

} // namespace

const KernelProgram kPathProgram = {kStages, kCompileOrder, path_layout};
const KernelProgram kGuideTrainingProgram = {kStages, kCompileOrder, path_layout};

KernelNeed path_need(const KernelProgram& program, std::uint32_t stages, const KernelConfig& config) {
  if (config.sort != gpu::kSortEscapes) stages &= ~stage_bits({kEscape});
  if (!(config.features & gpu::kFeatureVoxels))
    stages &= ~stage_bits({kCollide});
  else if (stages & stage_bits({kGenerate}) && stages & stage_bits({kShade}))
    stages |= stage_bits({kCollide});
  if (config.reuse == gpu::kReuseNone) stages &= ~stage_bits({kReuse});
  return {&program, stages, config};
}

std::vector<Binding> path_layout() {
  std::vector<Binding> layout = workspace_layout();
  add_layout(kRules, layout);
  return layout;
}

gpu::Feature needed_features(const PackedScene& scene, const View& view, const RenderPlan& settings) {
  return scene.features | (view.orthographic ? gpu::kFeatureOrthographic : 0) |
         (has_camera_model(view) ? gpu::kFeatureCameraModel : 0) |
         (view.velocity != glm::dvec3(0.0) ? gpu::kFeatureRelativity : 0) | features_of(settings);
}

gpu::Feature film_features(const RenderPlan& settings) {
  gpu::Feature features = records_groups(settings) ? gpu::kFeatureLightGroups : 0;
  if (has_cover(settings)) features |= gpu::kFeatureCover;
  if (!records_aovs(settings)) return features;
  return features | gpu::kFeatureAovs | (settings.aov_through ? gpu::kFeatureAovsThrough : 0);
}

std::uint64_t bytes_per_path(gpu::Feature features, std::uint32_t options, std::uint32_t shadow_queues) {
  std::uint64_t bytes = features & gpu::kFeatureCover ? sizeof(gpu::PathCover) : 0;
  for (const BufferRule& rule : kRules) {
    const auto of = [&](std::uint64_t slots) {
      return rule.bytes(
          {.pixels = 0, .slots = slots, .features = features, .options = options, .shadow_queues = shadow_queues});
    };
    bytes += of(1) - of(0);
  }
  return bytes;
}

Paths::Paths(Workspace& workspace, KernelCompiler& kernels)
    : buffers(workspace.device, kRules), workspace_(workspace), kernels_(kernels) {}

bool Paths::change(const RenderPlan& settings, std::uint32_t stages, std::uint32_t options,
                   gpu::Feature film_features) {
  const PackedScene& scene = workspace_.scene;
  need_ = path_need(kPathProgram, stages,
                    kernel_config(scene.features | camera_features(workspace_.frame) | features_of(settings),
                                  scene.stack_size, settings));
  sampling_ = direct_sampling(settings, scene.features);
  workspace_.frame.sky_samples = sampling_.sky;
  if (need_.config.sort != gpu::kSortNone) options |= kCapacityForSortedRays;
  if (stages & stage_bits({kReuse}) && need_.config.reuse != gpu::kReuseNone) options |= kCapacityForReuse;
  if (stages) kernels_.start(need_);
  // Kernels that were begun for other settings may run until these are ready.
  const gpu::Feature features = need_.config.features | kernels_.features(kPathProgram);
  if (!(options & kStatesAlone) &&
      (workspace_.frame.light_count > 0 || sampling_.sky > 1 || settings.kernels.shadow_rays))
    options |= kCapacityForShadowRays;
  bool moved = workspace_.fit(settings, features | film_features);
  moved |= buffers.fit({workspace_.film.pixels(), workspace_.slots, features, options, sampling_.queues()});
  const bool covers = (need_.config.features & gpu::kFeatureCover) != 0;
  if (covers) moved |= reserve(workspace_.device, cover_, workspace_.slots * sizeof(gpu::PathCover));
  moved |= covers != covers_;
  covers_ = covers;
  if (!moved && !sets_.empty()) return false;
  std::vector<Binding> own;
  buffers.add_bindings(own);
  add_cover_binding(own);
  sets_ = bind_bands(workspace_, own);
  return true;
}

void Paths::add_cover_binding(std::vector<Binding>& bindings) const {
  if (covers_) bindings.push_back({gpu::kBindPathCover, BindingKind::storage, &cover_});
}

// Prepares the queues for the next stage of a bounce.
void Paths::advance(Commands& commands, const KernelSet& kernels, gpu::Wave wave, std::uint32_t bounce,
                    std::uint32_t step) const {
  commands.barrier();
  wave.bounce = gpu::kAdvanceSteps * bounce + step;
  commands.dispatch(kernels[kAdvance], 1, &wave);
  commands.barrier();
}

void Paths::extend(Commands& commands, const KernelSet& kernels, gpu::Wave wave, std::uint32_t bounce,
                   bool is_prepared) const {
  if (is_prepared)
    commands.barrier();
  else
    advance(commands, kernels, wave, bounce, gpu::kBeforeExtend);
  wave.bounce = bounce;
  commands.dispatch_indirect(kernels[kExtend], buffers[kQueues], offsetof(gpu::Queues, extend_groups), &wave);
}

void Paths::shade(Commands& commands, const KernelSet& kernels, const KernelSet& shading, gpu::Wave wave,
                  std::uint32_t bounce) const {
  if (shading.config().features & gpu::kFeatureVoxels) {
    commands.barrier();
    wave.bounce = bounce;
    const bool trains = (shading.config().features & gpu::kFeatureTraining) != 0;
    commands.dispatch_indirect((trains ? shading : kernels)[kCollide], buffers[kQueues],
                               offsetof(gpu::Queues, extend_groups), &wave);
  }
  const std::uint32_t sort = shading.config().sort;
  std::size_t groups = offsetof(gpu::Queues, extend_groups);
  if (sort != gpu::kSortNone) {
    advance(commands, kernels, wave, bounce, gpu::kBeforeShade);
    groups = offsetof(gpu::Queues, shade_groups);
  } else {
    commands.barrier();
  }
  wave.bounce = bounce;
  commands.dispatch_indirect(shading[kShade], buffers[kQueues], groups, &wave);
  if (sort != gpu::kSortEscapes) return;
  commands.barrier(); // between paths of their own in the same buffers
  commands.dispatch_indirect(shading[kEscape], buffers[kQueues], offsetof(gpu::Queues, escape_groups), &wave);
}

bool Paths::connect(Commands& commands, const KernelSet& kernels, gpu::Wave wave, std::uint32_t bounce,
                    bool prepares_extend) const {
  const gpu::Frame& frame = workspace_.frame;
  const bool trains_sky = frame.scene_lobes & static_cast<std::uint32_t>(gpu::kFeatureLearnedSky >> 32);
  const std::uint32_t of_lights = frame.light_count > 0 ? sampling_.light_rays_at(bounce) : 0;
  const std::uint32_t of_sky = sampling_.sky_rays_at(bounce, trains_sky);
  for (std::uint32_t i = 0; i < of_lights + of_sky; ++i) {
    const std::uint32_t queue = i < of_lights ? i : sampling_.lights + i - of_lights;
    const bool is_last = i + 1 == of_lights + of_sky;
    advance(commands, kernels, wave, bounce,
            (is_last && prepares_extend ? gpu::kBeforeLastConnect : gpu::kBeforeConnect) + queue);
    wave.bounce = bounce;
    commands.dispatch_indirect(kernels[kConnect], buffers[kQueues], offsetof(gpu::Queues, connect_groups), &wave);
  }
  return prepares_extend && of_lights + of_sky > 0;
}

} // namespace wavepath
