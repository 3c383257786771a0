// What each feature that this scene leaves out would cost it.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "host/render/kernel_compiler.h"
#include "host/integrators/path/path_tracer.h"

namespace wavepath {

struct AblationRow {
  std::string left_out;
  double cost_ms = 0.0; // of a frame of `base_ms`, median over turns
  double base_ms = 0.0;
  std::int64_t cost_bytes = 0; // device memory, buffers of the path state and data of the scene
  double cost_compile_ms = 0.0;
};

// Frames of `base` against kernels with one more feature, in turns; last, against generic kernels with all of them.
std::vector<AblationRow> ablate(Device& device, const PackedScene& scene, const View& view,
                                const RenderSettings& settings, PathTracer& base, double base_compile_seconds,
                                std::uint32_t spp, std::uint32_t repetitions,
                                const std::function<void(const std::string&)>& progress);

// A path tracer whose kernels are compiled, and the seconds that this took.
struct WarmTracer {
  std::unique_ptr<KernelCompiler> kernels;
  std::unique_ptr<PathTracer> tracer;
  double compile_seconds = 0.0;
};
WarmTracer make_tracer(Device& device, const PackedScene& scene, const View& view, const RenderSettings& settings);

} // namespace wavepath
