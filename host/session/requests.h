// What a render is asked for: the scene, how it is seen and lit, the settings; and what of it does not go together.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

#include "bvh/build.h"
#include "host/plan/record.h"
#include "host/render/settings/render_plan.h"
#include "host/scene/gltf/gltf.h"
#include "host/scene/staging/view.h"
#include "host/scene/staging/volume.h"

namespace wavepath {

inline constexpr std::uint32_t kOpenEndedSamples = 65536; // samples of a render that ends by time, error or the user

struct SceneRequest {
  std::string path;
  LoadOptions load;
  ViewRequest view;
  std::string environment; // argument of load_environment(); empty = chosen by choose_light()
  double environment_intensity = 1.0;
  double environment_degrees = 0.0; // rotation of the environment about +Y
  bool ground = false;
  std::string catcher;                       // the shadow catcher: "ground", or a node; empty = none
  std::optional<glm::dvec2> sun;             // degrees: azimuth from +X towards +Z, elevation
  double sun_angle = 0.0, lamp_radius = 0.0; // extent of punctual lights: degrees across, metres; 0 = none
  VolumeRequest volume;                      // a volume in place of one of the file
  bool sun_if_unlit = false;                 // a scene without lights gets a sun, for studies of lamp shadows
  // Moment whose pose decides what the file leaves open: framing, light, ground. Empty = the moment of the picture.
  std::optional<double> staged_at;
};

// Where an environment comes from: as SceneRequest has it.
struct EnvironmentRequest {
  std::string source; // empty = chosen by rule
  double intensity = 1.0;
  double degrees = 0.0; // of rotation about +Y

  bool operator==(const EnvironmentRequest&) const = default;
};
EnvironmentRequest environment_of(const SceneRequest& request);

// The flags --checkpoint and --resume: a state of the render, kept in a file from which a later render can continue.
struct StateRequest {
  std::string file;       // empty = none
  double interval = 30.0; // seconds between saves
  bool resume = false;
};

struct RenderRequest {
  RenderPlan settings;                 // its sample range is complete after resolve_samples() (resolve.h)
  std::vector<std::string_view> given; // names of the settings that the command line has
  // Tree quality that was asked for; empty = chosen from the number of rays (bvh_quality.h).
  std::optional<bvh::Quality> bvh;
  std::string device;
  std::string devices;                    // text of --devices; empty = render on one device
  std::vector<std::string> other_devices; // the devices that `devices` names besides `device`
  std::optional<glm::dvec3> origin; // origin of the device's coordinates, in world space; empty = the camera's position
  bool strict = false;
  bool mergeable = false; // .exr outputs hold the exact sums
  StateRequest state;
  std::string plan_file; // stats, picture or state of an earlier render, whose decisions are repeated; empty = none
  std::optional<PlanRecord> recorded;            // its decisions, or others to be repeated; empty = decide anew
  std::optional<std::uint64_t> training_paths;   // --training-paths; empty = chosen from the length of the render
  std::optional<std::uint32_t> guide_iterations; // --guide-iterations; empty = chosen likewise
  std::optional<glm::uvec2> pixel;               // pixel whose path is replayed
  std::optional<std::uint32_t> sample;           // sample of that pixel; given if and only if `pixel` is
  std::uint32_t replicate = 0;                   // replicate of that pixel
};

bool is_given(const RenderRequest& request, std::string_view setting);

// Refuses a shutter that the integrator cannot show, or that opens where nothing moves. Sets the shutter's members of
// `settings`. Throws UsageError.
void check_shutter(const SceneRequest& request, RenderPlan& settings);
// Sets the members of `settings` that a shadow catcher asks for. Throws UsageError if the integrator knows none.
void check_catcher(const SceneRequest& request, RenderPlan& settings);
// Refuses flags of a volume that is not there. Throws UsageError.
void check_volume(const VolumeRequest& volume);
// Refuses flags of a camera that do not go together, or with the lens and the size of the picture.
void check_camera(const ViewRequest& view, const RenderPlan& settings);
// The files that a command reads besides those that the scene names; `reference` may be empty.
std::vector<std::string> inputs_of(const SceneRequest& request, const RenderPlan& settings,
                                   const std::string& reference = "");
// The flags that give this request, without the file and the camera, each preceded by a blank.
std::string flags_of(const SceneRequest& request);

} // namespace wavepath
