// A finished render as a command that renders the same bits.
#pragma once

#include <string>

#include "host/render/loop/render_result.h"
#include "host/session/prepare.h"

namespace wavepath {

// Every decision of the plan as a flag, and the samples that were rendered. Empty where no command repeats it: stopped
// within a pass, or by the clock while samples were shared out by noise. Leaves out how files are laid out.
std::string repeat_command(const SceneRequest& scene, const RenderRequest& render, const MotionRequest& motion,
                           const Prepared& prepared, const RenderResult& result);

} // namespace wavepath
