// The two classes of devices for which decisions have constants of their own.
#pragma once

#include "host/gpu/device_info.h"

namespace wavepath {

enum class DeviceClass { cpu, gpu };

inline DeviceClass class_of(const DeviceInfo& info) { return info.type == "cpu" ? DeviceClass::cpu : DeviceClass::gpu; }
constexpr bool is_cpu(DeviceClass device) { return device == DeviceClass::cpu; }

} // namespace wavepath
