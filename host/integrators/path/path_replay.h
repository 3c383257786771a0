// One path of a picture, traced alone with the shipped kernels and recorded stage by stage.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "host/integrators/path/light_trainer.h"
#include "host/integrators/path/paths.h"
#include "kernels/base/frame_types.h"
#include "kernels/path/path_types.h"

namespace wavepath {

struct ShadowTrace {
  gpu::ShadowRay ray;
  bool blocked = false;
};

// One bounce: where a ray led, what the path gained there, and how it went on.
struct PathVertex {
  gpu::Ray ray;
  gpu::Hit hit;                     // its triangle is kNone if the ray left the scene
  gpu::PathState scattered;         // after shade: throughput and pdf of the next ray, emission gathered up to here
  std::optional<float> pdf;         // of the next ray; a delta direction has none
  std::vector<ShadowTrace> shadows; // of its light samples that want one
  glm::vec3 radiance;               // gathered up to here, the light at the end of the shadow rays included
};

enum class PathEnd { escaped, unlit, depth, absorbed, roulette, nonfinite };

struct PathTrace {
  glm::uvec2 pixel{};
  std::uint32_t sample = 0;
  std::vector<PathVertex> vertices;
  PathEnd end = PathEnd::depth;
  glm::vec3 radiance{};               // of the sample
  std::optional<std::uint32_t> maker; // kMaker...: the kernel that made it not finite
};

class PathReplay {
public:
  PathReplay(Device& device, const PackedScene& scene, const View& view, const RenderPlan& settings,
             KernelCompiler& kernels);

  // The path has the bits that it has in a render with the same settings, if these have the fractions of lights that it
  // learned (Training::found).
  // `replicate`: 1 is the second one of a probed pixel; throws Error if the pixel has none.
  PathTrace trace(glm::uvec2 pixel, std::uint32_t sample, std::uint32_t replicate = 0);

private:
  std::uint32_t entry_of(glm::uvec2 pixel, std::uint32_t replicate) const;
  void run(PathStage stage, std::uint32_t bounce);
  void shade(std::uint32_t bounce);
  gpu::Queues queues() const;
  gpu::PathState state() const;
  ShadowTrace connect(std::uint32_t bounce, std::uint32_t light_sample, const gpu::PathState& state);
  PathEnd reason(std::uint32_t bounce, const PathVertex& vertex, gpu::PathState arrived);

  Workspace workspace_; // of one slot
  Paths paths_;
  LightTrainer trainer_;
  gpu::Wave wave_{};
};

// Of a hit that is not a miss, in the device's world.
glm::dvec3 hit_position(const PackedScene& scene, const gpu::Hit& hit);

} // namespace wavepath
