#include "host/convert/described.h"

#include <cmath>

namespace wavepath::convert {

void place_camera(Description& description, Camera camera, const glm::dmat4& world_from_camera,
                  const glm::dmat4& camera_from_gltf) {
  glm::dmat4 matrix = world_from_camera * camera_from_gltf;
  // A camera must not mirror, so that a world whose camera does is mirrored instead.
  if (glm::determinant(glm::dmat3(matrix)) < 0.0) {
    description.root = glm::dmat4(1.0);
    description.root[2][2] = -1.0;
    matrix = description.root * matrix;
  }
  for (int axis = 0; axis < 3; ++axis) matrix[axis] = glm::dvec4(glm::normalize(glm::dvec3(matrix[axis])), 0.0);
  camera.world_from_camera = matrix;
  description.camera = camera;
}

} // namespace wavepath::convert
