// Reflections whose mirrored rays are shaded as the frame's own first hits, by the same kernels.
#pragma once

#include "host/integrators/hybrid/reflections/reflections.h"

namespace wavepath {

// The first stages of such a technique's program.
enum RayStage : std::size_t { kReflect, kMeet, kAnswer, kRayStageCount };
extern const KernelProgram kRayProgram; // these alone

class RayReflections : public Reflections {
public:
  explicit RayReflections(const ReflectionContext& context) : Reflections(context) {}
  void record(Commands& commands, std::size_t band, const gpu::Wave& wave) override;
  ReflectionReport report() const override;

protected:
  // Records what finds the hits of the rays in the queue. A barrier comes before, and one after.
  virtual void find(Commands& commands, std::size_t band, const gpu::Wave& wave);
  virtual std::uint32_t mirrors() const { return gpu::kMirrorsDraw; }
};

} // namespace wavepath
