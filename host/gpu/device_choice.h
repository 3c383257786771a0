// Which of a machine's devices is meant.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "host/gpu/device_info.h"

namespace wavepath {

// Position in `devices` of the one that `wanted` means: an index; else part of a name (case-insensitive), numbers
// included; empty = a discrete GPU if there is one, then integrated, virtual, CPU. Throws Error if none fits, or if the
// one that fits lacks something, naming those that exist.
std::size_t choose_device(const std::vector<DeviceInfo>& devices, const std::string& wanted);

// Advice for machines without a driver: to mend the variables that tell the Vulkan loader where drivers are, if any is
// set, or else to install one.
std::string driver_remedy();

} // namespace wavepath
