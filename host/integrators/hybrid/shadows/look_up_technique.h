// Base of shadow techniques that answer rays from buffers of their own: kernels, buffers, bindings.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "host/gpu/raster.h"
#include "host/integrators/hybrid/shadows/technique.h"
#include "host/render/workspace/resources.h"
#include "kernels/hybrid/shadows/shadow_types.h"

namespace wavepath {

// Numbers and kinds of their bindings, without buffers: those of paths, of the technique's buffers, and of the frame.
std::vector<Binding> look_up_layout(std::span<const BufferRule> rules);

class LookUpTechnique : public ShadowTechnique {
public:
  // `rules` must outlive the technique; the first one is that of kBindShadowFrame.
  LookUpTechnique(const ShadowContext& context, std::span<const BufferRule> rules);

  bool is_ready() override { return kernels_.ready(need_); }
  double get_ready() override { return kernels_.best(need_).seconds(); }
  // Uses stage 0 of the program.
  void record_look_up(Commands& commands, std::size_t band, const gpu::Wave& wave) override;
  std::uint64_t bytes() const override { return buffers_.bytes() + (target_ ? target_->bytes() : 0); }

protected:
  void start_kernels(const View& view, const RenderPlan& settings);
  void upload_frame(const gpu::ShadowFrame& frame);
  // For each light: its source, and 1; kNone and 0 if it is not covered.
  std::vector<glm::uvec2> sources_of_lights() const;
  // Makes the binding sets. `shared`: argument of change().
  void bind(const std::vector<Binding>& shared);
  // Makes the set for draws, and for kernels in their place, which know no paths. Pipelines of the old set must be
  // gone. `frame`: bindings that include those of the frame, if draws use these.
  void bind_draws(const std::vector<Binding>& frame);

  const ShadowKind& kind_;
  Workspace& workspace_;
  KernelCompiler& kernels_;
  std::vector<ShadowSource> sources_; // sources that it covers
  KernelNeed need_;
  BufferSet buffers_;
  std::unique_ptr<RasterTarget> target_;          // null if it draws nothing
  std::vector<std::unique_ptr<BindingSet>> sets_; // one for each band
  std::unique_ptr<BindingSet> raster_set_;
};

} // namespace wavepath
