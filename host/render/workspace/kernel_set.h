// Kernels that are compiled together, for one configuration.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "host/gpu/kernel.h"
#include "host/render/settings/render_plan.h"
#include "kernels/base/features.h"

namespace wavepath {

// Kernels that are bound to one layout. One constant for each integrator, in its folder.
struct KernelProgram {
  std::span<const KernelCode> stages;
  std::span<const std::size_t> compile_order; // of all stages, the slowest first
  std::vector<Binding> (*layout)();           // numbers and kinds of their bindings; no buffers
};

inline constexpr std::array<std::size_t, 1> kOnlyStage = {0}; // compile order of a program of one

// What kernels are specialized for. Whatever they are compiled for beyond what a scene needs, the picture has the same
// bits.
struct KernelConfig {
  gpu::Feature features = 0;    // kFeature bits
  std::uint32_t stack_size = 0; // entries of the traversal stack
  std::uint32_t sampler = 0, direct = 0, hemisphere = 0, filter = 0;
  std::uint32_t probing = gpu::kProbingOff;
  std::uint32_t lens = gpu::kLensPinhole, cull = gpu::kCullCamera;
  std::uint32_t motion = 0;
  std::uint32_t terminator = gpu::kTerminatorFacets;
  std::uint32_t traversal = kTraversalCompute;
  std::uint32_t sort = gpu::kSortNone;
  std::uint32_t light_samples = 1; // where a path first scatters
  std::uint32_t sky = gpu::kSkyByPaths;
  std::uint32_t reuse = gpu::kReuseNone;

  bool operator==(const KernelConfig&) const = default;
};

// A set of kernels: which, and for what.
struct KernelNeed {
  const KernelProgram* program = nullptr;
  std::uint32_t stages = 0; // bit s: stage s of the program
  KernelConfig config;

  bool operator==(const KernelNeed&) const = default;
  // Whether a set made for this renders what `need` asks for.
  bool covers(const KernelNeed& need) const;
};

// All kernels of a program.
KernelNeed whole_need(const KernelProgram& program, const KernelConfig& config);

// The specialization constants that make a kernel fit a configuration and a device, by kSpec...
std::array<std::uint32_t, gpu::kSpecCount> specialization(const KernelConfig& config, const DeviceInfo& device);

class KernelSet {
public:
  // Compiles the kernels, side by side, and dispatches each once without work, for the drivers that compile only then
  // (unless the device was opened for DeviceUse::compile). Safe to call from several threads at once.
  KernelSet(Device& device, const KernelNeed& need);

  // The kernel of a stage that was asked for.
  const Kernel& operator[](std::size_t stage) const { return *kernels_[stage]; }
  const KernelNeed& need() const { return need_; }
  const KernelConfig& config() const { return need_.config; }
  double seconds() const { return seconds_; } // that compiling took

private:
  KernelNeed need_;
  std::vector<std::optional<Kernel>> kernels_; // by stage
  double seconds_ = 0.0;
};

} // namespace wavepath
