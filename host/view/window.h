// The window of `wavepath view`: shows a render in progress, reads input, and applies it to camera and settings.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host/render/progressive/display.h"
#include "host/render/progressive/progressive.h"
#include "host/scene/pack/pack.h"
#include "host/scene/scene.h"
#include "host/scene/staging/framing.h"
#include "host/scene/staging/view.h"
#include "host/view/comparison_choice.h"
#include "host/view/environment_choice.h"

namespace wavepath {

struct WindowRequest {
  std::string title;
  const Scene* scene = nullptr;        // its path, cameras and warnings; geometry may be gone by now
  const PackedScene* packed = nullptr; // scene on the host, for the point that was clicked
  Framing framing;                     // framing of the geometry
  ViewRequest view;                    // camera flags of the command line
  // Flags that the copied command needs besides the scene's path, camera and settings, to render the same bits.
  std::function<std::string()> more_flags;
  DisplayOptions display;        // to begin with
  EnvironmentChoice environment; // to begin with
  ComparisonChoice comparison;   // initial choice; the render then has the AOV `direct`
  double target_error = 0.0;     // error for which the remaining time is shown; 0 = none
  std::uint32_t frames = 0; // samples a pixel after which the window closes (scripted); 0 = when the user closes it
  std::string screenshot;   // file that a scripted window writes at its end; empty = none
  // Sentences about approximations in a picture with these settings.
  std::function<std::vector<std::string>(const RenderPlan&)> notes;
  // Writes a picture of the render as it is now. Throws Error.
  std::function<void(const std::string& path, const Picture&, const DisplayOptions&)> save;
  // Hands `progressive` the scene as it is to be packed for these settings. Throws Error; then all is as it was.
  std::function<void(const RenderPlan&)> pack_for;
  // Hands `progressive` another environment. Throws Error; then everything is as it was. Empty: it stays as it is.
  std::function<void(const EnvironmentChoice&)> set_environment;
};

// Instance extensions that a window needs. Throws Error where there is no display, or none that can be opened.
std::vector<const char*> window_extensions();

// Opens the window and returns when it is closed or has all samples asked for (scripted). `device` was opened with
// window_extensions(). Returns the exit code.
int run_window(Device& device, Progressive& progressive, const WindowRequest& request);

} // namespace wavepath
