// The panel: what can be set, and what there is to know. Widgets over plain values; acting on them is the window's.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/render/display.h"
#include "host/render/progressive.h"
#include "host/view/window.h"

namespace wavepath {

// As the widgets hold it.
struct PanelState {
  bool visible = true;
  RenderSettings settings;
  DisplayOptions display;
  EnvironmentChoice environment;
  double target_error = 0.0; // relative RMS; 0 = none
  std::string message;       // what was done last, or why not
};

// What is told but not set.
struct PanelFacts {
  std::string scene, device;
  ProgressiveStatus status;
  double seconds_to_target = 0.0;
  std::vector<std::string> cameras; // names
  std::vector<std::string> notes;   // what in the picture is approximated
  bool sets_environment = false;
};

// What was asked for since the last frame.
struct PanelWishes {
  bool settings = false, environment = false; // changed, and to be taken
  bool save_exr = false, save_png = false, copy = false, reset = false, frame = false;
  std::optional<std::size_t> camera;
};

PanelWishes show_panel(PanelState& state, const PanelFacts& facts);

} // namespace wavepath
