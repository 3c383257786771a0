// A camera as flags of `wavepath render`.
#pragma once

#include <string>

#include "host/scene/staging/view.h"

namespace wavepath {

// The same request is read again from them, to the last bit; empty for the first camera.
std::string camera_flags(const ViewRequest& request);

} // namespace wavepath
