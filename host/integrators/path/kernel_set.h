// The kernels of the path tracer, compiled for one configuration.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "host/gpu/kernel.h"
#include "kernels/features.h"

namespace wavepath {

enum Stage : std::size_t { kGenerate, kAdvance, kExtend, kShade, kConnect, kAccumulate, kStageCount };

const char* stage_name(Stage stage);

// What kernels are specialized for. Whatever they are compiled for beyond what a scene needs, the image has the same
// bits.
struct KernelConfig {
  std::uint32_t features = 0;   // kFeature bits
  std::uint32_t stack_size = 0; // entries of the traversal stack
  std::uint32_t sampler = 0, direct = 0, hemisphere = 0, filter = 0;

  bool operator==(const KernelConfig&) const = default;
  // Whether kernels for this configuration render what `need` asks for.
  bool covers(const KernelConfig& need) const;
};

// The specialization constants that make a kernel fit a configuration and a device, by kSpec...
std::array<std::uint32_t, gpu::kSpecCount> specialization(const KernelConfig& config, const DeviceInfo& device);

class KernelSet {
public:
  // Compiles the kernels, side by side, and has each run once without work, for the drivers that compile only then.
  // `bindings`: slots and kinds of what the kernels will be bound to; their buffers are not used. Safe to call from
  // several threads at once.
  KernelSet(Device& device, const KernelConfig& config, std::vector<Binding> bindings);

  // The kernel of a stage that the configuration needs.
  const Kernel& operator[](Stage stage) const { return *kernels_[stage]; }
  const KernelConfig& config() const { return config_; }
  double seconds() const { return seconds_; } // that compiling took

private:
  KernelConfig config_;
  std::array<std::optional<Kernel>, kStageCount> kernels_;
  double seconds_ = 0.0;
};

} // namespace wavepath
