// The window of `wavepath view`: shows a render in progress, reads input, and applies it to camera and settings.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host/picture/picture.h"
#include "host/render/progressive/display.h"
#include "host/render/settings/render_plan.h"
#include "host/scene/staging/framing.h"
#include "host/session/viewing/viewed_scene.h"
#include "host/view/comparison_choice.h"

namespace wavepath {

struct WindowRequest {
  std::string title;
  Framing framing; // framing of the geometry
  // Flags that the copied command needs besides the scene's path, camera and settings, to render the same bits.
  std::function<std::string()> more_flags;
  DisplayOptions display;      // to begin with
  ComparisonChoice comparison; // initial choice; the render then has the AOV `direct`
  double target_error = 0.0;   // error for which the remaining time is shown; 0 = none
  std::uint32_t frames = 0;    // samples a pixel after which the window closes (scripted); 0 = when the user closes it
  std::string screenshot;      // file that a scripted window writes at its end; empty = none
  // Sentences about approximations in a picture with these settings.
  std::function<std::vector<std::string>(const RenderPlan&)> notes;
  // Writes a picture of the render as it is now. Throws Error.
  std::function<void(const std::string& path, const Picture&, const DisplayOptions&)> save;
};

// Instance extensions that a window needs. Throws Error where there is no display, or none that can be opened.
std::vector<const char*> window_extensions();

// Opens the window and returns when it is closed or has all samples asked for (scripted). The device of the session was
// opened with window_extensions(). Returns the exit code.
int run_window(ViewedScene& scene, const WindowRequest& request);

} // namespace wavepath
