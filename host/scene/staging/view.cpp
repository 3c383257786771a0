// Chooses a camera, overrides parts of it, or frames the scene; see view.h.
#include "host/scene/staging/view.h"

#include <charconv>
#include <cmath>
#include <numbers>

#include "host/base/error.h"

namespace wavepath {
namespace {

// Long enough a lens that objects look as they are; wide enough that a room shows its walls.
constexpr double kObjectYfov = 30.0 / 180.0 * std::numbers::pi, kInteriorYfov = 60.0 / 180.0 * std::numbers::pi;

// A camera before the image's shape is known. `forward` and `up` of any length.
struct Pose {
  bool orthographic = false;
  glm::dvec3 position{0.0}, forward{0.0, 0.0, -1.0}, up{0.0, 1.0, 0.0};
  double half_height = 1.0; // of the image, at unit distance or in metres
  double half_width = 0.0;  // that the image has at least
};

// An image in the authored shape keeps the authored height to the last bit, though exporters round the ratio to floats.
constexpr double kSameShape = 1e-6;

std::string camera_names(const Scene& scene) {
  std::string names;
  for (std::size_t i = 0; i < scene.cameras.size(); ++i)
    names += (i > 0 ? ", " : "") + std::to_string(i) +
             (scene.cameras[i].name.empty() ? "" : " '" + scene.cameras[i].name + "'");
  return names;
}

const Camera& find_camera(const Scene& scene, const std::string& wanted) {
  if (wanted.empty()) return scene.cameras.front();
  for (const Camera& camera : scene.cameras)
    if (camera.name == wanted) return camera;
  std::size_t index = 0;
  const char* end = wanted.data() + wanted.size();
  const auto [stop, failure] = std::from_chars(wanted.data(), end, index);
  if (failure == std::errc{} && stop == end && index < scene.cameras.size()) return scene.cameras[index];
  throw Error(scene.path, "has no camera '" + wanted + "'",
              scene.cameras.empty() ? "leave out --camera to have the scene framed, or give --eye and --look-at"
                                    : "choose one of: " + camera_names(scene));
}

Pose pose_of(const Camera& camera) {
  Pose pose;
  pose.orthographic = camera.orthographic;
  pose.position = glm::dvec3(camera.world_from_camera[3]);
  pose.forward = -glm::dvec3(camera.world_from_camera[2]);
  pose.up = glm::dvec3(camera.world_from_camera[1]);
  pose.half_height = camera.orthographic ? camera.ymag : std::tan(0.5 * camera.yfov);
  pose.half_width = camera.orthographic ? camera.xmag : camera.aspect * pose.half_height;
  return pose;
}

// With the angle that the user wants, if any.
Pose frame_scene(const Framing& framing, const std::optional<double>& yfov, double aspect) {
  Pose pose;
  pose.half_height = std::tan(0.5 * yfov.value_or(framing.inside ? kInteriorYfov : kObjectYfov));
  if (framing.inside) {
    pose.position = framing.inside->eye;
    pose.forward = framing.inside->target - framing.inside->eye;
    return pose;
  }
  pose.position = framing_eye(framing, pose.half_height * aspect, pose.half_height);
  pose.forward = framing_forward();
  return pose;
}

void check_angle(const std::optional<double>& yfov) {
  if (yfov && !(*yfov > 0.0 && *yfov < std::numbers::pi))
    throw UsageError("--yfov", "must lie between 0 and 180 degrees", "give for example 45");
}

// A level camera stays level when it is turned: its up vector becomes the world's.
glm::dvec3 inherited_up(const Pose& pose) {
  const glm::dvec3 right = glm::cross(pose.forward, pose.up);
  const bool level = std::abs(right.y) <= 1e-6 * glm::length(right) && pose.up.y > 0.0;
  return level ? glm::dvec3(0.0, 1.0, 0.0) : pose.up;
}

void check_finite(const char* flag, const std::optional<glm::dvec3>& point) {
  if (point && !(std::isfinite(point->x) && std::isfinite(point->y) && std::isfinite(point->z)))
    throw UsageError(flag, "has a coordinate that is not finite", "give three numbers X,Y,Z");
}

void apply_request(const ViewRequest& request, const std::optional<glm::dvec3>& default_target, Pose& pose) {
  check_finite("--eye", request.eye);
  check_finite("--look-at", request.look_at);
  check_finite("--up", request.up);
  if (request.eye || request.look_at) pose.up = inherited_up(pose);
  if (request.eye) pose.position = *request.eye;
  const std::optional<glm::dvec3> target = request.look_at ? request.look_at
                                           : request.eye   ? default_target
                                                           : std::nullopt;
  if (target) {
    if (*target == pose.position)
      throw UsageError("--look-at", "is where the eye is, so that there is no direction to look in",
                       "move --eye or --look-at");
    pose.forward = *target - pose.position;
  }
  if (request.up) pose.up = *request.up;
  if (request.yfov) {
    pose.orthographic = false;
    pose.half_height = std::tan(0.5 * *request.yfov);
    pose.half_width = 0.0;
  }
}

// An image narrower than the camera was authored for shows more above and below instead of less at its sides.
double shown_half_height(const Pose& pose, double aspect) {
  const double needed = pose.half_width / aspect;
  return needed > (1.0 + kSameShape) * pose.half_height ? needed : pose.half_height;
}

} // namespace

bool is_framed(const Scene& scene, const ViewRequest& request) {
  return scene.cameras.empty() && request.camera.empty();
}

View resolve_view(const Scene& scene, const ViewRequest& request, std::uint32_t width, std::uint32_t height) {
  return resolve_view(scene, is_framed(scene, request) ? find_framing(scene) : Framing{}, request, width, height);
}

View resolve_view(const Scene& scene, const Framing& framing, const ViewRequest& request, std::uint32_t width,
                  std::uint32_t height) {
  const double aspect = static_cast<double>(width) / static_cast<double>(height);
  check_angle(request.yfov);
  Pose pose;
  std::optional<glm::dvec3> default_target; // without a camera, --eye looks at the centre of the scene
  if (is_framed(scene, request)) {
    pose = frame_scene(framing, request.yfov, aspect);
    default_target = framing.bounds.centre();
  } else {
    pose = pose_of(find_camera(scene, request.camera));
  }
  apply_request(request, default_target, pose);

  const glm::dvec3 forward = glm::normalize(pose.forward);
  const glm::dvec3 right = glm::cross(forward, glm::normalize(pose.up));
  // Negated, so that NaN from a zero vector is caught as well.
  if (!(glm::length(right) > 1e-9)) {
    const bool by_user = request.eye || request.look_at || request.up;
    if (by_user)
      throw UsageError("--up", "is parallel to the direction of view or zero", "give another --up, such as 0,0,1");
    throw Error(scene.path, "has a degenerate matrix on its camera",
                "repair the camera's node, or give --eye, --look-at and --up");
  }
  View view;
  view.orthographic = pose.orthographic;
  view.position = pose.position;
  view.forward = forward;
  const double half_height = shown_half_height(pose, aspect);
  view.right = glm::normalize(right) * (half_height * aspect);
  view.up = glm::cross(glm::normalize(right), forward) * half_height;
  return view;
}

} // namespace wavepath
