// Rooms for tests of the reuse of paths, in which neighbouring pixels see different things: a wall ends between the two
// columns of a quad, and blocks, lamps and panes stand before it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include "host/scene/scene.h"
#include "tests/scene_builder.h"

namespace wavepath::test {

inline Material tinted(Material material, const glm::vec3& tint) {
  material.base_color *= glm::vec4(tint, 1.0f);
  return material;
}

inline Material shining(const glm::vec3& emission) {
  Material lamp = plain_material();
  lamp.base_color = glm::vec4(0.0f, 0.0f, 0.0f, 1.0f);
  lamp.emission = emission;
  lamp.double_sided = false;
  return lamp;
}

inline std::uint32_t add_material(Scene& scene, const Material& material) {
  scene.materials.push_back(material);
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

// A parallelogram that faces cross(a, b), with texture coordinates and tangents for maps.
inline void add_wall(Scene& scene, const glm::vec3& corner, const glm::vec3& a, const glm::vec3& b,
                     std::uint32_t material) {
  const std::uint32_t index =
      add_mesh(scene, {corner, corner + a, corner + a + b, corner, corner + a + b, corner + b}, material);
  Mesh& mesh = scene.meshes[index];
  mesh.uvs[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
  mesh.tangents.assign(6, glm::vec4(glm::normalize(a), 1.0f));
  mesh.normals.assign(6, glm::vec3(0.0f)); // flat
  add_instance(scene, index);
}

// Its walls face outwards, or inwards.
inline void add_box(Scene& scene, const glm::vec3& low, const glm::vec3& high, std::uint32_t material,
                    bool inwards = false, std::uint32_t left = kNoIndex, std::uint32_t right = kNoIndex) {
  for (int axis = 0; axis < 3; ++axis)
    for (const bool top : {false, true}) {
      glm::vec3 corner = low, a(0.0f), b(0.0f);
      const int next = (axis + 1) % 3, last = (axis + 2) % 3;
      corner[axis] = top ? high[axis] : low[axis];
      a[next] = high[next] - low[next], b[last] = high[last] - low[last];
      if (top == inwards) std::swap(a, b);
      const std::uint32_t own = axis != 0 || left == kNoIndex ? material : top ? right : left;
      add_wall(scene, corner, a, b, own);
    }
}

// A ball of few triangles with the normals of a sphere.
inline void add_coarse_ball(Scene& scene, const glm::vec3& middle, float radius, std::uint32_t material) {
  constexpr std::uint32_t kRings = 4, kSegments = 6;
  const auto corner = [&](std::uint32_t ring, std::uint32_t segment) {
    const float theta = std::numbers::pi_v<float> * static_cast<float>(ring) / kRings;
    const float phi = 2.0f * std::numbers::pi_v<float> * static_cast<float>(segment) / kSegments;
    return glm::vec3(std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi));
  };
  std::vector<glm::vec3> normals, corners;
  for (std::uint32_t i = 0; i < kRings; ++i)
    for (std::uint32_t j = 0; j < kSegments; ++j) {
      const glm::vec3 a = corner(i, j), b = corner(i + 1, j), c = corner(i + 1, j + 1), d = corner(i, j + 1);
      if (i + 1 < kRings) normals.insert(normals.end(), {a, b, c});
      if (i > 0) normals.insert(normals.end(), {a, c, d});
    }
  for (const glm::vec3& normal : normals) corners.push_back(middle + radius * normal);
  const std::uint32_t mesh = add_mesh(scene, corners, material);
  scene.meshes[mesh].normals = normals;
  scene.meshes[mesh].primitives[0].has_normals = true;
  add_instance(scene, mesh);
}

// Closed, 4 wide and 2 high, of one material in three colours, with a lamp below the ceiling of its left half. A wall
// parts the back of it, whose edge a camera in the middle sees between two columns of pixels.
inline Scene parted_room(const Material& material) {
  Scene scene;
  scene.path = "parted room";
  scene.materials = {tinted(material, {1.6f, 1.6f, 1.6f}), tinted(material, {1.5f, 0.5f, 0.3f}),
                     tinted(material, {0.4f, 1.4f, 0.6f}), shining({9.0f, 8.0f, 6.0f})};
  add_box(scene, {-2, -1, -2}, {2, 1, 2}, 0, true, 1, 2);
  add_box(scene, {-0.06f, -1, -2}, {0.06f, 1, 0.2f}, 0);
  add_box(scene, {0.7f, -1, -1.2f}, {1.3f, -0.2f, -0.5f}, 1);
  add_wall(scene, {-1.4f, 0.9f, -1.2f}, {0.8f, 0, 0}, {0, 0, 0.8f}, 3); // faces down
  return scene;
}

// The same with its lamp where a camera at its front wall does not see it: edges of lamps are noise of their own.
inline Scene room_of_hidden_lamp(const Material& material) {
  Scene scene = parted_room(material);
  scene.instances.back().world_from_object = glm::translate(glm::dmat4(1.0), glm::dvec3(0.0, 0.0, 2.3));
  return scene;
}

// Four floats a texel.
inline TextureSlot add_image(Scene& scene, std::uint32_t side, const std::vector<glm::vec4>& texels) {
  Image image;
  image.name = "image " + std::to_string(scene.images.size());
  image.width = image.height = side;
  for (const glm::vec4& texel : texels)
    for (int c = 0; c < 4; ++c)
      image.bytes.push_back(static_cast<std::uint8_t>(std::lround(255.0f * std::min(texel[c], 1.0f))));
  scene.images.push_back(image);
  TextureSlot slot;
  slot.image = static_cast<std::uint32_t>(scene.images.size() - 1);
  slot.nearest = true;
  return slot;
}

// Normals that lean by up to so many radians.
inline TextureSlot add_bumps(Scene& scene, double steepest) {
  constexpr std::uint32_t kSide = 8;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<glm::vec4> texels;
  for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
    const double tilt = steepest * std::sqrt(unit(random)), around = 2.0 * std::numbers::pi * unit(random);
    const glm::vec3 normal(std::sin(tilt) * std::cos(around), std::sin(tilt) * std::sin(around), std::cos(tilt));
    texels.emplace_back(0.5f + 0.5f * normal, 1.0f);
  }
  return add_image(scene, kSide, texels);
}

} // namespace wavepath::test
