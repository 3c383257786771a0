// Chooses a camera, overrides parts of it, or frames the scene; see view.h.
#include "host/scene/staging/view.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

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
  Clip clip{};              // of the file
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
  pose.clip.near = camera.znear.value_or(0.0);
  if (camera.zfar) pose.clip.far = *camera.zfar;
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

[[noreturn]] void refuse_beside(const char* flag, const char* other) {
  throw UsageError(flag, fmt::format("does not go with {}", other), "leave out one of them");
}

void check_only(bool given, const char* flag, bool fits, const char* projection) {
  if (given && !fits)
    throw UsageError(flag, fmt::format("belongs to --projection {}", projection), "leave it out, or give that");
}

// What an eye of a stereo pair has of the picture, or all of it.
glm::uvec2 eye_size(bool stereo, bool stacked, std::uint32_t width, std::uint32_t height) {
  if (!stereo) return {width, height};
  return stacked ? glm::uvec2{width, std::max(height / 2, 1u)} : glm::uvec2{std::max(width / 2, 1u), height};
}

// Half of the picture in pixels over pixels of a unit; and where that puts the axis.
void apply_intrinsics(const Intrinsics& k, const glm::dvec2& size, glm::dvec2& half, View& view) {
  half = 0.5 * size / glm::dvec2(k.fx, k.fy);
  view.shift = {1.0 - 2.0 * k.cx / size.x, 2.0 * k.cy / size.y - 1.0};
}

// A camera of the requested projection that shows what the pose does, as far as it can: half extents of its picture.
glm::dvec2 half_extents(const ViewRequest& request, Projection projection, const Pose& pose, const glm::dvec2& size,
                        double half_height, double distance) {
  const double aspect = size.x / size.y;
  switch (projection) {
    case Projection::fisheye:
      return 0.5 * request.fov.value_or(std::numbers::pi) * size / std::min(size.x, size.y);
    case Projection::equirectangular:
      return {std::numbers::pi, 0.5 * std::numbers::pi};
    case Projection::orthographic:
      if (request.ymag) return {*request.ymag * aspect, *request.ymag};
      if (!pose.orthographic) half_height *= distance;
      break;
    case Projection::perspective:
      break;
  }
  return {half_height * aspect, half_height};
}

// A direction for an eye that moves with this velocity; with the opposite one the way back. Moeller, "The Theory of
// Relativity", section 2.8, for light that arrives.
glm::dvec3 aberrated(const glm::dvec3& direction, const glm::dvec3& velocity) {
  const glm::dvec3 n = glm::normalize(direction);
  const double gamma = 1.0 / std::sqrt(1.0 - glm::dot(velocity, velocity)), along = glm::dot(velocity, n);
  return glm::normalize(n + velocity * (gamma + gamma * gamma / (gamma + 1.0) * along));
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

bool ray_at_rest(const View& view, const glm::dvec2& position, glm::dvec3& origin, glm::dvec3& direction) {
  const glm::dvec2 at = position + view.shift;
  origin = view.position;
  const glm::dvec3 aside = at.x * view.right + at.y * view.up;
  if (view.panorama == Panorama::fisheye) {
    const double angle = glm::length(aside);
    direction = view.forward;
    if (angle > 0.0) direction = std::cos(angle) * view.forward + std::sin(angle) / angle * aside;
    return angle <= view.angle_limit;
  }
  if (view.panorama == Panorama::sphere) {
    const double azimuth = at.x * glm::length(view.right), elevation = at.y * glm::length(view.up);
    direction =
        std::cos(elevation) * (std::cos(azimuth) * view.forward + std::sin(azimuth) * glm::normalize(view.right)) +
        std::sin(elevation) * glm::normalize(view.up);
    return true;
  }
  if (view.orthographic) origin += aside;
  direction = view.orthographic ? view.forward : view.forward + aside;
  return true;
}

bool project_at_rest(const View& view, const glm::dvec4& point, int eye, glm::dvec2& position) {
  const double half_width = glm::length(view.right), half_height = glm::length(view.up);
  const glm::dvec3 right = view.right / half_width, up = view.up / half_height;
  const double aside = 0.5 * view.eye_distance * eye;
  glm::dvec3 offset = glm::dvec3(point) - point.w * view.position;
  if (view.panorama != Panorama::sphere) offset -= point.w * aside * right;
  const double across = glm::dot(offset, right), above = glm::dot(offset, up), ahead = glm::dot(offset, view.forward);
  const glm::dvec2 half(half_width, half_height);
  position = glm::dvec2(0.0);
  if (view.panorama == Panorama::fisheye) {
    const double sine = std::hypot(across, above), angle = std::atan2(sine, ahead);
    if (sine > 0.0) position = angle / sine * glm::dvec2(across, above) / half;
    position -= view.shift;
    return sine > 0.0 || ahead > 0.0;
  }
  if (view.panorama == Panorama::sphere) {
    const double reach = std::sqrt(across * across + ahead * ahead - point.w * aside * aside);
    if (!(reach >= 0.0)) return false; // within the circle that the rays touch
    const double turned = point.w * aside != 0.0 ? std::atan2(aside, reach) : 0.0;
    position = glm::dvec2(std::atan2(across, ahead) - turned, std::atan2(above, reach)) / half;
    if (position.x < -1.0) position.x += 2.0;
    return true;
  }
  if (view.orthographic && point.w == 0.0) // the one direction that it looks in, which all of the picture shows
    return ahead > 0.0 && std::hypot(across, above) < 1e-9 * ahead;
  position = glm::dvec2(across, above) / half / (view.orthographic ? 1.0 : ahead) - view.shift;
  return ahead > 0.0;
}

} // namespace

bool has_camera_model(const View& view) {
  return view.panorama != Panorama::none || view.shift != glm::dvec2(0.0) || view.clip != Clip{} ||
         view.eye_distance != 0.0 || view.velocity != glm::dvec3(0.0);
}

bool is_rasterizable(const View& view) {
  return view.panorama == Panorama::none && view.eye_distance == 0.0 && view.velocity == glm::dvec3(0.0);
}

bool stacks_eyes(Panorama panorama) { return panorama == Panorama::sphere; }

bool ray_through(const View& view, const glm::dvec2& position, glm::dvec3& origin, glm::dvec3& direction) {
  const bool sees = ray_at_rest(view, position, origin, direction);
  if (view.velocity != glm::dvec3(0.0)) direction = aberrated(direction, -view.velocity);
  return sees;
}

std::optional<Intrinsics> intrinsics_of(const View& view, std::uint32_t width, std::uint32_t height) {
  if (view.panorama == Panorama::sphere) return std::nullopt;
  const glm::dvec2 size(eye_size(view.eye_distance != 0.0, false, width, height));
  return Intrinsics{0.5 * size.x / glm::length(view.right), 0.5 * size.y / glm::length(view.up),
                    0.5 * size.x * (1.0 - view.shift.x), 0.5 * size.y * (1.0 + view.shift.y)};
}

std::optional<glm::dvec2> angles_of(const View& view) {
  const glm::dvec2 half(glm::length(view.right), glm::length(view.up));
  if (view.orthographic) return std::nullopt;
  if (view.panorama != Panorama::none) return glm::min(2.0 * half, glm::dvec2(2.0 * view.angle_limit));
  return glm::atan(half * (1.0 + view.shift)) + glm::atan(half * (1.0 - view.shift));
}

bool project(const View& view, const glm::dvec4& point, int eye, glm::dvec2& position) {
  const glm::dvec3 offset = glm::dvec3(point) - point.w * view.position;
  if (view.velocity == glm::dvec3(0.0) || offset == glm::dvec3(0.0)) return project_at_rest(view, point, eye, position);
  const glm::dvec3 seen = glm::length(offset) * aberrated(offset, view.velocity);
  return project_at_rest(view, glm::dvec4(point.w * view.position + seen, point.w), eye, position);
}

bool is_framed(const Scene& scene, const ViewRequest& request) {
  return scene.cameras.empty() && request.camera.empty();
}

bool needs_framing(const Scene& scene, const ViewRequest& request) {
  return is_framed(scene, request) || (request.projection == Projection::orthographic && !request.ymag);
}

void check_view(const ViewRequest& request) {
  check_angle(request.yfov);
  const std::optional<Projection>& projection = request.projection;
  check_only(request.fov.has_value(), "--fov", projection == Projection::fisheye, "fisheye");
  check_only(request.yfov.has_value(), "--yfov",
             projection.value_or(Projection::perspective) == Projection::perspective, "perspective");
  check_only(request.ymag.has_value(), "--ymag",
             !request.yfov && projection.value_or(Projection::orthographic) == Projection::orthographic,
             "orthographic");
  if (request.intrinsics)
    for (const auto& [given, flag] : {std::pair{request.yfov.has_value(), "--yfov"},
                                      {request.fov.has_value(), "--fov"},
                                      {request.ymag.has_value(), "--ymag"},
                                      {request.shift.has_value(), "--shift"}})
      if (given) refuse_beside("--intrinsics", flag);
  if (projection == Projection::equirectangular && (request.shift || request.intrinsics))
    throw UsageError(request.shift ? "--shift" : "--intrinsics",
                     "has no meaning where the picture shows all directions",
                     "leave it out, or turn the camera by --look-at");
  if (request.stereo != 0.0 && request.velocity != glm::dvec3(0.0)) refuse_beside("--velocity", "--stereo");
  if (request.stereo != 0.0 && projection == Projection::orthographic)
    throw UsageError("--stereo", "would show both eyes the same by parallel rays", "use another --projection");
}

View resolve_view(const Scene& scene, const ViewRequest& request, std::uint32_t width, std::uint32_t height) {
  return resolve_view(scene, needs_framing(scene, request) ? find_framing(scene) : Framing{}, request, width, height);
}

View resolve_view(const Scene& scene, const Framing& framing, const ViewRequest& request, std::uint32_t width,
                  std::uint32_t height) {
  check_view(request);
  const glm::dvec2 size(
      eye_size(request.stereo != 0.0, request.projection == Projection::equirectangular, width, height));
  const double aspect = size.x / size.y;
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
  const Projection projection =
      request.projection.value_or(pose.orthographic ? Projection::orthographic : Projection::perspective);
  if (projection == Projection::perspective && pose.orthographic && !request.intrinsics)
    throw UsageError("--projection perspective", "does not know how wide to look, as the chosen camera is orthographic",
                     "give --yfov as well");
  if (request.clips_as_file && is_framed(scene, request))
    throw UsageError("--clip file", "has no camera to take the planes from", "write --clip NEAR,FAR");
  check_only(request.ymag.has_value(), "--ymag", projection == Projection::orthographic, "orthographic");
  check_only(request.stereo != 0.0, "--stereo", projection != Projection::orthographic, "perspective");
  if (request.velocity != glm::dvec3(0.0) && projection == Projection::orthographic)
    throw UsageError("--velocity", "is that of an eye, which parallel rays have not",
                     "use --projection perspective, fisheye or equirectangular");
  View view;
  view.velocity = request.velocity;
  view.orthographic = projection == Projection::orthographic;
  if (projection == Projection::fisheye) view.panorama = Panorama::fisheye;
  if (projection == Projection::equirectangular) view.panorama = Panorama::sphere;
  view.position = pose.position;
  view.forward = forward;
  view.eye_distance = request.stereo;
  view.clip = request.clips_as_file ? pose.clip : request.clip.value_or(Clip{});
  if (!(view.clip.near >= 0.0 && view.clip.near < view.clip.far))
    throw Error(scene.path, "has a camera whose znear and zfar leave nothing between them", "write --clip NEAR,FAR");
  const glm::dvec3 target =
      request.look_at.value_or(framing.bounds.empty() ? pose.position + forward : framing.bounds.centre());
  const double ahead = glm::dot(target - pose.position, forward);
  const double distance = ahead > 0.0 ? ahead : std::max(framing.bounds.radius(), 1e-3);
  glm::dvec2 half = half_extents(request, projection, pose, size, shown_half_height(pose, aspect), distance);
  if (projection == Projection::fisheye && !request.intrinsics)
    view.angle_limit = 0.5 * request.fov.value_or(std::numbers::pi);
  if (request.shift) view.shift = 2.0 * *request.shift;
  if (request.intrinsics) apply_intrinsics(*request.intrinsics, size, half, view);
  view.right = glm::normalize(right) * half.x;
  view.up = glm::cross(glm::normalize(right), forward) * half.y;
  if (view.orthographic) { // parallel rays are shifted with their camera
    view.position += view.shift.x * view.right + view.shift.y * view.up;
    view.shift = glm::dvec2(0.0);
  }
  return view;
}

} // namespace wavepath
