// Renders one picture on several devices. Each renders ranges of its samples; their exact sums are joined.
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

// Work of one device.
struct DeviceWork {
  std::string name, driver;
  std::vector<SampleRange> ranges; // ranges of samples that it has rendered, ascending
  double seconds = 0.0;            // rendering
  std::uint64_t rays = 0;
  bool lost = false; // true if the device was lost; other devices rendered its unfinished samples

  std::uint32_t samples() const; // samples of every pixel
};

struct MultiDeviceResult {
  RenderResult result;
  std::vector<DeviceWork> device_work; // in the order of the devices
  // True if a pilot had the same bits on all devices. Then the picture does not depend on how samples were distributed;
  // otherwise its last bits do.
  bool bits_agree = true;
};

// Renders as render() does, with kernels and a thread for each device. Samples are distributed in rounds, each three
// times as large as all before together, in proportion to measured speeds; seconds are wall time. Targets are checked
// between rounds. `hooks`: only progress, show and checkpoint are used. The settings must not be adaptive. Throws Error
// as render() does, and DeviceLost once no device is left.
MultiDeviceResult render_by_several(std::span<const RenderingDevice> devices, const PackedScene& scene,
                                    const View& view, const RenderPlan& settings, const RenderHooks& hooks);

} // namespace wavepath
