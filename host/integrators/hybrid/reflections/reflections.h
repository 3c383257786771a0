// Base of all techniques of reflections: settings and totals on the device, kernels and their bindings.
#pragma once

#include <memory>
#include <vector>

#include "host/integrators/hybrid/raster/slices.h"
#include "host/integrators/hybrid/reflections/technique.h"
#include "kernels/hybrid/reflections/reflection_types.h"

namespace wavepath {

// Numbers and kinds of the bindings of every kernel of reflections, without buffers.
std::vector<Binding> reflection_layout();

class Reflections : public ReflectionTechnique {
public:
  void change(const View& view, const RenderPlan& settings, const KernelConfig& config,
              const std::vector<Binding>& shared) override;
  bool is_ready() override { return context_.kernels.ready(need_); }
  double get_ready() override { return context_.kernels.best(need_).seconds(); }
  std::uint64_t bytes() const override { return frame_buffer_.bytes() + counts_.bytes(); }
  ReflectionReport report() const override;

protected:
  explicit Reflections(const ReflectionContext& context);

  // Bindings of its own, behind the shared ones. Called by change(), which then sends frame_.
  virtual void add_bindings(std::vector<Binding>& bindings) { static_cast<void>(bindings); }
  // Submits a kernel over all pixels of the frame, in slices of that length, which it adapts.
  void submit_pixels(WaveQueue& queue, std::size_t kernel, const char* stage, SliceLength& length);
  const KernelSet& kernels() { return context_.kernels.best(need_); }
  const BindingSet& bindings(std::size_t band) const { return *sets_[band]; }
  const Buffer& frame_buffer() const { return frame_buffer_; } // gpu::ReflectionFrame

  const ReflectionContext context_;
  gpu::ReflectionFrame frame_{};
  bool nests_ = false; // mirrors show mirrors; change() compiles what that needs

private:
  KernelNeed need_;
  Buffer frame_buffer_, counts_;
  std::vector<std::unique_ptr<BindingSet>> sets_; // one for each band
};

} // namespace wavepath
