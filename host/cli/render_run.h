// Renders a prepared scene: one device or several, from a state on, or one path of it.
#pragma once

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
  std::optional<MultiDeviceResult> shared; // of --devices; its result is moved from
  std::vector<TrueError> true_errors;      // one for each checkpoint, if there is a reference
};

// Prints the trace of --pixel. Writes no file. Returns the exit code.
int replay(const RenderCommandRequest& request, Prepared& prepared);

// Renders, from the state of --checkpoint on where --resume asks for it. Throws Error.
Rendered run(const RenderCommandRequest& request, Prepared& prepared, const std::optional<Picture>& reference);

// Shows the picture in the viewer of --tev. One that goes away does not end the render.
void show(const RenderCommandRequest& request, Prepared& prepared, const Picture& picture);

// The picture is there, or will be, whatever becomes of what a report tells besides: where that fails, why it did.
// `what` was not measured then, which a warning tells.
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
