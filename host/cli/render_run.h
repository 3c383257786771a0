// The steps of `wavepath render`, with what they tell the user: progress, light, plan.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "host/cli/render_request.h"
#include "host/picture/picture.h"
#include "host/session/session.h"

namespace wavepath {

// Opens the devices and the viewer of --tev, loads the scene and begins to compile kernels. Throws Error.
std::unique_ptr<Session> open_session(const RenderCommandRequest& request, SessionUse use);

// Makes the plan, and prints the decisions that a user should know. Throws Error.
void plan_render(const RenderCommandRequest& request, Prepared& prepared);

// Prints the trace of --pixel. Writes no file. Returns the exit code.
int replay(const RenderCommandRequest& request, Prepared& prepared);

// Renders the picture, with progress on the terminal, until a signal ends it. `reference`: may be empty. `publish`:
// gets the result so far, every --save-every seconds. Throws Error.
Rendered run(const RenderCommandRequest& request, Prepared& prepared, const std::optional<Picture>& reference,
             const std::function<void(const RenderResult&)>& publish);

// Sends the picture to the viewer of --tev. If the viewer has gone away, rendering continues without it.
void show(const RenderCommandRequest& request, Prepared& prepared, const Picture& picture);

} // namespace wavepath
