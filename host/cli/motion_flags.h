// The flags of the pictures that motion passes tell motion to.
#pragma once

#include "host/session/motion_request.h"

namespace CLI {
class App;
}

namespace wavepath {

// --motion-to, --camera-to, --motion-from, --camera-from.
void add_motion_flags(CLI::App& app, MotionRequest& request);

} // namespace wavepath
