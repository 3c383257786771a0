// Paths in flight: their state, the queues between the stages that trace them, and those stages. Every integrator that
// follows paths owns a `Paths`.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <memory>
#include <vector>

#include "host/render/loop/integrator.h"
#include "host/render/settings/direct_sampling.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/render/workspace/resources.h"
#include "host/render/workspace/workspace.h"
#include "kernels/path/path_types.h"

namespace wavepath {

enum PathStage : std::size_t {
  kGenerate,
  kAdvance,
  kExtend,
  kCollide, // in scenes with a volume
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
// Stages from a first hit on.
inline constexpr std::uint32_t kLightingStages = stage_bits({kAdvance, kExtend, kShade, kConnect});
inline constexpr std::uint32_t kAllPathStages =
    stage_bits({kGenerate, kAdvance, kExtend, kShade, kEscape, kConnect, kReuse,
                kAccumulate}); // stages of a path tracer that is not training

extern const KernelProgram kPathProgram;
// The same stages as a program of its own: a kernel set of one program never replaces one of the other.
extern const KernelProgram kGuideTrainingProgram;

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
                               kStatesAlone = 1u << 2, // another kernel traces the rays, so there are no queues
    kCapacityForLightSums = 1u << 3, kCapacityForGuide = 1u << 4, kCapacityForGuideRecords = 1u << 5,
                               kCapacityForSortedRays = 1u << 6, kCapacityForReuse = 1u << 7;

class Paths {
public:
  Paths(Workspace& workspace, KernelCompiler& kernels);

  // Adopts the settings and the workspace's frame: begins compiling `stages` and reserves memory. `options`: kCapacity
  // bits and kStatesAlone. `film_features`: kFeature bits of the integrator's other kernels. Returns true if buffers
  // were replaced.
  bool change(const RenderPlan& settings, std::uint32_t stages, std::uint32_t options, gpu::Feature film_features = 0);
  bool is_ready() { return kernels_.ready(need_); }
  double get_ready() { return kernels_.best(need_).seconds(); }
  const KernelConfig& config() const { return need_.config; }
  const DirectSampling& sampling() const { return sampling_; }
  // May return a more specialized set than for the last wave.
  const KernelSet& kernels() { return kernels_.best(need_); }

  // The functions below record into `commands`, to which bindings(band) must be bound. Bounce 0 is that of camera rays.
  // A barrier is recorded before each stage, and none after.
  // `is_prepared`: connect() of the bounce before has prepared it.
  void extend(Commands& commands, const KernelSet& kernels, gpu::Wave wave, std::uint32_t bounce,
              bool is_prepared = false) const;
  // Where rays are sorted, also dispatches `escape`. `shading`: the kernel set that has `shade` and `escape`.
  void shade(Commands& commands, const KernelSet& kernels, const KernelSet& shading, gpu::Wave wave,
             std::uint32_t bounce) const;
  // Traces the shadow rays of each light sample, one sample after the other. `prepares_extend`: also prepares `extend`
  // of the next bounce, if shadow rays are traced; `shade` must sort its rays then. Returns true if it did.
  bool connect(Commands& commands, const KernelSet& kernels, gpu::Wave wave, std::uint32_t bounce,
               bool prepares_extend = false) const;

  const BindingSet& bindings(std::size_t band) const { return *sets_[band]; }
  // Buffer of transparency and shadow, which `buffers` lacks; bound where settings ask for them.
  void add_cover_binding(std::vector<Binding>& bindings) const;
  BufferSet buffers;

private:
  void advance(Commands& commands, const KernelSet& kernels, gpu::Wave wave, std::uint32_t bounce,
               std::uint32_t step) const;

  Workspace& workspace_;
  KernelCompiler& kernels_;
  KernelNeed need_;
  DirectSampling sampling_;
  std::vector<std::unique_ptr<BindingSet>> sets_; // one for each band
  Buffer cover_;                                  // PathCover of each slot (kFeatureCover)
  bool covers_ = false;                           // the sets bind it
};

// Kernels of `stages`; `escape` is included only where escaped rays are sorted, and `collide` where whole paths go
// through a scene with a volume.
KernelNeed path_need(const KernelProgram& program, std::uint32_t stages, const KernelConfig& config);

// Bytes of a path in the largest number of queues of shadow rays. A window reserves these, so that its number of paths
// does not depend on the setting.
inline constexpr std::uint64_t kMostShadowRayBytes = gpu::kMostLightSamples * sizeof(gpu::ShadowRay);

// Numbers and kinds of all bindings of the path kernels, without buffers.
std::vector<Binding> path_layout();

// kFeature bits that a view and settings need in this scene.
gpu::Feature needed_features(const PackedScene& scene, const View& view, const RenderPlan& settings);

// kFeature bits of kernels that fill the film: those of the requested AOVs and of groups of lights.
gpu::Feature film_features(const RenderPlan& settings);

// Bytes of state and queues of one path in flight. `options`: as in Paths::change().
std::uint64_t bytes_per_path(gpu::Feature features, std::uint32_t options, std::uint32_t shadow_queues = 1);

} // namespace wavepath
