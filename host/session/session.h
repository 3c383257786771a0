// A scene that stays on a device while things about it change, and the renders of it.
//
//     Session session(request);              loads the scene, opens the device
//     session.set_material(3, red);          notes an edit
//     session.update();                      packs and uploads what the edits changed; render() does so too
//     SessionPicture a = session.render(settings);
//
// A picture depends on the request, on the edits that hold and on the settings, not on the way that led there: an edit
// that is taken back leaves no trace, and a scene that is edited to be like another file gives that file's bits. (They
// agree if both have the same origin, see SessionRequest.)
//
// Nothing here prints, exits or handles signals. A session is used by one thread at a time, and so are sessions that
// share a device. Others run beside it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <glm/glm.hpp>

#include "host/base/warnings.h"
#include "host/picture/picture.h"
#include "host/plan/decision.h"
#include "host/render/render.h"
#include "host/scene/scene.h"
#include "host/scene/staging/view.h"
#include "host/session/motion_request.h"
#include "host/session/open_scene.h"
#include "host/session/requests.h"
#include "host/session/run.h"

namespace wavepath {

class Progressive; // host/render/progressive/progressive.h

// What a session keeps for edits to come. one_picture: nothing; edits of the scene are refused. light: for another
// environment or variant, and for settings that pack the scene otherwise. poses: also for set_moment() and all that
// changes nothing else of the file's nodes and materials. edits: all.
enum class SessionUse { one_picture, light, poses, edits };

struct SessionRequest {
  SceneRequest scene;
  // Kernels begin to compile for these settings, and the scene is packed for them. Its device is opened unless `device`
  // is there. Its origin, or without one the eye of `scene`.view, is where single precision is finest; it is that of
  // all pictures of the session.
  RenderRequest render;
  MotionRequest motion{}; // what the channels of motion tell it to
  SessionDevice device{};
  SessionUse use = SessionUse::edits;
  // Huge triangles are cut finely for the first camera alone (host/scene/pack/cut.h), so that no other one has
  // anything packed; else for that of each picture.
  bool keeps_cut = false;
  std::span<const char* const> window_extensions{};
};

// A mesh that is no part of the file. Its primitives name materials of Session::scene().
struct AddedMesh {
  std::string name; // of the node that shows it
  Mesh mesh;
  glm::dmat4 world_from_object{1.0};
  bool is_visible = true;
};

// A part of the work of update().
struct Redone {
  const char* what = ""; // "pose", "environment", "materials", "textures", "triangles", "tree", "lights", "upload"
  double milliseconds = 0.0;
};

struct SessionUpdate {
  std::vector<Redone> redone; // empty if nothing had changed
  double milliseconds = 0.0;
  std::uint64_t built_triangles = 0; // triangles of the trees that were built
  // What was taken over: materials, textures and the environment; triangles, vertices and the tree.
  bool kept_surfaces = false, kept_geometry = false;
  bool kept_shapes = false; // triangles, vertices and the tree but for those that are elsewhere
};

struct SessionHooks : RunHooks {
  // Asked while passes and missing light are found; false ends that. Null = they are found to the end.
  std::function<bool()> goes_on{};
  bool measures_missing_light = false; // for `bias` of the stats: renders a little more after the picture
  std::string command{};               // that the stats tell
};

// A picture and what is known of it.
struct SessionPicture {
  RenderResult result; // its picture has the channels of AOVs and passes, and the denoised ones
  View view;
  RenderPlan settings; // without any `auto`
  std::vector<Decision> plan;
  std::vector<std::string> bias;
  Warnings warnings;
  std::string stats;  // the stats document (host/render/report/stats.h)
  std::string repeat; // command that renders the same bits; empty if there is none, as after edits
};

class Session {
public:
  // Loads the scene and opens the device. `request.render` must be as resolve_settings() (resolve.h) leaves it. Throws
  // Error.
  explicit Session(const SessionRequest& request);
  ~Session();
  Session(const Session&) = delete;

  // The scene with the edits that update() has done. Materials, images and nodes have the indices of these arrays;
  // materials and nodes that are added come behind those of the file.
  const Scene& scene() const;
  const PackedScene& packed() const;
  const DeviceInfo& device_info() const;
  SessionDevice device() const;
  // What lights the scene and why, if a rule has chosen it; and the camera that the view of the request gives.
  const std::string& light() const;
  View view(std::uint32_t width, std::uint32_t height) const;
  const SceneRequest& scene_request() const; // with the edits that it can tell

  // A render that the caller steps, of a picture that is shown while it is rendered. Does the edits first. From here on
  // update() packs for its settings and hands it what has changed: it begins anew then, coarse after a move of the
  // camera. `lets_go`: called before its scene goes from the device; what renders beside it has to go then. A second
  // call ends the first one's. Throws Error.
  Progressive& begin(const RenderPlan& settings, std::function<void()> lets_go = {});
  // The settings that update() is for; they must be as resolve_settings() leaves them.
  void set_settings(const RenderPlan& settings);

  // Edits are noted; update() or render() does them. Each throws Error at once if its arguments make no sense, and
  // then changes nothing.
  void set_view(const ViewRequest& view);
  // Where single precision is finest, for all pictures from here on; without one the eye of the view that holds now. It
  // changes last bits, and all is packed again.
  void set_origin(const std::optional<glm::dvec3>& origin);
  // Moment of the animation in seconds; `shutter`: when it opens and closes, instead of `at`.
  void set_moment(double at, std::optional<std::pair<double, double>> shutter = {});
  // Variant of the materials, one of Scene::variants; empty: none.
  void set_variant(const std::string& name);
  // The other moments and cameras that --aov motion and motion_back tell motion to.
  void set_motion(const MotionRequest& motion);
  void set_environment(const EnvironmentRequest& environment); // reads the file at once
  void set_environment(Environment environment);
  void reset_environment(); // as update() has done it last
  void set_material(std::size_t material, const Material& value);
  std::size_t add_material(const Material& value);
  // Colour, cones, range and extent of the visible light of this node, or with kNoIndex of the one that no node carries
  // (a sun or a lamp that was added). Its name, kind, place and direction stay.
  void set_light(std::uint32_t node, const PunctualLight& value);
  // Replaces the texels of an image, of any size.
  void set_image(std::size_t image, Image value);
  std::size_t add_image(Image value);
  // `parent_from_node`: the node's matrix as glTF has it; its children follow. Replaces what an animation says.
  void set_matrix(std::size_t node, const glm::dmat4& parent_from_node);
  void reset_matrix(std::size_t node); // as the file has it
  glm::dmat4 matrix(std::size_t node) const;
  // A node that is invisible hides its children.
  void set_visible(std::size_t node, bool is_visible);
  bool is_visible(std::size_t node) const; // as the node itself says
  // Returns the node that shows it, for set_matrix() and set_visible().
  std::size_t add_mesh(AddedMesh mesh);
  void remove_mesh(std::size_t node); // that add_mesh() returned; its number is not used again

  // Does the edits, by default for the settings of the request or those set since. Throws Error if the scene cannot be
  // packed or does not fit; the edits stay noted then, and the next update packs everything. The render of begin() is
  // not to be stepped before one that succeeds.
  SessionUpdate update();
  // Its first step alone, after which scene() is as the edits of nodes have it.
  void pose();
  SessionUpdate update(const RenderRequest& request);
  // Updates, plans and renders, by these settings as resolve_settings() leaves them; its device and origin are those of
  // the session. Throws Error.
  SessionPicture render(const RenderRequest& request, const SessionHooks& hooks = {});

  // For callers that plan, run and finish by themselves (prepare.h, run.h, finish.h), after update().
  Prepared& prepared();
  LoadedScene& loaded();

private:
  struct State;
  std::unique_ptr<State> state_;
};

} // namespace wavepath
