#include "host/integrators/path/kind.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/integrators/path/path_tracer.h"
#include "host/render/render.h"

namespace wavepath {
namespace {

constexpr std::array<std::string_view, 4> kSettings = {"hemisphere", "direct", "adaptive", "pixel"};
constexpr std::array<std::string_view, 2> kFirstHitStages = {"generate", "extend"};

void start_kernels(KernelCompiler& kernels, const DeviceInfo& device, std::uint32_t features,
                   const RenderSettings& settings) {
  const auto start = [&](std::uint32_t bits) {
    kernels.start({&kPathProgram, kAllPathStages, kernel_config(bits, kExpectedStack, settings)});
  };
  start(features);
  if (generic_first(device)) start(gpu::kFeaturesAll);
}

std::vector<std::string> bias(const RenderSettings& settings, const RenderResult&) {
  return {fmt::format("light paths end after {} bounces (--max-depth)", settings.max_depth)};
}

} // namespace

constinit const IntegratorKind kPath = {
    .name = "path",
    .summary = "path tracing",
    .settings = kSettings,
    .measures_depth_cut = true,
    .first_hit_stages = kFirstHitStages,
    .features = film_features,
    .start_kernels = start_kernels,
    .bytes_per_slot = [](std::uint32_t features,
                         const RenderSettings&) { return bytes_per_path(features, kRoomForShadowRays); },
    .largest_record =
        [](const RenderSettings&) { return std::uint64_t{std::max(2 * sizeof(gpu::Ray), sizeof(gpu::PathAovs))}; },
    .slots_per_pixel = [](const RenderSettings&) { return 1u; },
    .bytes_per_pixel = [](const RenderSettings&) { return std::uint64_t{0}; },
    .is_biased = [](const RenderSettings&) { return false; },
    .bias = bias,
    .omitted = [](const RenderSettings&) { return std::vector<OmittedStage>(); },
    .stats = [](const RenderSettings&, const PackedScene&, const RenderResult&) { return nlohmann::ordered_json(); },
    .make = [](Workspace& workspace, KernelCompiler& kernels) -> std::unique_ptr<Integrator> {
      return std::make_unique<PathTracer>(workspace, kernels);
    },
};

} // namespace wavepath
