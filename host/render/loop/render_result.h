// Result of a render: the picture, its error, and what both cost.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "host/film/error.h"
#include "host/picture/picture.h"
#include "host/render/settings/render_plan.h"
#include "host/render/workspace/totals.h"

namespace wavepath {

struct MemoryUse { // bytes on the device
  std::uint64_t scene = 0, bvh = 0, paths = 0, film = 0;
  std::uint64_t total() const { return scene + bvh + paths + film; }
};

// Cost of the pilot that learned the choice of lights, and the cells of space that it learned of.
struct LightTraining {
  std::uint64_t paths = 0;
  double seconds = 0.0;
  std::uint32_t cells = 0, sky_cells = 0; // of lights, of parts of an environment map
  LightProbabilities probabilities;       // null: no training
};

enum class StopReason { samples, time, target_error, interrupted, device_lost };

// Report of the pilot that measured where there is noise (--adaptive).
struct NoisePilot {
  std::uint32_t samples = 0, width = 0, height = 0; // of its picture
  double cost = 1.0;                                // predicted squared error times time, over even samples
  bool used = false;                                // samples were distributed by it
};

// Report of the pilot that learned where light comes from (--guide).
struct GuideReport {
  bool used = false;        // it promised a gain
  double variance = 1.0;    // of a sample, guided over unguided, as training predicts it
  double probability = 0.0; // of guiding at a vertex, on average
  std::uint32_t leaves = 0; // parts of space, each with a density over the sphere
  std::uint64_t bytes = 0;  // of the field
  std::uint64_t training_paths = 0;
};

// Photons that camera paths ended near (--techniques merge).
struct MergeReport {
  double first_radius = 0.0, last_radius = 0.0; // metres, of the first and the last samples
  std::uint32_t photon_paths = 0;               // for each map of a replicate
  std::uint32_t block = 0;                      // samples that share a map
  std::uint64_t bytes = 0;                      // of a map
};

// Milliseconds a frame on the device: median, least and most.
struct FrameCost {
  double median = 0.0, least = 0.0, most = 0.0;
};
using ShadowCost = FrameCost;

// Shadow rays that a technique could have answered: those that it did answer, and those that it left to be traced.
struct RayAnswers {
  std::uint64_t answered = 0, traced = 0;
};

// Report of a shadow technique: what it made, and its cost (--shadows).
struct ShadowReport {
  std::string covered, traced; // lights: those that it answers for, and those whose rays are traced
  ShadowCost build, look_up;
  std::uint32_t views = 0; // directions from lights that it keeps something of
  std::uint32_t size = 0;  // texels along a side of each, where they have any: --shadow-size, or what fits
  std::string smaller;     // says so where that is less
  std::uint64_t bytes = 0;
  std::optional<RayAnswers> answers;           // since change(), of a technique that traces some rays by choice
  float nearest = 0.0f, farthest = 0.0f;       // depths that the last frame showed, where views are fitted to it
  std::uint32_t pages = 0, resident_pages = 0; // of virtual maps; in the last frame
  std::uint32_t longest_list = 0;              // of shadow rays in a cell, of an irregular z-buffer
};

// Cost of occlusion in screen space (--occlusion).
struct OcclusionReport {
  double radius = 0.0; // metres
  FrameCost cost;
};

// The filter of the finished picture (--denoise).
struct DenoiseReport {
  const char* filter = "";
  double seconds = 0.0;
  double light = 1.0; // of the filtered picture, over that of the one before
};

struct RenderResult {
  Picture picture;
  std::shared_ptr<const Film> film; // the exact sums that it was developed from
  std::uint32_t spp = 0;            // samples a pixel that the picture holds
  StopReason stop = StopReason::samples;
  double compile_seconds = 0.0; // of the kernels it began with; loading may have gone on meanwhile
  double upload_seconds = 0.0;
  double seconds = 0.0, gpu_seconds = 0.0; // rendering alone
  double first_pixel_seconds = 0.0;        // from the start of the process until every pixel had its first sample
  RayCounts rays;
  ErrorEstimate error;
  double slope = -0.5;           // of log error against log time, fitted over the last checkpoints
  double estimate_seconds = 0.0; // that reading the film back and estimating its error took, besides `seconds`
  bool by_query = false;         // rays were traced by the device's ray queries
  bool even = true; // every pixel holds exactly its samples up to spp; false where the render was stopped within a pass
  std::vector<Checkpoint> checkpoints;
  std::vector<StageTime> stages;
  MemoryUse memory;
  Nonfinite nonfinite;
  LightTraining light_training;
  std::optional<NoisePilot> noise;
  glm::vec3 ambient{0.0f}; // radiance that a hybrid render used
  std::optional<GuideReport> guide;
  std::optional<MergeReport> merging;
  std::optional<ShadowReport> shadows;
  std::optional<OcclusionReport> occlusion;
  std::optional<FrameCost> antialias; // of a filter of frames (--antialias)
  std::optional<DenoiseReport> denoised;
};

} // namespace wavepath
