// One picture by several devices. Each renders ranges of its samples; their exact sums are joined.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "host/render/loop/hooks.h"
#include "host/render/loop/render_result.h"
#include "host/render/settings/render_plan.h"

namespace wavepath {

class Device;
class KernelCompiler; // host/render/workspace/kernel_compiler.h
struct PackedScene;
struct View;

struct SampleRange { // first <= s < end
  std::uint32_t first = 0, end = 0;
};

struct RenderingDevice {
  Device* device = nullptr;
  KernelCompiler* kernels = nullptr;
};

// What one device did.
struct DeviceWork {
  std::string name, driver;
  std::vector<SampleRange> ranges; // of the samples that it has rendered, in ascending order
  double seconds = 0.0;            // rendering
  std::uint64_t rays = 0;
  bool lost = false; // on its way; what it had not finished went to the others

  std::uint32_t samples() const; // of every pixel
};

struct MultiDeviceResult {
  RenderResult result;
  std::vector<DeviceWork> device_work; // in the order of the devices
  // A pilot has the same bits on all devices: then so has the picture, however its samples are dealt. Else its rounding
  // depends on that.
  bool bits_agree = true;
};

// Renders as render() does, with kernels and a thread for each device. Samples are dealt in rounds, each three times as
// large as all before, in proportion to the speeds that were measured; seconds are those of the clock. Targets are
// looked at between rounds. `hooks`: progress and checkpoint. The settings are neither adaptive nor those of resumed
// renders. Throws Error as render() does, and DeviceLost once no device is left.
MultiDeviceResult render_by_several(std::span<const RenderingDevice> devices, const PackedScene& scene,
                                    const View& view, const RenderPlan& settings, const RenderHooks& hooks);

} // namespace wavepath
