// Shadow techniques: what is known of one before there is a device, and one at work, which answers the shadow rays of
// hybrid frames for the lights that it covers.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host/integrators/hybrid/shadows/source.h"
#include "host/integrators/path/paths.h"
#include "host/render/loop/render_result.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/render/workspace/wave_queue.h"
#include "host/render/workspace/workspace.h"
#include "host/scene/staging/view.h"

namespace wavepath {

class ShadowTechnique {
public:
  virtual ~ShadowTechnique() = default;

  // Takes up view and settings: begins compiling and reserves memory. `shared`: bindings of the frame's own buffers,
  // which look_up() may read: paths, kBindHybrid, kBindVisibility; they outlive the technique. Nothing is in flight.
  // Throws Error if the device cannot hold it.
  virtual void change(const View& view, const RenderPlan& settings, const std::vector<Binding>& shared) = 0;
  virtual bool is_ready() = 0;
  virtual double get_ready() = 0; // seconds that compiling took

  // Submits what has to be made before frame `sample`.
  virtual void build(WaveQueue& queue, std::uint32_t sample) = 0;
  // Records the answers to the shadow rays of the wave. A barrier comes before, and none after.
  virtual void record_look_up(Commands& commands, std::size_t band, const gpu::Wave& wave) = 0;

  virtual std::uint64_t bytes() const = 0;
  virtual std::uint32_t view_count() const = 0; // directions from lights that it keeps something of
  virtual void describe(ShadowReport&) const {} // what only some techniques know; nothing is in flight
};

struct ShadowKind;
struct ShadowMapRecipe; // shadow_maps.h

// What a technique is made of.
struct ShadowContext {
  const ShadowKind& kind;
  Workspace& workspace;
  KernelCompiler& kernels;
  std::vector<ShadowSource> sources; // that it covers
};

// One constant for each stands in its file.
struct ShadowKind {
  std::string_view name; // value of --shadows
  std::string_view summary;
  unsigned sources = 0;                         // kinds that it covers
  std::span<const std::string_view> settings{}; // that it takes besides shadow-ambient
  const KernelProgram* program = nullptr;       // its kernels, those of draws left out
  const ShadowMapRecipe* maps = nullptr;        // of a technique of maps
  std::unique_ptr<ShadowTechnique> (*make)(const ShadowContext& context) = nullptr;
  // Why a scene does not suit it; null = it asks for lights alone.
  std::string (*refusal)(const PackedScene& scene) = nullptr;
  void (*check)(const RenderPlan& settings) = nullptr; // throws UsageError where settings do not go with it
};

} // namespace wavepath
