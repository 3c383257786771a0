// Techniques of reflections: the description of one, which needs no device, and one at work, which finds what the
// mirrors of a hybrid frame show of lit surfaces. Lamps and the environment are not its business: direct light has what
// mirrors show of them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "host/integrators/path/paths.h"
#include "host/render/loop/render_result.h"
#include "host/render/workspace/wave_queue.h"
#include "host/scene/staging/view.h"

namespace wavepath {

class ReflectionTechnique {
public:
  virtual ~ReflectionTechnique() = default;

  // Adopts view and settings: begins compiling and reserves memory. `config`: of the path tracer's kernels. `shared`:
  // bindings of the buffers of paths and frame, which outlive the technique: those of Paths, kBindHybrid,
  // kBindVisibility, kBindGbuffer, kBindSignals, kBindReflections. Nothing may be in flight. Throws Error if the device
  // cannot hold it.
  virtual void change(const View& view, const RenderPlan& settings, const KernelConfig& config,
                      const std::vector<Binding>& shared) = 0;
  virtual bool is_ready() = 0;
  virtual double get_ready() = 0; // returns the seconds of compiling

  // A frame: build() submits what comes before its waves, behind its visibility; record() records into each wave,
  // behind its direct light; finish() submits what comes behind its last wave. Then kBindReflections holds the light.
  virtual void build(WaveQueue&) {}
  virtual void record(Commands&, std::size_t band, const gpu::Wave&) { static_cast<void>(band); }
  virtual void finish(WaveQueue&) {}

  virtual std::uint64_t bytes() const = 0;
  virtual ReflectionReport report() const = 0; // since change(); nothing may be in flight
};

struct ReflectionKind;
class SurfaceVoxels; // host/integrators/hybrid/voxels/surface_voxels.h

// Arguments for making a technique. They outlive it.
struct ReflectionContext {
  const ReflectionKind& kind;
  Workspace& workspace;
  KernelCompiler& kernels;
  Paths& paths;
  // Records direct light of the first hits that the queue of a wave holds, as the frame's own surfaces get it.
  std::function<void(Commands&, std::size_t band, const gpu::Wave&)> light;
  // The wave of these entries of the film in the frame that begins.
  std::function<gpu::Wave(std::uint32_t first_entry, std::uint32_t count)> wave;
  const SurfaceVoxels* voxels = nullptr; // null unless the kind asks for them
};

// Each technique defines one constant of this type in its own file.
struct ReflectionKind {
  std::string_view name; // value of --reflections
  std::string_view summary;
  std::span<const std::string_view> settings{};        // settings that it supports besides reflection-threshold
  const KernelProgram* program = nullptr;              // its kernels, without the shaders of draws
  std::uint32_t nested_stages = 0;                     // bits of those of `program` that only mirrors in mirrors need
  std::uint32_t depth = 1;                             // mirrors behind each other that it shows at most
  bool traces = false;                                 // by the path tracer's kernel `extend`
  bool searches_picture = false;                       // for what mirrors show
  bool voxels = false;                                 // looks for what is met in surface voxels
  std::uint32_t bytes_per_pixel = 0;                   // of device memory, besides kBindReflections
  void (*check)(const RenderPlan& settings) = nullptr; // throws UsageError where settings do not go with it
  std::unique_ptr<ReflectionTechnique> (*make)(const ReflectionContext& context) = nullptr;
};

// Mirrors behind each other that a technique shows with these settings. A path over d mirrors has d + 1 bounces.
inline std::uint32_t reflection_depth(const ReflectionKind& kind, const RenderPlan& settings) {
  return std::min(kind.depth, settings.max_depth - 1);
}

// The need of its kernels. `nests`: mirrors show mirrors.
inline KernelNeed reflection_need(const ReflectionKind& kind, const KernelConfig& config, bool nests) {
  KernelNeed need = whole_need(*kind.program, config);
  if (!nests) need.stages &= ~kind.nested_stages;
  return need;
}

} // namespace wavepath
