// The panel of the window: widgets that show and change plain values. The window acts on the changes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/picture/metrics/shadow_score.h"
#include "host/render/progressive/display.h"
#include "host/render/progressive/progressive.h"
#include "host/session/requests.h"
#include "host/view/comparison_choice.h"

namespace wavepath {

// State that the widgets change.
struct PanelState {
  bool visible = true;
  RenderPlan settings;
  DisplayOptions display;
  EnvironmentRequest environment;
  std::string variant; // empty: none
  ComparisonChoice comparison;
  double target_error = 0.0; // relative RMS; 0 = none
  std::string message;       // result of the last action, or why it failed
};

// Facts that the panel shows but does not change.
struct PanelFacts {
  std::string scene, device;
  ProgressiveStatus status;
  double seconds_to_target = 0.0;
  std::vector<std::string> cameras;  // names
  std::vector<std::string> variants; // likewise
  std::vector<std::string> notes;    // approximations in the picture
  std::optional<ShadowScore> score;  // score of the shadows shown against the other ones
};

// Requests of the user since the panel was last drawn.
struct PanelWishes {
  bool settings = false, environment = false, variant = false; // changed; the window has to apply them
  bool save_exr = false, save_png = false, copy = false, reset = false, frame = false;
  std::optional<std::size_t> camera;
};

PanelWishes show_panel(PanelState& state, const PanelFacts& facts);

} // namespace wavepath
