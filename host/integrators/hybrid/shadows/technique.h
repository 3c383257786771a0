// Shadow techniques: the description of one, which needs no device, and one at work, which answers shadow rays of
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

  // Adopts view and settings: begins compiling and reserves memory. `shared`: bindings of the frame's own buffers,
  // which look_up() may read: paths, kBindHybrid, kBindVisibility; the buffers must outlive the technique. Nothing may
  // be in flight. Throws Error if the device cannot hold it.
  virtual void change(const View& view, const RenderPlan& settings, const std::vector<Binding>& shared) = 0;
  virtual bool is_ready() = 0;
  virtual double get_ready() = 0; // returns the seconds of compiling

  // Submits the work to be done before frame `sample`.
  virtual void build(WaveQueue& queue, std::uint32_t sample) = 0;
  // Records the answers to the shadow rays of the wave. A barrier comes before, and none after.
  virtual void record_look_up(Commands& commands, std::size_t band, const gpu::Wave& wave) = 0;

  virtual std::uint64_t bytes() const = 0;
  virtual std::uint32_t view_count() const = 0; // views from lights that it stores data of
  virtual void describe(ShadowReport&) const {} // adds results of this technique; nothing may be in flight
};

struct ShadowKind;
struct ShadowMapRecipe; // shadow_maps.h

// Arguments for making a technique.
struct ShadowContext {
  const ShadowKind& kind;
  Workspace& workspace;
  KernelCompiler& kernels;
  std::vector<ShadowSource> sources; // sources that it covers
};

// Description of a technique. Each technique defines one constant in its own file.
struct ShadowKind {
  std::string_view name; // value of --shadows
  std::string_view summary;
  unsigned sources = 0;                         // kinds of sources that it covers; bits
  std::span<const std::string_view> settings{}; // settings that it supports besides shadow-ambient
  const KernelProgram* program = nullptr;       // its kernels, without the shaders of draws
  const ShadowMapRecipe* maps = nullptr;        // for a technique of maps; null for others
  bool voxels = false;                          // change() gets the bindings of surface voxels
  std::unique_ptr<ShadowTechnique> (*make)(const ShadowContext& context) = nullptr;
  // Reason why it cannot be used in a scene; empty = it can. Null = it depends on the lights alone.
  std::string (*refusal)(const PackedScene& scene) = nullptr;
  void (*check)(const RenderPlan& settings) = nullptr; // throws UsageError if settings contradict it
};

} // namespace wavepath
