// The picture in the window as a command line that renders the same bits.
#pragma once

#include <string>

#include "host/render/progressive/display.h"
#include "host/render/render.h"
#include "host/scene/staging/view.h"

namespace wavepath {

// `wavepath render` with the camera, all settings that decide the picture, and `more` flags. All samples planned are
// asked for.
std::string render_line(const std::string& scene, const ViewRequest& camera, const RenderPlan& settings,
                        const DisplayOptions& display, const std::string& more);

} // namespace wavepath
