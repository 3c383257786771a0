// What viewers are told: the messages of the protocol wavepath.1 that are not pictures, as JSON. docs/serve.md
// describes them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "host/plan/decision.h"
#include "host/render/progressive/display.h"
#include "host/render/progressive/progressive.h"
#include "host/render/settings/render_plan.h"
#include "host/session/requests.h"

namespace wavepath {

// What changes by what viewers do, not by rendering.
struct SceneReport {
  std::string scene, device, light;
  std::uint64_t triangles = 0, lights = 0;
  std::vector<std::string> cameras, notes;
  std::vector<Decision> plan;
  EnvironmentRequest environment;
  std::vector<std::string> environments; // that can be chosen
  RenderPlan settings;
  DisplayOptions display;
  double target_error = 0.0;
};
std::string scene_json(const SceneReport& report);

struct StatusReport {
  ProgressiveStatus status;
  double exposure = 0.0;     // stops, in use
  double target_error = 0.0; // 0 = none
  double seconds_to_target = 0.0;
  bool reached = false;
  std::size_t viewers = 0;
};
std::string status_json(const StatusReport& report);

// Whether the viewer that reads it steers, and whether another one asks to.
std::string role_json(bool steers, bool is_asked);

struct PickReport {
  glm::dvec2 at{0.0};
  std::uint32_t x = 0, y = 0;                        // pixel
  std::vector<std::pair<std::string, float>> values; // channels of the picture there
  std::optional<std::string> node, material;
  std::optional<glm::dvec3> point;
  double distance = 0.0;
  std::uint32_t spp = 0;
};
std::string pick_json(const PickReport& report);

std::string copied_json(const std::string& line);
// A sentence for one viewer, or why something was not done.
std::string note_json(const std::string& text);

} // namespace wavepath
