// A scene that is seen at very different distances: a low camera looks along rows of posts on a long floor, under a
// sun.
#pragma once

#include "host/integrators/hybrid/shadows/views.h"
#include "tests/shadow_scene.h"

namespace wavepath::test {

inline Scene long_rows(const PunctualLight& light) {
  Scene scene;
  scene.path = "test";
  Material material = plain_material();
  material.double_sided = false;
  scene.materials.push_back(material);
  add_instance(scene, add_mesh(scene, rectangle({0, 0, -30}, {0, 0, 32}, {8, 0, 0})));
  std::vector<glm::vec3> posts;
  for (int i = 0; i < 24; ++i)
    for (int k = -4; k <= 4; ++k) {
      const glm::vec3 foot(1.3f * static_cast<float>(k) + 0.3f, 0.0f, -0.2f - 2.4f * static_cast<float>(i));
      for (const glm::vec3& p : box(foot + glm::vec3(0.0f, 0.4f, 0.0f), {0.12f, 0.4f, 0.12f})) posts.push_back(p);
    }
  add_instance(scene, add_mesh(scene, posts));
  Camera camera;
  camera.yfov = 0.9;
  const glm::dvec3 eye(0.0, 1.3, 1.5), forward = glm::normalize(glm::dvec3(0.0, -0.25, -1.0));
  const glm::dvec3 right(1, 0, 0), up = glm::cross(right, forward);
  camera.world_from_camera = {glm::dvec4(right, 0), glm::dvec4(up, 0), glm::dvec4(-forward, 0), glm::dvec4(eye, 1)};
  scene.cameras.push_back(camera);
  scene.lights.push_back(light);
  return scene;
}

// Twice as many pixels a side as other tests have.
inline RenderPlan long_settings(std::string_view technique, std::uint32_t map_size = 512) {
  RenderPlan settings = shadow_settings(technique, map_size);
  settings.width *= 2, settings.height *= 2;
  return settings;
}

// What techniques fit their views to, of that scene.
struct LongFit {
  View view;
  ShadowFit fit;
};
inline LongFit long_fit(std::uint32_t size) {
  LongFit of;
  const Scene scene = long_rows(sun());
  of.view = resolve_view(scene, {}, 96, 72);
  of.fit.lo = {-8, 0, -62};
  of.fit.hi = {8, 0.8, 2};
  of.fit.radius = 33;
  of.fit.nearest = 1e-28;
  of.fit.farthest = 200;
  of.fit.receivers = seen_corners(of.view, of.fit.lo, of.fit.hi, of.fit.nearest, of.fit.farthest);
  of.fit.size = size;
  of.fit.guard = 1.0;
  return of;
}

// Metres across a texel at a point on the floor, measured by stepping along it.
inline double texel_at(const gpu::ShadowView& view, std::uint32_t size, const glm::dvec3& p) {
  const auto place = [&](const glm::dvec3& at) {
    const glm::dvec4 q(at, 1.0);
    return glm::dvec2(glm::dot(glm::dvec4(view.x), q), glm::dot(glm::dvec4(view.y), q)) /
           glm::dot(glm::dvec4(view.w), q);
  };
  constexpr double kStep = 1e-3;
  const double along = glm::distance(place(p), place(p + glm::dvec3(0, 0, kStep))),
               across = glm::distance(place(p), place(p + glm::dvec3(kStep, 0, 0)));
  return 2.0 / size * kStep / std::min(along, across);
}

} // namespace wavepath::test
