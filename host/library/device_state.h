// An open device of the interface.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include <wavepath/device.h>

#include "host/session/session.h"

namespace wavepath_v0 {

struct DeviceState {
  wavepath::SessionDevice device;
  std::mutex mutex;                                     // held by whatever uses the device
  std::atomic<std::thread::id> user{std::thread::id()}; // thread that holds it
};

// Holds a device. Throws Error where its own thread holds it already, as in the callback of a render.
class DeviceLock {
public:
  explicit DeviceLock(DeviceState& state);
  ~DeviceLock();
  DeviceLock(DeviceLock&&) = delete;

private:
  DeviceState& state_;
};

// Throws Error.
std::shared_ptr<DeviceState> open_device_state(const std::string& name);
std::shared_ptr<DeviceState> keep_device(wavepath::SessionDevice device);

} // namespace wavepath_v0
