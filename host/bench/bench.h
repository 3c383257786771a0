// `wavepath bench`: the kernels of this scene one by one, each compared with the limits of the device and with Embree.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/bench/ablation.h"
#include "host/bench/ceilings.h"
#include "host/bench/query_comparison.h"
#include "host/bench/structures/row.h"
#include "host/bench/summary.h"
#include "host/render/render.h"
#include "host/scene/pack/pack.h"

namespace wavepath {

struct BenchSettings {
  RenderPlan render;
  std::uint32_t repetitions = 7; // repetitions of every measurement; compared variants take turns
  bool ablate = false, structures = false;
};

struct EmbreeRatio {
  double ratio = 0.0, ratio_robust = 0.0; // our rays a second over Embree's, default and robust mode
  double agreement = 0.0;                 // fraction of the rays for which robust Embree finds the same
};

struct RayRate {
  const char* kind = "";
  std::uint64_t count = 0;
  double mrays_per_second = 0.0, spread = 0.0;
  double visits = 0.0, tests = 0.0, bytes = 0.0; // a ray, on average
  double lanes_in_use = 1.0;                     // see RayWork
  double roofline_fraction = 0.0;
  std::optional<EmbreeRatio> embree;
};

struct BenchStage {
  std::string name;
  double gpu_ms = 0.0; // of a render, median
  std::uint64_t dispatches = 0;
};

struct PathTracing {
  std::uint32_t spp = 0; // of a render
  Summary seconds;       // wall time of a render
  double mrays_per_second = 0.0;
  double traversal_fraction = 0.0; // fraction of the kernels' time that extend and connect take
  std::uint64_t bytes_per_path = 0;
};

struct BenchResult {
  Ceilings ceilings;
  std::array<RayRate, 3> rays; // camera, bounce, shadow
  std::vector<BenchStage> stages;
  PathTracing path_tracing;
  double compile_seconds = 0.0;
  std::optional<double> embree_build_seconds;
  std::optional<QueryComparison> queries; // if the device's ray queries trace rays
  std::vector<AblationRow> ablation;      // empty unless asked for
  // Only if asked for: of those rays, and of shadow rays to one lamp.
  std::vector<StructureRow> structures, lamp_structures;
};

// The rays are those of the first sample of every pixel, as many as are in flight at once; they are traced by our own
// traversal, whole renders as the settings say. Throws Error as render()
// does. `progress` is told what comes next.
BenchResult bench(Device& device, const PackedScene& scene, const View& view, const BenchSettings& settings,
                  const std::function<void(const std::string&)>& progress);

} // namespace wavepath
