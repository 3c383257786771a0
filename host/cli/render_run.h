// Renders a prepared scene: on one device or several, from the beginning or from a saved state; or replays one path.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/base/failure.h"
#include "host/cli/render_prepare.h"
#include "host/picture/picture.h"
#include "host/render/multi_device/several_devices.h"
#include "host/render/report/true_error.h"

namespace wavepath {

struct Rendered {
  RenderResult result;
  // What --devices measured; empty on one device. Its member `result` has been moved to the one above.
  std::optional<MultiDeviceResult> shared;
  std::vector<TrueError> true_errors; // error against the reference, one for each checkpoint; empty without a reference
};

// Prints the trace of --pixel. Writes no file. Returns the exit code.
int replay(const RenderCommandRequest& request, Prepared& prepared);

// Renders the picture. With --resume it continues from the state in the file of --checkpoint. `reference`: may be
// empty. `publish`: gets the result so far, every --save-every seconds. Throws Error.
Rendered run(const RenderCommandRequest& request, Prepared& prepared, const std::optional<Picture>& reference,
             const std::function<void(const RenderResult&)>& publish);

// Sends the picture to the viewer of --tev. If the viewer has gone away, rendering continues without it.
void show(const RenderCommandRequest& request, Prepared& prepared, const Picture& picture);

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
