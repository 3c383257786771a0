// Replays one path of a picture with the shipped kernels, and records it stage by stage.
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

// One bounce: the ray, its hit, the light gained there, and the next direction.
struct PathVertex {
  gpu::Ray ray;
  gpu::Hit hit;                     // triangle kNone = the ray left the scene
  gpu::PathState scattered;         // after `shade`: throughput and pdf of the next ray, and emission gathered so far
  std::optional<float> pdf;         // of the next ray; empty for a delta lobe
  std::vector<ShadowTrace> shadows; // of those light samples that needed one
  glm::vec3 radiance;               // gathered so far, including the light of these shadow rays
};

enum class PathEnd { escaped, unlit, depth, absorbed, roulette, nonfinite };

struct PathTrace {
  glm::uvec2 pixel{};
  std::uint32_t sample = 0;
  std::vector<PathVertex> vertices;
  PathEnd end = PathEnd::depth;
  glm::vec3 radiance{};               // of the whole sample
  std::optional<std::uint32_t> maker; // kernel that made it not finite (kMaker...); empty = finite
};

class PathReplay {
public:
  PathReplay(Device& device, const PackedScene& scene, const View& view, const RenderPlan& settings,
             KernelCompiler& kernels);

  // Traces the path. It has the same bits as in a render with the same settings, if Training::found holds the
  // probabilities that the render learned. `replicate`: 1 is the second one of a probed pixel. Throws Error if the
  // pixel has none.
  PathTrace trace(glm::uvec2 pixel, std::uint32_t sample, std::uint32_t replicate = 0);

private:
  std::uint32_t entry_of(glm::uvec2 pixel, std::uint32_t replicate) const;
  void run(PathStage stage, std::uint32_t bounce);
  void shade(std::uint32_t bounce);
  gpu::Queues queues() const;
  gpu::PathState state() const;
  ShadowTrace connect(std::uint32_t bounce, std::uint32_t light_sample, const gpu::PathState& state);
  PathEnd reason(std::uint32_t bounce, const PathVertex& vertex, gpu::PathState arrived);

  Workspace workspace_; // workspace of one path
  Paths paths_;
  LightTrainer trainer_;
  gpu::Wave wave_{};
};

} // namespace wavepath
