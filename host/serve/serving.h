// The scene in browsers: owns the render, applies what viewers ask for, and hands the server pictures as they are due.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host/picture/picture.h"
#include "host/plan/decision.h"
#include "host/render/progressive/display.h"
#include "host/render/settings/render_plan.h"
#include "host/scene/staging/framing.h"
#include "host/serve/server.h"
#include "host/session/viewing/viewed_scene.h"

namespace wavepath {

struct ServingRequest {
  Framing framing; // of the geometry
  // Flags that the copied command needs besides the scene's path, camera and settings, to render the same bits.
  std::function<std::string()> more_flags;
  DisplayOptions display; // to begin with
  double target_error = 0.0;
  // Sentences about approximations in a picture with these settings.
  std::function<std::vector<std::string>(const RenderPlan&)> notes;
  // What decides a picture with these settings.
  std::function<std::vector<Decision>(const RenderPlan&)> plan;
  // Writes a picture of the render as it is now. Throws Error.
  std::function<void(const std::string& path, const Picture&, const DisplayOptions&)> save;
  std::function<bool()> ends; // asked again and again
};

// Serves until it ends.
void serve_scene(ViewedScene& scene, Server& server, const ServingRequest& request);

} // namespace wavepath
