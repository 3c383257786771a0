// The picture in the window as a command line that renders the same bits.
#pragma once

#include <string>
#include <vector>

#include "host/picture/files/relight.h"
#include "host/render/progressive/display.h"
#include "host/render/render.h"
#include "host/scene/staging/view.h"

namespace wavepath {

// `wavepath render` with the camera, all settings that decide the picture, and `more` flags. All samples planned are
// asked for. Where lights are mixed, `wavepath relight` follows; either way `-o FILE` completes the line.
std::string render_line(const std::string& scene, const ViewRequest& camera, const RenderPlan& settings,
                        const DisplayOptions& display, const std::string& more);

// Gains of the light groups as the decimal numbers that their text is, so that a command repeats them.
std::vector<GroupGain> gains_of(const RenderPlan& settings, const DisplayOptions& display);

} // namespace wavepath
