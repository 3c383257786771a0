#include "host/bench/ceilings.h"

#include <algorithm>
#include <array>

#include "host/base/clock.h"
#include "host/gpu/commands.h"
#include "kernels/bench/ceiling_fma.spv.h"
#include "kernels/bench/ceiling_load.spv.h"

namespace wavepath {
namespace {

constexpr std::uint32_t kGroupSize = 64; // of the ceiling kernels
constexpr int kRuns = 5;
constexpr double kShortRun = 0.02; // seconds: long enough to time, far from any watchdog

struct Parameters {
  std::uint32_t block_count, step_count;
};

double run(Device& device, const Kernel& kernel, const BindingSet& bindings, std::uint32_t groups,
           Parameters parameters) {
  Commands commands(device, 1);
  commands.bind(bindings);
  commands.dispatch(kernel, groups, &parameters);
  const Clock::time_point start = Clock::now();
  commands.submit_and_wait();
  const double wall = seconds_since(start);
  const double timed = commands.times().empty() ? 0.0 : commands.times().front().seconds;
  return timed > 0.0 ? timed : wall;
}

// Steps a second over all lanes: the number of steps is doubled until it can be timed well, then the fastest of
// a few measurements counts.
double steps_per_second(Device& device, const Kernel& kernel, const BindingSet& bindings, std::uint32_t groups,
                        std::uint32_t block_count) {
  constexpr std::uint32_t kMostSteps = 32768; // Mesa 22.3 ends loops at 65,535 trips
  Parameters parameters{block_count, 16};
  run(device, kernel, bindings, groups, parameters); // compiles
  double best = run(device, kernel, bindings, groups, parameters);
  while (best < kShortRun && parameters.step_count < kMostSteps) {
    parameters.step_count *= 2;
    best = run(device, kernel, bindings, groups, parameters);
  }
  for (int i = 1; i < kRuns; ++i) best = std::min(best, run(device, kernel, bindings, groups, parameters));
  return static_cast<double>(groups) * kGroupSize * parameters.step_count / best;
}

} // namespace

double roofline_fraction(const Ceilings& ceilings, double loads_per_second, double flops_per_second) {
  return std::max(loads_per_second / ceilings.load64_per_second, flops_per_second / (ceilings.gflops * 1e9));
}

Ceilings measure_ceilings(Device& device, std::uint64_t working_set) {
  const std::uint64_t bytes = std::clamp<std::uint64_t>(
      working_set / 64 * 64, 4096,
      std::min(device.info().max_texel_elements * 16, device.info().max_allocation) / 64 * 64);
  const std::uint32_t groups = device.info().type == "cpu" ? 256 : 16384;
  Buffer memory(device, bytes), sums(device, std::uint64_t{groups} * kGroupSize * sizeof(std::uint32_t));
  memory.fill_zero();
  const std::array<Binding, 2> all = {Binding{0, BindingKind::texels_rgba32ui, &memory},
                                      Binding{1, BindingKind::storage, &sums}};
  const BindingSet bindings(device, all, sizeof(Parameters));
  const auto loads = [&](std::uint32_t texels) {
    const std::array<std::uint32_t, 1> constants = {texels};
    const Kernel kernel(device, "ceiling_load", wavepath_ceiling_load_spv, bindings, constants);
    return steps_per_second(device, kernel, bindings, groups, static_cast<std::uint32_t>(bytes / (16 * texels)));
  };
  const Kernel fma(device, "ceiling_fma", wavepath_ceiling_fma_spv, bindings, {});
  constexpr double kFlopsPerStep = 8 * 4 * 2;
  return {loads(1), loads(4), steps_per_second(device, fma, bindings, groups, 0) * kFlopsPerStep * 1e-9};
}

} // namespace wavepath
