// Local illumination of hybrid frames: what is known of a model before there is a device, and one at work, which shades
// first hits in the place of the path tracer's kernel.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "host/integrators/path/paths.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/render/workspace/workspace.h"
#include "kernels/hybrid/shading/shading_types.h"

namespace wavepath {

// Each model defines one constant of this type in its own file.
struct ShadingKind {
  std::string_view name; // value of --shading
  std::string_view summary;
  std::span<const std::string_view> settings{};        // settings that it supports
  const KernelProgram* program = nullptr;              // its only stage shades; the layout is local_layout()
  void (*check)(const RenderPlan& settings) = nullptr; // throws UsageError where settings do not go with it
};

// Path tracing needs no more of its stages from such a first hit on.
inline constexpr std::uint32_t kLocalPathStages = stage_bits({kAdvance, kConnect});

// Numbers and kinds of the bindings of such a kernel, without buffers.
std::vector<Binding> local_layout();

class LocalShading {
public:
  LocalShading(Workspace& workspace, KernelCompiler& kernels, const ShadingKind& kind);

  // Takes up settings: begins compiling. `config`: of the path tracer's kernels. `paths`: bindings of the paths'
  // buffers, which outlive this. Nothing is in flight.
  void change(const RenderPlan& settings, const KernelConfig& config, const std::vector<Binding>& paths);
  bool is_ready() { return kernels_.ready(need_); }
  double get_ready() { return kernels_.best(need_).seconds(); }

  // Records the shading of the wave's first hits, as kShade leaves them: light seen, and the queue of shadow rays.
  void record(Commands& commands, std::size_t band, const gpu::Wave& wave);

  std::uint64_t bytes() const { return frame_buffer_.bytes(); }

private:
  Workspace& workspace_;
  KernelCompiler& kernels_;
  const ShadingKind& kind_;
  KernelNeed need_;
  Buffer frame_buffer_;
  std::vector<std::unique_ptr<BindingSet>> sets_; // one for each band
};

} // namespace wavepath
