#include "host/integrators/radiosity/radiosity.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/integrators/radiosity/links.h"
#include "host/integrators/radiosity/settings.h"
#include "host/render/workspace/wave_queue.h"
#include "host/scene/pack/features.h"
#include "kernels/radiosity/radiosity_direct.spv.h"
#include "kernels/radiosity/radiosity_direct_query.spv.h"
#include "kernels/radiosity/radiosity_gather.spv.h"
#include "kernels/radiosity/radiosity_gather_query.spv.h"
#include "kernels/radiosity/radiosity_interpolate.spv.h"
#include "kernels/radiosity/radiosity_light.spv.h"
#include "kernels/radiosity/radiosity_light_query.spv.h"
#include "kernels/radiosity/radiosity_link.spv.h"
#include "kernels/radiosity/radiosity_link_query.spv.h"
#include "kernels/radiosity/radiosity_patch.spv.h"
#include "kernels/radiosity/radiosity_see.spv.h"
#include "kernels/radiosity/radiosity_see_query.spv.h"
#include "kernels/radiosity/radiosity_shoot.spv.h"
#include "kernels/radiosity/radiosity_shoot_query.spv.h"

namespace wavepath {
namespace {

const std::array<KernelCode, kRadiosityStageCount> kStages = {
    {{"radiosity patch", wavepath_radiosity_patch_spv},
     {"radiosity light", wavepath_radiosity_light_spv, {}, wavepath_radiosity_light_query_spv},
     {"radiosity shoot", wavepath_radiosity_shoot_spv, {}, wavepath_radiosity_shoot_query_spv},
     {"radiosity link", wavepath_radiosity_link_spv, {}, wavepath_radiosity_link_query_spv},
     {"radiosity see", wavepath_radiosity_see_spv, {}, wavepath_radiosity_see_query_spv},
     {"radiosity interpolate", wavepath_radiosity_interpolate_spv},
     {"radiosity direct", wavepath_radiosity_direct_spv, {}, wavepath_radiosity_direct_query_spv},
     {"radiosity gather", wavepath_radiosity_gather_spv, {}, wavepath_radiosity_gather_query_spv}}};
constexpr std::array<std::size_t, kRadiosityStageCount> kCompileOrder = {
    kGatherOther, kGatherDirect, kPatchLight, kShoot, kLink, kSee, kPatchMeasure, kInterpolate};

constexpr Binding kSeenPoints = {gpu::kBindSeenPoints, BindingKind::storage};

// A final gather of at least one bounce.
bool gathers(const RenderPlan& settings) { return settings.gather && settings.max_depth > 0; }

std::vector<Binding> layout() {
  std::vector<Binding> layout = path_layout(), own = Solver::layout();
  layout.insert(layout.end(), own.begin(), own.end());
  layout.push_back(kSeenPoints);
  return layout;
}

bool links_too_many(const RenderPlan& settings, const PackedScene& scene) {
  return settings.form_factors == kFormFactorsLinks && scene.triangle_count > kMostLinkedTriangles;
}

} // namespace

std::string radiosity_lacks(const RenderPlan& settings, const PackedScene& scene) {
  constexpr gpu::Feature kThrough = gpu::kFeatureTransmission | gpu::kLobeDiffuseTransmission;
  const auto cannot = [](std::string_view what) { return fmt::format("cannot render {}, which the scene has", what); };
  if (scene.features & kThrough) return cannot("surfaces that let light through");
  if (scene.features & gpu::kFeatureSoftLamps) return cannot("lamps with an extent (--sun-angle, --lamp-radius)");
  if (scene.features & gpu::kFeatureVoxels) return cannot("a volume of voxels");
  if (settings.moving) return cannot("surfaces that move while the shutter is open (--shutter)");
  if (scene.triangle_count > kMostPatchTriangles)
    return cannot(fmt::format("more than {} triangles, each a patch at least", kMostPatchTriangles));
  if (links_too_many(settings, scene))
    return fmt::format("cannot link all pairs of more than {} triangles, which --form-factors rays need not",
                       kMostLinkedTriangles);
  return "";
}

const KernelProgram kRadiosityProgram = {kStages, kCompileOrder, layout};

KernelNeed radiosity_need(const KernelConfig& config, const RenderPlan& settings) {
  std::uint32_t stages = 1u << kPatchMeasure | 1u << kSee;
  if (Solver::is_looked_up(settings)) {
    stages |= 1u << (settings.form_factors == kFormFactorsLinks ? kLink : kShoot);
    if (config.features & (gpu::kFeaturePunctualLights | gpu::kFeatureEnvironment)) stages |= 1u << kPatchLight;
  }
  stages |= gathers(settings) ? 1u << kGatherDirect | 1u << kGatherOther : 1u << kInterpolate;
  return {&kRadiosityProgram, stages, config};
}

Radiosity::Radiosity(Workspace& workspace, KernelCompiler& kernels)
    : workspace_(workspace), kernels_(kernels), paths_(workspace, kernels), solver_(workspace) {}

void Radiosity::change(const View& view, const RenderPlan& settings, TemporalHistory) {
  const PackedScene& scene = workspace_.scene;
  if (const std::string problem = radiosity_lacks(settings, scene); !problem.empty())
    throw Error("--integrator radiosity", problem,
                links_too_many(settings, scene) ? "use --form-factors rays" : "use --integrator path");
  settings_ = settings;
  need_ = radiosity_need(kernel_config(needed_features(scene, view, settings), scene.stack_size, settings), settings);
  kernels_.start(need_);
  const gpu::Feature features = kernels_.features(kRadiosityProgram);
  bool moved = paths_.change(settings, stage_bits({kAccumulate}), kStatesAlone, features);
  moved |= reserve(workspace_.device, seen_, workspace_.slots * sizeof(gpu::SeenPoint));
  key_ = {settings.patches,
          settings.subdivision,
          settings.form_factors,
          settings.patch_rays,
          workspace_.frame.seed,
          settings.sampler,
          settings.cull,
          settings.terminator,
          std::min(settings.max_depth, 2u),
          Solver::is_looked_up(settings)};
  is_solving_ = false;
  solver_.stop();
  if (solved_ != key_) solved_.reset();
  serves_again_ = solved_.has_value();
  if (serves_again_ && moved) bind();
}

bool Radiosity::is_ready() {
  const bool film = paths_.is_ready(); // asks for both, so that both are begun
  return kernels_.ready(need_) && film;
}

double Radiosity::get_ready() { return kernels_.best(need_).seconds() + paths_.get_ready(); }

void Radiosity::bind() {
  std::vector<Binding> own;
  paths_.buffers.add_bindings(own);
  solver_.add_bindings(own);
  own.push_back(kSeenPoints);
  own.back().buffer = &seen_;
  sets_ = bind_bands(workspace_, own);
}

// A pilot of one sample of one pixel, which is not traced: the render can be stopped between the parts of a solution.
std::optional<Pilot> Radiosity::pilot() {
  if (solved_) return std::nullopt;
  is_solving_ = true;
  if (!solver_.is_at_work()) solver_.begin(settings_);
  return Pilot{.segments = {{0, 0, 1, 0}}};
}

bool Radiosity::end_pilot() {
  is_solving_ = false;
  return !solved_;
}

void Radiosity::begin_pass(WaveQueue& queue, std::uint32_t) {
  if (!is_solving_) return;
  queue.drain();
  const bool is_solved = solver_.step(kernels_.best(need_), queue, [this]() -> const BindingSet& {
    bind();
    return *sets_.front();
  });
  if (is_solved) solved_ = key_;
}

void Radiosity::record_wave(Commands& commands, std::size_t band, const gpu::Wave& wave) {
  if (is_solving_) return;
  const KernelSet& kernels = kernels_.best(need_);
  const std::uint32_t groups = groups_for(gpu::level_slots(wave));
  commands.bind(*sets_[band]);
  commands.dispatch(kernels[kSee], groups, &wave);
  commands.barrier();
  if (gathers(settings_)) {
    commands.dispatch(kernels[kGatherDirect], groups, &wave);
    commands.barrier();
    commands.dispatch(kernels[kGatherOther], groups, &wave);
  } else {
    commands.dispatch(kernels[kInterpolate], groups, &wave);
  }
  commands.barrier();
  commands.bind(paths_.bindings(band));
  commands.dispatch(paths_.kernels()[kAccumulate], groups_for(wave.pixel_count), &wave);
}

void Radiosity::describe(RenderResult& result) const {
  result.radiosity = solver_.report();
  result.radiosity->kept = serves_again_;
}

} // namespace wavepath
