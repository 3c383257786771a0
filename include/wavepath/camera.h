// A camera: where it is, where it looks, and how directions become pixels.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include <wavepath/export.h>
#include <wavepath/settings.h>

namespace wavepath_v0 {

using Point = std::array<double, 3>;
using Matrix3 = std::array<std::array<double, 3>, 3>; // rows of columns
using Matrix4 = std::array<std::array<double, 4>, 4>; // rows of columns; the last row is 0, 0, 0, 1

// Axes of a camera. opengl: x right, y up, looks along -z (also Blender's and glTF's). opencv: x right, y down, looks
// along z.
enum class AxesOfCamera { opengl, opencv };

// What is left out comes from the scene's camera. Lengths are metres, angles degrees.
struct WAVEPATH_API Camera {
  std::string name; // of a camera of the file, or its index; empty = the first one
  std::optional<Point> eye, look_at, up;
  std::optional<double> yfov;
  // Focal lengths and principal point in pixels, from the top left corner of the picture.
  std::optional<std::array<double, 4>> intrinsics;
  // Further flags of a camera: projection, fov, shift, clip, stereo, aperture, focus, ...
  Settings others;

  // The camera with this pose. `k`: its matrix of intrinsics; empty = the field of view of the scene's camera. Throws
  // Error if the matrix is not finite, no rigid motion, or mirrors, or `k` is skewed.
  static Camera from_matrix(const Matrix4& world_from_camera, const std::optional<Matrix3>& k = {},
                            AxesOfCamera axes = AxesOfCamera::opengl);

  Settings settings() const;
};

} // namespace wavepath_v0
