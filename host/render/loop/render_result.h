// Result of a render: the picture, its error, and the cost of both.
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

// Report of the pilot that trained light selection.
struct LightTraining {
  std::uint64_t paths = 0;
  double seconds = 0.0;
  std::uint32_t cells = 0, sky_cells = 0; // trained cells: of lights; of parts of the sky
  LightProbabilities probabilities;       // null: no training
};

enum class StopReason { samples, time, target_error, interrupted, device_lost };

// Report of the pilot that measured where there is noise (--adaptive).
struct NoisePilot {
  std::uint32_t samples = 0, width = 0, height = 0; // of the pilot's picture
  double cost = 1.0;                                // predicted squared error times time, relative to even samples
  bool used = false;                                // true if samples were distributed by it
};

// Report of the pilot that learned where light comes from (--guide).
struct GuideReport {
  bool used = false;        // true if paths were guided, since training predicted a gain
  double variance = 1.0;    // variance of a sample as training predicts it, guided over unguided
  double probability = 0.0; // average probability that a vertex is guided
  std::uint32_t leaves = 0; // parts of space, each with a density over the sphere
  std::uint64_t bytes = 0;  // size of the field
  std::uint64_t training_paths = 0;
};

// Photons that camera paths ended near (--techniques merge).
struct MergeReport {
  double first_radius = 0.0, last_radius = 0.0; // metres, of the first and the last samples
  std::uint32_t photon_paths = 0;               // light paths of each photon map of a replicate
  std::uint32_t block = 0;                      // samples that share a map
  std::uint64_t bytes = 0;                      // size of a map
};

// Milliseconds a frame on the device: median, least and most.
struct FrameCost {
  double median = 0.0, least = 0.0, most = 0.0;
};
using ShadowCost = FrameCost;

// Shadow rays that a technique could have answered: the number that it answered, and the number that were traced
// instead.
struct RayAnswers {
  std::uint64_t answered = 0, traced = 0;
};

// Report of a shadow technique: what it made, and its cost (--shadows).
struct ShadowReport {
  std::string covered, traced; // names of the lights that it answers for, and of those whose rays are traced
  ShadowCost build, look_up;
  std::uint32_t views = 0; // views from lights that it stores data of
  std::uint32_t size = 0;  // texels along a side of each view: --shadow-size or less; 0 if views have no texels
  std::string smaller;     // text that says so if it is less
  std::uint64_t bytes = 0;
  // Since change(), for a technique that traces some rays by choice; empty for others.
  std::optional<RayAnswers> answers;
  float nearest = 0.0f, farthest = 0.0f;       // range of depths of the last frame, if views are fitted to it
  std::uint32_t pages = 0, resident_pages = 0; // pages of virtual maps; pages resident in the last frame
  std::uint32_t longest_list = 0;              // most shadow rays in a cell of an irregular z-buffer
};

// Cost of occlusion in screen space (--occlusion).
struct OcclusionReport {
  double radius = 0.0; // metres
  FrameCost cost;
};

// Findings of a technique of reflections (--reflections), in samples of pixels that show a mirror.
struct ReflectionReport {
  std::uint64_t asked = 0;    // all of them
  std::uint64_t answered = 0; // those for which the technique knows what the mirror shows
};

// The filter of the finished picture (--denoise).
struct DenoiseReport {
  const char* filter = "";
  double seconds = 0.0;
  double light = 1.0; // total light of the filtered picture, relative to the unfiltered one
};

// The light of patches, which serves all views of a scene (--integrator radiosity).
struct RadiosityReport {
  std::uint32_t patches = 0, shots = 0, links = 0;
  std::uint64_t rays = 0; // of all shots or links, on a coarse mesh too
  double remaining = 0.0; // share of the power that was not followed; for that of shots an ambient term stands
  double absorbed = 0.0;  // share of the power that patches absorb, by the light that cameras see
  double lost = 0.0;      // share of the power that left the scene
  double seconds = 0.0;   // of solving
  bool kept = false;      // solved for an earlier picture
  std::uint64_t bytes = 0;
};

struct RenderResult {
  Picture picture;
  std::shared_ptr<const Film> film; // exact sums from which the picture was developed
  std::uint32_t spp = 0;            // samples a pixel in the picture
  StopReason stop = StopReason::samples;
  double compile_seconds = 0.0; // of the kernels that it began with, which may overlap with loading
  double upload_seconds = 0.0;
  double seconds = 0.0, gpu_seconds = 0.0; // of rendering alone
  double first_pixel_seconds = 0.0;        // from the start of the process until every pixel had a sample
  RayCounts rays;
  ErrorEstimate error;
  double slope = -0.5;           // d log(error) / d log(time), fitted to the last checkpoints
  double estimate_seconds = 0.0; // of reading the film back and estimating its error, besides `seconds`
  bool by_query = false;         // true if the device's ray queries traced the rays
  bool even = true; // true if every pixel has exactly its samples up to spp; false if stopped within a pass
  std::vector<Checkpoint> checkpoints;
  std::vector<StageTime> stages;
  MemoryUse memory;
  Nonfinite nonfinite;
  LightTraining light_training;
  std::optional<NoisePilot> noise;
  glm::vec3 ambient{0.0f}; // ambient radiance of a hybrid render
  std::optional<GuideReport> guide;
  std::optional<MergeReport> merging;
  std::optional<RadiosityReport> radiosity;
  std::optional<ShadowReport> shadows;
  std::optional<OcclusionReport> occlusion;
  std::optional<ReflectionReport> reflections;
  std::optional<FrameCost> antialias; // cost of a filter of frames (--antialias)
  std::optional<DenoiseReport> denoised;
};

} // namespace wavepath
