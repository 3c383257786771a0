// wavepath render --frames: one scene, one device and one set of kernels for all frames.
#pragma once

#include "host/cli/render_request.h"

namespace wavepath {

// Renders the frames whose files are not there yet. What a frame shows depends on the command without its range: other
// runs and machines render it to the same bits. Returns the exit code. Throws Error.
int render_sequence(const RenderCommandRequest& request);

} // namespace wavepath
