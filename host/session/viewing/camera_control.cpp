#include "host/session/viewing/camera_control.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

namespace wavepath {
namespace {

constexpr double kNearestPole = 0.02; // radians that the view keeps from straight up or down, where it has no right

glm::dvec3 turned(const glm::dvec3& v, double angle, const glm::dvec3& axis) {
  return glm::dvec3(glm::rotate(glm::dmat4(1.0), angle, axis) * glm::dvec4(v, 0.0));
}

// `direction` turned about `up`, then towards it, but never as far as the poles.
glm::dvec3 swing(const glm::dvec3& direction, const glm::dvec3& up, double about, double towards) {
  const glm::dvec3 axis = glm::normalize(up), level = turned(direction, about, axis);
  const double polar = std::acos(std::clamp(glm::dot(glm::normalize(level), axis), -1.0, 1.0));
  const double wanted = std::clamp(polar - towards, kNearestPole, glm::pi<double>() - kNearestPole);
  return turned(level, polar - wanted, glm::normalize(glm::cross(level, axis)));
}

} // namespace

CameraControl::CameraControl(const Scene& scene, const Framing& framing, const ViewRequest& initial)
    : framing_(framing), initial_(initial), request_(initial) {
  cameras_.path = scene.path;
  cameras_.cameras = scene.cameras;
}

double CameraControl::radius() const { return framing_.bounds.radius() > 0.0 ? framing_.bounds.radius() : 1.0; }

// Values that the request leaves open come from the resolved view: the target is as far away as the middle of the
// scene, and the up vector of a level camera is the world's.
CameraControl::Pose CameraControl::pose() const {
  const View now = view();
  Pose pose{now.position, now.position, glm::normalize(now.up)};
  const double along = glm::dot(framing_.bounds.centre() - now.position, now.forward);
  pose.target = request_.look_at.value_or(now.position + now.forward * std::max(along, 0.1 * radius()));
  const bool level =
      std::abs(now.right.y) <= 1e-6 * glm::length(now.right) && now.up.y > kNearestPole * glm::length(now.up);
  pose.up = request_.up.value_or(level ? glm::dvec3(0.0, 1.0, 0.0) : pose.up);
  return pose;
}

// Coordinates are kept where the picture can be computed: within the numbers that geometry may have.
void CameraControl::set(const Pose& pose) {
  if (!finite_point(pose.eye) || !finite_point(pose.target) || pose.eye == pose.target) return;
  request_.eye = pose.eye, request_.look_at = pose.target, request_.up = pose.up;
}

void CameraControl::orbit(double right, double down) {
  Pose p = pose();
  p.eye = p.target - swing(p.target - p.eye, p.up, -right, -down);
  set(p);
}

void CameraControl::look(double right, double down) {
  Pose p = pose();
  p.target = p.eye + swing(p.target - p.eye, p.up, -right, -down);
  set(p);
}

void CameraControl::pan(double right, double down) {
  Pose p = pose();
  const View now = view();
  const double distance = now.orthographic ? 1.0 : glm::length(p.target - p.eye);
  const glm::dvec3 move = 2.0 * distance * (down * now.up - right * glm::length(now.up) * glm::normalize(now.right));
  p.eye += move, p.target += move;
  set(p);
}

void CameraControl::dolly(double amount) {
  Pose p = pose();
  p.eye = p.target + (p.eye - p.target) * std::exp(-amount);
  set(p);
}

void CameraControl::fly(const glm::dvec3& right_up_forward) {
  Pose p = pose();
  const View now = view();
  const glm::dvec3 move = radius() * (right_up_forward.x * glm::normalize(now.right) +
                                      right_up_forward.y * glm::normalize(p.up) + right_up_forward.z * now.forward);
  p.eye += move, p.target += move;
  set(p);
}

bool CameraControl::focus(const glm::dvec3& point) {
  Pose p = pose();
  const glm::dvec3 towards = point - p.eye;
  if (!(glm::length(towards) > 1e-6 * radius())) return false;
  if (glm::length(glm::cross(glm::normalize(towards), glm::normalize(p.up))) < kNearestPole)
    p.up = glm::normalize(view().up);
  p.target = point;
  set(p);
  return true;
}

void CameraControl::see(const ViewRequest& request) {
  if (request.eye) request_.eye = request.eye;
  if (request.look_at) request_.look_at = request.look_at;
  if (request.up) request_.up = request.up;
  if (request.yfov) request_.yfov = request.yfov;
}

bool CameraControl::choose(std::size_t camera) {
  if (camera >= cameras_.cameras.size()) return false;
  const ViewRequest before = request_;
  request_.camera = std::to_string(camera);
  request_.eye = request_.look_at = request_.up = std::nullopt;
  // An angle is the file's, where it has one; parallel rays made perspective have that of the flag alone.
  const bool needs_angle = request_.projection == Projection::perspective && cameras_.cameras[camera].orthographic;
  request_.yfov = needs_angle ? initial_.yfov : std::nullopt;
  // A name goes before an index; where one camera is called by another's number, only its own name will do.
  for (const Camera& other : cameras_.cameras)
    if (other.name == request_.camera) request_.camera = cameras_.cameras[camera].name;
  try {
    view();
  } catch (...) {
    request_ = before;
    throw;
  }
  return true;
}

void CameraControl::frame_scene() {
  const View now = view();
  const double extent = std::min(glm::length(now.up), glm::length(now.right));
  // Panoramas see angles, and more than a sphere before the eye can fill: it is to be outside.
  constexpr double kWidest = glm::radians(60.0);
  const double half_angle = now.panorama == Panorama::none ? std::atan(extent) : std::min(extent, kWidest);
  Pose p = pose();
  const glm::dvec3 forward = glm::normalize(p.target - p.eye);
  p.target = framing_.bounds.centre();
  p.eye = p.target - forward * (radius() / std::sin(half_angle));
  set(p);
}

} // namespace wavepath
