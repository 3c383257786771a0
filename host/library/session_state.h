// A resident scene of the interface.
#pragma once

#include <map>
#include <memory>
#include <mutex>

#include <wavepath/session.h>

#include "host/library/device_state.h"
#include "host/session/session.h"

namespace wavepath_v0 {

struct SessionState {
  SessionState() = default;
  ~SessionState(); // its part of the device is released when nothing else uses that
  SessionState(SessionState&&) = delete;

  Scene scene;
  Settings settings;
  std::shared_ptr<DeviceState> device;
  std::unique_ptr<wavepath::Session> session;
  wavepath::SceneRequest loaded;                    // what the session shows now
  wavepath::MotionRequest motion;                   // and tells motion to
  bool keeps_kernels = false;                       // true once a picture's kernels are on disk
  std::map<std::size_t, wavepath::Material> edited; // materials as noted, until update() has done them
};

} // namespace wavepath_v0
