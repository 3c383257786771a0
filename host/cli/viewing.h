// The scene that a window or a browser shows: on its device, with its render, and what is written and told of both.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/picture/files/write_options.h"
#include "host/picture/picture.h"
#include "host/plan/decision.h"
#include "host/render/progressive/display.h"
#include "host/render/progressive/progressive.h"
#include "host/render/render.h"
#include "host/scene/staging/framing.h"
#include "host/session/requests.h"
#include "host/session/session.h"
#include "host/session/viewing/viewed_scene.h"

namespace CLI {
class App;
}

namespace wavepath {

struct ViewingRequest {
  SceneRequest scene;
  RenderRequest render;
  WriteOptions tone;
  Shown shown = Shown::color;
  std::string command_line;
};

// Most samples a pixel that a render which is looked at can be asked for.
inline constexpr std::uint32_t kMostViewedSamples = 1u << 30;

// Refuses what does not go together, and completes the settings. `frames`: samples a pixel to end at; 0 = as the
// settings say. Throws UsageError, and Error where the scene is missing.
void check_viewing(ViewingRequest& request, std::uint32_t frames = 0);

// The flag --show, and those of scene, camera, picture and light transport; `request` must outlive the parsing.
void add_show_flag(CLI::App& app, const char* group, const char* choices, ViewingRequest& request);
void add_viewing_flags(CLI::App& app, const char* group, ViewingRequest& request);

// The display to begin with.
DisplayOptions first_display(const ViewingRequest& request);

class Viewing {
public:
  // Loads and prints what lights the scene, and warnings. `request` and the extensions must outlive it. `output`: a
  // file to be written that the scene must not consist of; empty = none.
  explicit Viewing(const ViewingRequest& request, std::span<const char* const> window_extensions = {},
                   const std::string& output = "");

  Session& session() { return session_; }
  ViewedScene& scene() { return *scene_; }
  Framing framing();
  // Flags that `wavepath render` needs besides those of camera and settings.
  std::string flags() const;
  // Sentences about approximations in a picture with these settings.
  std::vector<std::string> notes(const RenderPlan& settings) const;
  // The plan of a picture with these settings. Pilots decide nothing of it, so that the copied command says all.
  std::vector<Decision> decisions(const RenderPlan& settings) const;
  // Writes a picture of the render as it is now. Throws Error.
  void save(const std::string& path, const Picture& picture, const DisplayOptions& display) const;
  // For the next start.
  void save_kernels();

private:
  // The parts of the result that list_bias() reads.
  RenderResult so_far() const;
  const Progressive& render() const { return scene_->render(); }

  const ViewingRequest& request_;
  Session session_;
  std::optional<ViewedScene> scene_;
};

} // namespace wavepath
