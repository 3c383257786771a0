// Reflections whose mirrored rays are shaded as the frame's own first hits, by the same kernels.
#pragma once

#include "host/integrators/hybrid/reflections/reflections.h"

namespace wavepath {

// The first stages of such a technique's program.
enum RayStage : std::size_t { kReflect, kMeet, kAnswer, kNested, kNestedQueue, kRayStageCount };
inline constexpr std::uint32_t kNestedRayStages = 1u << kNested | 1u << kNestedQueue;
extern const KernelProgram kRayProgram; // these alone

// Numbers and kinds of the bindings of its kernels, without buffers.
std::vector<Binding> ray_layout();

class RayReflections : public Reflections {
public:
  explicit RayReflections(const ReflectionContext& context) : Reflections(context) {}
  void change(const View& view, const RenderPlan& settings, const KernelConfig& config,
              const std::vector<Binding>& shared) override;
  void record(Commands& commands, std::size_t band, const gpu::Wave& wave) override;
  std::uint64_t bytes() const override { return Reflections::bytes() + nested_rays_.bytes(); }
  ReflectionReport report() const override;

protected:
  // Records what finds the hits of the rays in the queue. `depth`: mirrors before those that sent the rays. A barrier
  // comes before, and one after.
  virtual void find(Commands& commands, std::size_t band, const gpu::Wave& wave, std::uint32_t depth);
  virtual std::uint32_t mirrors() const { return gpu::kMirrorsDraw; }
  // True if mirrors may show mirrors in this view, for settings that let them.
  virtual bool sees_nested(const RenderPlan& settings);
  void add_bindings(std::vector<Binding>& bindings) override;

private:
  // Records the light of what the rays in the queue met.
  void light_hits(Commands& commands, std::size_t band, const gpu::Wave& wave);

  Buffer nested_rays_;      // kBindNestedRays
  double threshold_ = -1.0; // that faces_ was found for
  bool faces_ = false;      // mirrors of the scene do not lie in one plane
};

} // namespace wavepath
