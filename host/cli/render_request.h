// What `wavepath render` is asked for, and what of it cannot work: refused before the time of loading and rendering is
// spent.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/cli/render_flags.h"
#include "host/cli/scene_flags.h"
#include "host/picture/picture.h"
#include "host/plan/record.h"

namespace wavepath {

struct RenderCommandRequest {
  SceneRequest scene;
  RenderRequest render;
  OutputRequest output;
  std::string command_line;
  std::optional<PlanRecord> recorded; // of --plan
};

// Every file that the command writes.
std::vector<std::string> targets_of(const RenderCommandRequest& request);

// Resolves the settings, and refuses what cannot work. Returns the reference, if there is one. Throws UsageError and
// Error.
std::optional<Picture> resolve(RenderCommandRequest& request);

// Writers that had to be loaded are there: what cannot be written is not rendered. Throws Error.
void require_writers(const OutputRequest& output);

} // namespace wavepath
