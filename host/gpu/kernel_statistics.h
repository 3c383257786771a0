// Statistics that a driver gives of a kernel that it has compiled: registers, spills, occupancy, size of the code,
// estimates of time; which of them, and under which names, is the driver's own (VK_KHR_pipeline_executable_properties).
#pragma once

#include <string>
#include <vector>

#include "host/gpu/kernel.h"

namespace wavepath {

struct KernelStatistic {
  std::string name;
  double value = 0.0; // a whole number up to 2^53, or a fraction; 0 or 1 of what is true or false
};

// The device was opened for DeviceUse::compile. First the width of subgroups. If the driver has made several
// executables of one kernel, the names begin with theirs.
std::vector<KernelStatistic> kernel_statistics(Device& device, const Kernel& kernel);

} // namespace wavepath
