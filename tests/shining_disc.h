// A shining disc in front of a camera: what the camera makes of it has exact answers.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "host/scene/staging/view.h"
#include "tests/scene_builder.h"

namespace wavepath::test {

inline constexpr double kPi = std::numbers::pi;
inline constexpr float kRadiance = 100.0f;
inline constexpr std::uint32_t kSide = 36;                  // pixels
inline constexpr double kHalfHeight = 0.5;                  // of the picture at unit distance, or in metres
inline constexpr double kScale = 0.5 * kSide / kHalfHeight; // pixels of a metre at unit distance

// A shining disc of radius `radius` across the view axis, `depth` metres away, and nothing else. Its centre is the
// middle of the picture.
inline Scene disc_scene(double depth, double radius) {
  constexpr int kCorners = 64;
  Scene scene;
  scene.path = "test";
  Material shining = plain_material();
  shining.base_color = glm::vec4(0.0f, 0.0f, 0.0f, 1.0f);
  shining.emission = glm::vec3(kRadiance);
  scene.materials = {shining};
  std::vector<glm::vec3> fan;
  const auto corner = [&](int i) {
    // As large as the disc: a polygon of the same area.
    const double angle = 2.0 * kPi / kCorners, r = radius * std::sqrt(angle / std::sin(angle));
    return glm::vec3(r * std::cos(i * angle), r * std::sin(i * angle), -depth);
  };
  for (int i = 0; i < kCorners; ++i) fan.insert(fan.end(), {glm::vec3(0, 0, -depth), corner(i), corner(i + 1)});
  add_instance(scene, add_mesh(scene, fan));
  return scene;
}

// At the origin, along -Z.
inline View view_along_z(bool orthographic) {
  View view;
  view.orthographic = orthographic;
  view.right = {kHalfHeight, 0.0, 0.0};
  view.up = {0.0, kHalfHeight, 0.0};
  return view;
}

} // namespace wavepath::test
