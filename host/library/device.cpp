// Devices of the interface.
#include "host/library/device_state.h"

#include <wavepath/device.h>

#include "host/base/error.h"
#include "host/gpu/context.h"
#include "host/gpu/device.h"
#include "host/library/guard.h"

namespace wavepath_v0 {
namespace {

DeviceInfo shown(const wavepath::DeviceInfo& info) { return {info.name, info.driver, info.type, info.missing}; }

} // namespace

DeviceLock::DeviceLock(DeviceState& state) : state_(state) {
  if (state.user == std::this_thread::get_id())
    throw wavepath::Error(state.device.device->info().name, "is rendering, and was asked for more by a callback",
                          "end the render first (progress: return false), or use another device");
  state.mutex.lock();
  state.user = std::this_thread::get_id();
}

DeviceLock::~DeviceLock() {
  state_.user = std::thread::id();
  state_.mutex.unlock();
}

std::shared_ptr<DeviceState> open_device_state(const std::string& name) {
  return keep_device(wavepath::open_device(name));
}

std::shared_ptr<DeviceState> keep_device(wavepath::SessionDevice device) {
  auto state = wavepath::make_kept_over_fork<DeviceState>();
  state->device = std::move(device);
  return state;
}

std::vector<DeviceInfo> devices() {
  return wavepath::guarded([] {
    std::vector<DeviceInfo> all;
    for (const wavepath::DeviceInfo& info : wavepath::list_devices()) all.push_back(shown(info));
    return all;
  });
}

Device::Device(const std::string& name) : state_(wavepath::guarded([&] { return open_device_state(name); })) {}

DeviceInfo Device::info() const { return shown(state_->device.device->info()); }

} // namespace wavepath_v0
