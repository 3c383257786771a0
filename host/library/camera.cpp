// Cameras of the interface: poses and intrinsics to flags.
#include <wavepath/camera.h>

#include <array>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <wavepath/error.h>
#include <glm/glm.hpp>

#include "host/library/guard.h"

namespace wavepath_v0 {
namespace {

constexpr double kRigid = 1e-4; // deviation of axes from unit length and right angles, as of matrices of floats

glm::dvec3 column(const Matrix4& matrix, std::size_t c) { return {matrix[0][c], matrix[1][c], matrix[2][c]}; }
Point point(const glm::dvec3& p) { return {p.x, p.y, p.z}; }

void check_pose(const Matrix4& matrix) {
  const auto refuse = [](const char* problem, const char* remedy) {
    throw UsageError("world_from_camera", problem, remedy);
  };
  for (const auto& row : matrix)
    for (const double value : row)
      if (!std::isfinite(value)) refuse("holds a value that is not finite", "give a matrix of numbers");
  if (matrix[3] != std::array<double, 4>{0.0, 0.0, 0.0, 1.0})
    refuse("has another last row than 0, 0, 0, 1", "give the matrix by rows: its last column is the position");
  const glm::dvec3 x = column(matrix, 0), y = column(matrix, 1), z = column(matrix, 2);
  const bool unit = std::abs(glm::length(x) - 1.0) < kRigid && std::abs(glm::length(y) - 1.0) < kRigid &&
                    std::abs(glm::length(z) - 1.0) < kRigid;
  const bool right =
      std::abs(glm::dot(x, y)) < kRigid && std::abs(glm::dot(y, z)) < kRigid && std::abs(glm::dot(z, x)) < kRigid;
  if (!unit || !right) refuse("scales or shears", "give a rotation and a position alone");
  if (glm::dot(glm::cross(x, y), z) < 0.0) refuse("mirrors", "give a right-handed rotation");
}

std::array<double, 4> intrinsics_of(const Matrix3& k) {
  const auto refuse = [](const char* problem, const char* remedy) { throw UsageError("K", problem, remedy); };
  for (const auto& row : k)
    for (const double value : row)
      if (!std::isfinite(value)) refuse("holds a value that is not finite", "give a matrix of numbers");
  if (k[2] != std::array<double, 3>{0.0, 0.0, 1.0}) refuse("has another last row than 0, 0, 1", "scale it");
  if (k[0][1] != 0.0 || k[1][0] != 0.0) refuse("is skewed", "give square or rectangular pixels");
  return {k[0][0], k[1][1], k[0][2], k[1][2]};
}

} // namespace

Camera Camera::from_matrix(const Matrix4& world_from_camera, const std::optional<Matrix3>& k, AxesOfCamera axes) {
  return wavepath::guarded([&] {
    check_pose(world_from_camera);
    const double sign = axes == AxesOfCamera::opengl ? 1.0 : -1.0;
    const glm::dvec3 position = column(world_from_camera, 3);
    Camera camera;
    camera.eye = point(position);
    camera.look_at = point(position - sign * column(world_from_camera, 2));
    camera.up = point(sign * column(world_from_camera, 1));
    if (k) camera.intrinsics = intrinsics_of(*k);
    return camera;
  });
}

Settings Camera::settings() const {
  Settings settings;
  if (!name.empty()) settings.set("camera", name);
  if (eye) settings.set("eye", *eye);
  if (look_at) settings.set("look-at", *look_at);
  if (up) settings.set("up", *up);
  if (yfov) settings.set("yfov", *yfov);
  if (intrinsics) settings.set("intrinsics", *intrinsics);
  return settings.add(others);
}

} // namespace wavepath_v0
