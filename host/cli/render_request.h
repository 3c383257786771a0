// The request of `wavepath render`, complete and checked: what cannot work is refused before the scene is loaded.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/cli/render_flags.h"
#include "host/cli/scene_flags.h"
#include "host/cli/sequence_request.h"
#include "host/picture/picture.h"
#include "host/render/report/stats.h"
#include "host/session/motion_request.h"

namespace wavepath {

class ProgressDisplay;

struct RenderCommandRequest {
  SceneRequest scene;
  RenderRequest render;
  OutputRequest output;
  std::string command_line;
  bool stays_in_memory = false; // the picture is for the caller: no file is named by default, and none need hold it
  SequenceRequest sequence;
  MotionRequest motion;                // of a frame of a sequence: the frames beside it
  std::optional<FrameReport> frame;    // frame of the sequence that this render is; empty = no sequence
  ProgressDisplay* progress = nullptr; // display of all frames; null = the render shows its own
};

// Adds SCENE and all flags of `render`. `request` must outlive the parsing of `app`.
void add_flags_of_render(CLI::App& app, RenderCommandRequest& request);

// Every file that the command writes.
std::vector<std::string> targets_of(const RenderCommandRequest& request);

// Replaces the defaults of the request by values, and refuses what cannot work. Returns the reference picture of
// --reference; empty without one. Throws UsageError and Error.
std::optional<Picture> resolve(RenderCommandRequest& request);

// Checks that the modules which write these picture formats could be loaded, before time is spent on rendering. Throws
// Error.
void require_writers(const OutputRequest& output);

} // namespace wavepath
