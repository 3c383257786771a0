// Error of a device that refuses something although it is fit for other work.
#pragma once

#include "host/base/error.h"

namespace wavepath {

// The device can do other things, but its kernels cannot see as many buffers, or as large ones, as this takes.
struct DeviceLimit : Error {
  using Error::Error;
};

} // namespace wavepath
