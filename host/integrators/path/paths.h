// Paths in flight: their state, the queues between the stages that trace them, and those stages. Every integrator
// that follows paths owns one.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <memory>
#include <vector>

#include "host/render/loop/integrator.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/render/workspace/resources.h"
#include "host/render/workspace/workspace.h"
#include "kernels/path/path_types.h"

namespace wavepath {

enum PathStage : std::size_t {
  kGenerate,
  kAdvance,
  kExtend,
  kShade,
  kEscape,
  kConnect,
  kAccumulate,
  kGuideNote,
  kReuse,
  kPathStageCount
};
constexpr std::uint32_t stage_bits(std::initializer_list<PathStage> stages) {
  std::uint32_t bits = 0;
  for (const PathStage stage : stages) bits |= 1u << stage;
  return bits;
}
inline constexpr std::uint32_t kLightingStages =
    stage_bits({kAdvance, kExtend, kShade, kConnect}); // from a first hit on
inline constexpr std::uint32_t kAllPathStages =
    stage_bits({kGenerate, kAdvance, kExtend, kShade, kEscape, kConnect, kReuse,
                kAccumulate}); // of a path tracer that is not training

extern const KernelProgram kPathProgram;
extern const KernelProgram kGuideTrainingProgram; // the same stages; a set of one never stands in for one of the other

// Buffers of Paths, by index.
enum PathBuffer : std::size_t {
  kStates,
  kReceivers,
  kLightProbabilities,
  kLightSums,
  kMedia,
  kPathAovs,
  kRays,
  kHits,
  kSortedRays,
  kShadowRays,
  kQueues,
  kSeen,
  kGuideTree,
  kGuideMaps,
  kRecords
};

// Bits of BufferDimensions::options.
inline constexpr std::uint32_t kCapacityForShadowRays = 1u << 0, kCapacityForSeen = 1u << 1,
                               kStatesAlone = 1u << 2, // another kernel traces the rays: no queues between stages
    kCapacityForLightSums = 1u << 3, kCapacityForGuide = 1u << 4, kCapacityForGuideRecords = 1u << 5,
                               kCapacityForSortedRays = 1u << 6, kCapacityForReuse = 1u << 7;

class Paths {
public:
  Paths(Workspace& workspace, KernelCompiler& kernels);

  // Takes up settings and the workspace's frame: begins compiling `stages` and reserves memory. `options`: see above.
  // `film_features`: kFeature bits that other kernels of the integrator have. Returns whether buffers were replaced.
  bool change(const RenderPlan& settings, std::uint32_t stages, std::uint32_t options, gpu::Feature film_features = 0);
  bool is_ready() { return kernels_.ready(need_); }
  double get_ready() { return kernels_.best(need_).seconds(); }
  const KernelConfig& config() const { return need_.config; }
  const KernelSet& kernels() { return kernels_.best(need_); } // may be a better one than for the last wave

  // Recorded into commands that bindings(band) are bound to; bounce 0 is that of camera rays. A barrier comes before
  // each, and none after.
  // `is_prepared`: by connect of the bounce before.
  void extend(Commands& commands, const KernelSet& kernels, gpu::Wave wave, std::uint32_t bounce,
              bool is_prepared = false) const;
  // Where rays are sorted, it also ends the paths that escaped. `shading`: the set of shade, and of escape.
  void shade(Commands& commands, const KernelSet& kernels, const KernelSet& shading, gpu::Wave wave,
             std::uint32_t bounce) const;
  // One after the other the shadow rays of each light sample. `prepares_extend`: of the next bounce as well, if there
  // are any; shade must sort its rays then. Returns whether it has.
  bool connect(Commands& commands, const KernelSet& kernels, gpu::Wave wave, std::uint32_t bounce,
               bool prepares_extend = false) const;

  const BindingSet& bindings(std::size_t band) const { return *sets_[band]; }
  BufferSet buffers;

private:
  void advance(Commands& commands, const KernelSet& kernels, gpu::Wave wave, std::uint32_t bounce,
               std::uint32_t step) const;

  Workspace& workspace_;
  KernelCompiler& kernels_;
  KernelNeed need_;
  std::vector<std::unique_ptr<BindingSet>> sets_; // by band
};

// The kernels of `stages`: escape only where escapes are sorted.
KernelNeed path_need(const KernelProgram& program, std::uint32_t stages, const KernelConfig& config);

// Of a path in the queues of its light samples, however many. A window keeps its number of paths when these change.
inline constexpr std::uint64_t kMostShadowRayBytes = gpu::kMostLightSamples * sizeof(gpu::ShadowRay);

// Numbers and kinds of all bindings of the path kernels, without buffers.
std::vector<Binding> path_layout();

// kFeature bits that a view and settings ask for in this scene.
gpu::Feature needed_features(const PackedScene& scene, const View& view, const RenderPlan& settings);

// kFeature bits of kernels that fill the film: those of the AOVs asked for.
gpu::Feature film_features(const RenderPlan& settings);

// Bytes of path state and queues that one path in flight takes, for the features given and as many light samples where
// it first scatters.
std::uint64_t bytes_per_path(gpu::Feature features, std::uint32_t options, std::uint32_t light_samples = 1);

} // namespace wavepath
