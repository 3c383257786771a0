// Chooses one of the machine's devices.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "host/gpu/device_info.h"

namespace wavepath {

// Index in `devices` of the device that `wanted` names: an index; else a part of its name, digits included, in any
// case. If `wanted` is empty: a discrete GPU, else an integrated one, a virtual one, a CPU. Throws Error if none
// matches, or if the device lacks something that the program needs; the message lists the devices.
std::size_t choose_device(const std::vector<DeviceInfo>& devices, const std::string& wanted);

// Advice for machines without a driver: to mend the variables that tell the Vulkan loader where drivers are, if any is
// set, or else to install one.
std::string driver_remedy();

} // namespace wavepath
