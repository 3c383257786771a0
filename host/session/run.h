// Renders a prepared scene: on one device or several, from the beginning or from a saved state.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/base/failure.h"
#include "host/picture/picture.h"
#include "host/render/multi_device/several_devices.h"
#include "host/render/report/true_error.h"
#include "host/session/prepare.h"

namespace wavepath {

struct Rendered {
  RenderResult result;
  // What --devices measured; empty on one device. Its member `result` has been moved to the one above.
  std::optional<MultiDeviceResult> shared;
  std::vector<TrueError> true_errors; // error against the reference, one for each checkpoint; empty without a reference
};

// What the caller takes part in.
struct RunHooks {
  ProgressCallback progress{};                        // false ends the render with what it has
  std::function<void(const Picture&)> show{};         // as RenderHooks::show
  std::function<void(const RenderResult&)> publish{}; // as RenderHooks::publish
  double publish_interval = 0.0;
  const Picture* reference = nullptr; // its error is measured at each checkpoint; null = none
};

// Renders the picture. With --resume it continues from the state in the file of --checkpoint. Throws Error.
Rendered run(const RenderRequest& request, Prepared& prepared, const RunHooks& hooks);

// Calls `measure`, whose failure must not end the render: what a report tells besides the picture may be missing.
// Returns the reason of the failure, empty on success. Adds the warning "`what` not measured: reason".
template <class Measure>
std::string why_not_measured(Prepared& prepared, const char* what, const Measure& measure) {
  std::string why;
  try {
    measure();
  } catch (const DeviceLost&) {
    why = "the device was lost after the last sample";
  } catch (const std::exception& failure) {
    why = failure_text(failure);
  }
  if (!why.empty()) prepared.warnings.add(fmt::format("{} not measured: {}", what, why));
  return why;
}

} // namespace wavepath
