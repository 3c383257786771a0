// Vulkan devices.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <wavepath/export.h>

namespace wavepath_v0 {

struct DeviceInfo {
  std::string name, driver;
  std::string type;                 // "cpu", "integrated", "discrete" or "virtual"
  std::vector<std::string> missing; // features that wavepath needs and the device lacks
};

// All devices, in the order of their indices.
WAVEPATH_API std::vector<DeviceInfo> devices();

struct DeviceState;

// An open device. Copies are the same device. Sessions that share one render one after the other, also from several
// threads; two devices render beside each other.
class WAVEPATH_API Device {
public:
  // `name`: a part of the name, or an index; empty = a discrete GPU if there is one, else an integrated GPU, else
  // another one. Throws Error.
  explicit Device(const std::string& name = "");
  explicit Device(std::shared_ptr<DeviceState> state) : state_(std::move(state)) {}
  DeviceInfo info() const;

  const std::shared_ptr<DeviceState>& state() const { return state_; }

private:
  std::shared_ptr<DeviceState> state_;
};

} // namespace wavepath_v0
