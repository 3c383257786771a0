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

// Kernels that share one binding layout. Each integrator defines one constant in its folder.
struct KernelProgram {
  std::span<const KernelCode> stages;
  std::span<const std::size_t> compile_order; // indices of all stages, the slowest to compile first
  std::vector<Binding> (*layout)();           // numbers and kinds of the bindings, without buffers
};

inline constexpr std::array<std::size_t, 1> kOnlyStage = {0}; // compile order of a program of one

// Configuration that kernels are specialized for. Compiling in more than a scene needs changes no bit of the picture.
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
  std::uint32_t light_samples = 1; // of a path where it first scatters
  std::uint32_t sky = gpu::kSkyByPaths;
  std::uint32_t reuse = gpu::kReuseNone;
  std::uint32_t clamp = 0; // bits of a float

  bool operator==(const KernelConfig&) const = default;
};

// Description of a set of kernels: the stages of a program, and their configuration.
struct KernelNeed {
  const KernelProgram* program = nullptr;
  std::uint32_t stages = 0; // bit s: stage s of the program
  KernelConfig config;

  bool operator==(const KernelNeed&) const = default;
  // True if a set made for this need also renders what `need` asks for.
  bool covers(const KernelNeed& need) const;
};

// The need of all kernels of a program.
KernelNeed whole_need(const KernelProgram& program, const KernelConfig& config);

// Specialization constants, indexed by kSpec..., for a configuration and a device.
std::array<std::uint32_t, gpu::kSpecCount> specialization(const KernelConfig& config, const DeviceInfo& device);

class KernelSet {
public:
  // Compiles the kernels in parallel. Then dispatches each without work, since some drivers compile only then; not if
  // the device was opened for DeviceUse::compile. Safe to call from several threads.
  KernelSet(Device& device, const KernelNeed& need);

  // The kernel of a stage, which must be in need().stages.
  const Kernel& operator[](std::size_t stage) const { return *kernels_[stage]; }
  const KernelNeed& need() const { return need_; }
  const KernelConfig& config() const { return need_.config; }
  double seconds() const { return seconds_; } // of compiling

private:
  KernelNeed need_;
  std::vector<std::optional<Kernel>> kernels_; // by stage
  double seconds_ = 0.0;
};

} // namespace wavepath
