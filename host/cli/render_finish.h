// Ends a render: writes the pictures, makes the measurements that only the report needs, and reports.
#pragma once

#include "host/cli/render_run.h"

namespace wavepath {

// Writes pictures and stats of a render that goes on. What fails becomes a warning.
void save_so_far(const RenderCommandRequest& request, Prepared& prepared, const RenderResult& so_far);

// Returns the exit code. Throws Error.
int finish(const RenderCommandRequest& request, Prepared& prepared, Rendered& rendered,
           const std::optional<Picture>& reference);

} // namespace wavepath
