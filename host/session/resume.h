// Reads and writes the state of a render on disk.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "host/base/warnings.h"
#include "host/gpu/device.h"
#include "host/render/report/state_file.h"
#include "host/session/requests.h"

namespace wavepath {

// Refuses, before anything is loaded, a state that would be overwritten unasked or could not be written. Throws Error.
void check_state_file(const StateRequest& request);

// The state that --resume names; nothing if there is no such file yet. Throws Error if the state is of another render.
std::optional<RenderState> read_resumed(const StateRequest& request, const RenderPlan& settings,
                                        const std::string& identity, const DeviceInfo& device, Warnings& warnings);

// Writes the state to the file; a failure (a full disk) becomes a warning, because the render can go on and the file
// still holds what it held.
std::function<void(const RenderState&)> state_saver(const StateRequest& request, const std::string& identity,
                                                    const std::string& plan, const DeviceInfo& device,
                                                    Warnings& warnings);

// Name and driver.
std::string device_text(const DeviceInfo& device);

} // namespace wavepath
