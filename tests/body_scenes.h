// Scenes by chance, from a seed: bodies that nest, touch, overlap or stand apart, thick and thin, clear and absorbing,
// smooth and rough, with cameras and lamps in and out of them. For tests that compare integrators on scenes that nobody
// chose.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/bidirectional_scene.h"

namespace wavepath::test {

struct Dice {
  std::uint32_t state;
  double next() { // in [0, 1)
    state = state * 747796405u + 2891336453u;
    const std::uint32_t word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return static_cast<double>((word >> 22u) ^ word) * 0x1p-32;
  }
  double between(double lo, double hi) { return lo + (hi - lo) * next(); }
  bool one_in(double n) { return next() * n < 1.0; }
  int below(int n) { return static_cast<int>(next() * n); }
  glm::dvec3 point(double reach) { return {between(-reach, reach), between(-reach, reach), between(-reach, reach)}; }
};

struct BodyScene {
  Scene scene;
  bool punctual = false; // lamps that nothing meets by chance; then no surface is smooth, so that path finds all light
  bool nested = false;   // boxes of bodies may meet
  double aperture = 0.0;
};

// The unit cube about the origin, or a ball in it.
inline std::vector<glm::vec3> unit_body(bool ball) {
  std::vector<glm::vec3> all;
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-0.5f, 0.5f}) {
      constexpr int kCuts = 4;
      const int cuts = ball ? kCuts : 1, u = (axis + 1) % 3, v = (axis + 2) % 3;
      for (int i = 0; i < cuts; ++i)
        for (int k = 0; k < cuts; ++k) {
          glm::vec3 corners[4];
          for (int c = 0; c < 4; ++c) {
            const int du = (c == 1 || c == 2) == (side > 0.0f) ? 1 : 0, dv = c >= 2 ? 1 : 0;
            corners[c][axis] = side;
            corners[c][u] = static_cast<float>(i + du) / static_cast<float>(cuts) - 0.5f;
            corners[c][v] = static_cast<float>(k + dv) / static_cast<float>(cuts) - 0.5f;
            if (ball) corners[c] = 0.5f * glm::normalize(corners[c]);
          }
          for (const glm::vec3& p : quad(corners[0], corners[1], corners[2], corners[3])) all.push_back(p);
        }
    }
  return all;
}

inline glm::dmat4 placed(const glm::dvec3& centre, const glm::dvec3& size) {
  glm::dmat4 m(1.0);
  for (int i = 0; i < 3; ++i) m[i][i] = size[i];
  m[3] = glm::dvec4(centre, 1.0);
  return m;
}

inline BodyScene body_scene_of(std::uint32_t seed) {
  Dice dice{seed * 2654435761u + 1u};
  dice.next();
  BodyScene made;
  Scene& scene = made.scene;
  scene.path = "test";
  made.punctual = dice.one_in(2);
  const auto add_material = [&](const Material& m) {
    scene.materials.push_back(m);
    return static_cast<std::uint32_t>(scene.materials.size() - 1);
  };
  // A room without a roof and front: floor and two walls, larger than all bodies.
  const std::uint32_t grey = add_material(plain_material());
  Material gloss = plain_material();
  gloss.metallic = 1.0f, gloss.roughness = 0.6f;
  const std::uint32_t metal = add_material(gloss);
  add_instance(scene, add_mesh(scene, quad({-4, -1.6f, 4}, {4, -1.6f, 4}, {4, -1.6f, -3}, {-4, -1.6f, -3}), grey));
  add_instance(scene, add_mesh(scene, quad({-4, -1.6f, -3}, {4, -1.6f, -3}, {4, 4, -3}, {-4, 4, -3}),
                               dice.one_in(3) ? metal : grey));
  add_instance(scene, add_mesh(scene, quad({-4, -1.6f, 4}, {-4, -1.6f, -3}, {-4, 4, -3}, {-4, 4, 4}), grey));

  const auto body_material = [&](bool thin) {
    Material m = plain_material();
    m.base_color = glm::vec4(1.0f), m.specular = 1.0f;
    m.transmission = 1.0f;
    m.volume = !thin;
    const float iors[] = {1.0f, 1.1f, 1.33f, 1.5f};
    m.ior = iors[dice.below(4)];
    const bool rough = made.punctual || dice.one_in(3);
    m.roughness = rough ? static_cast<float>(dice.between(0.35, 0.7)) : 0.0f;
    if (made.punctual) m.ior = std::max(m.ior, 1.1f); // rough surfaces of ior 1 are smooth
    if (!thin && !dice.one_in(4))
      m.attenuation = glm::vec3(dice.between(0.0, 1.0), dice.between(0.0, 0.6), dice.between(0.1, 1.5));
    if (dice.one_in(5)) m.transmission = 0.7f;
    return m;
  };
  const std::uint32_t meshes[] = {add_mesh(scene, unit_body(false)), add_mesh(scene, unit_body(true))};
  const auto add_body = [&](const Material& material, glm::dmat4 place, bool ball) {
    if (dice.one_in(4)) place = place * placed({}, {-1, 1, 1}); // mirrored
    if (dice.one_in(4)) place[1] += 0.3 * place[0];             // sheared
    Mesh mesh = scene.meshes[meshes[ball ? 1 : 0]];
    mesh.primitives[0].material = add_material(material);
    scene.meshes.push_back(mesh);
    add_instance(scene, static_cast<std::uint32_t>(scene.meshes.size() - 1), place);
  };
  const glm::dvec3 large{dice.between(2.0, 3.4), dice.between(2.0, 3.0), dice.between(2.0, 3.4)};
  const glm::dvec3 middle = 0.2 * dice.point(1.0);
  const int layout = dice.below(5); // one, apart, nested, touching, overlapping
  add_body(body_material(false), placed(middle, large), dice.one_in(3));
  if (layout > 0) {
    glm::dvec3 size = glm::dvec3(dice.between(0.4, 0.9)), at = middle + 0.25 * dice.point(1.0) * large;
    if (layout == 1) at = middle + glm::dvec3(0.9 * large.x + size.x, 0.0, 0.3);
    if (layout == 3) at = middle + glm::dvec3(0.5 * (large.x + size.x), 0.1, 0.2);
    if (layout == 4) at = middle + glm::dvec3(0.5 * large.x, 0.2, 0.1);
    add_body(body_material(false), placed(at, size), dice.one_in(2));
    if (dice.one_in(3)) add_body(body_material(false), placed(at, 0.5 * size), true);
  }
  made.nested = layout > 1;
  if (dice.one_in(4)) // a pane
    add_instance(scene, add_mesh(scene, quad({-1, -1.6f, 1.9f}, {2, -1.6f, 1.8f}, {2, 1, 1.8f}, {-1, 1, 1.9f}),
                                 add_material(body_material(true))));
  // Something that is no body within the first one, and something outside.
  add_box(scene, glm::vec3(middle) + glm::vec3(-0.5f, -0.7f, -0.6f), glm::vec3(middle) + glm::vec3(0.1f, -0.4f, 0.1f),
          grey);
  add_box(scene, {1.5f, -1.6f, 1.9f}, {2.2f, -0.9f, 2.5f}, grey);

  const auto place_of_lamp = [&](bool inside) {
    return inside ? middle + 0.3 * dice.point(1.0) * large
                  : glm::dvec3(dice.between(-2, 2), dice.between(1.9, 2.8), 2.2);
  };
  const int lamps = 1 + dice.below(2);
  for (int i = 0; i < lamps; ++i) {
    const bool inside = dice.one_in(2);
    const glm::dvec3 at = place_of_lamp(inside);
    if (made.punctual) {
      PunctualLight light;
      light.kind = dice.one_in(3)              ? LightKind::spot
                   : !inside && dice.one_in(2) ? LightKind::directional
                                               : LightKind::point;
      light.intensity = light.kind == LightKind::directional ? glm::vec3(2.0f) : glm::vec3(4.0f, 3.0f, 5.0f);
      light.position = at;
      light.direction = glm::normalize(glm::dvec3(dice.between(-0.4, 0.4), -1.0, dice.between(-0.6, 0.2)));
      light.outer_cone = 1.2;
      scene.lights.push_back(light);
    } else {
      Material shining = plain_material();
      shining.double_sided = dice.one_in(2);
      shining.emission = glm::vec3(3.0f, 4.0f, 5.0f);
      const float half = inside ? 0.35f : 1.0f; // large, for what only chance finds
      const glm::vec3 c(at);
      add_instance(scene, add_mesh(scene,
                                   quad(c + glm::vec3(-half, 0, -half), c + glm::vec3(half, 0.1f, -half),
                                        c + glm::vec3(half, 0.1f, half), c + glm::vec3(-half, 0, half)),
                                   add_material(shining)));
    }
  }
  if (dice.one_in(made.punctual ? 4 : 2)) {
    if (dice.one_in(2))
      add_sky(scene);
    else
      scene.environment.radiance = glm::vec3(0.4f, 0.5f, 0.6f);
  }
  const bool outside = dice.one_in(2), orthographic = outside && dice.one_in(3); // its rays must begin in one body, too
  const glm::dvec3 eye = outside ? glm::dvec3(dice.between(-1, 2), dice.between(0, 1.2), dice.between(2.9, 3.6))
                                 : middle + 0.4 * large * glm::dvec3(dice.between(0.2, 0.9), dice.between(0, 0.8), 0.9);
  scene.cameras.push_back(camera_at(eye, orthographic));
  scene.cameras.back().yfov = 1.0;
  if (dice.one_in(4)) made.aperture = 0.1;
  return made;
}

} // namespace wavepath::test
