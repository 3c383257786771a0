// Cases of small things beside huge triangles: boxes that stand on large floors, and grounds close to the eye.
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/selftest/props.h"
#include "host/selftest/scenes.h"
#include "host/selftest/selftest.h"
#include "host/selftest/studio.h"

namespace wavepath {
namespace {

// Turned about two axes, so that no coordinate of a plane is exact.
glm::dmat4 tilted(double degrees) {
  const double angle = glm::radians(degrees);
  return glm::rotate(glm::rotate(glm::dmat4(1.0), angle, glm::dvec3(0, 0, 1)), 0.7 * angle, glm::dvec3(1, 0, 0));
}

// The scene as it is, turned and moved whole.
Scene posed(Scene scene, const glm::dmat4& transform) {
  for (Instance& instance : scene.instances) instance.world_from_object = transform * instance.world_from_object;
  for (Camera& camera : scene.cameras) camera.world_from_camera = transform * camera.world_from_camera;
  return scene;
}

// A closed box of a metre that reaches 2.5 cm below a floor, from inside, under a white sky.
Scene closed_box(float half) {
  Scene scene;
  const std::uint32_t grey = add_lambert(scene, glm::vec3(0.7f));
  add_triangles(scene, floor_quad(half), grey);
  add_triangles(scene, box({-0.5f, -0.025f, -0.5f}, {0.5f, 1.0f, 0.5f}), grey);
  scene.environment.radiance = glm::vec3(1.0f);
  look_at(scene, {0.0, 0.3, 0.35}, {0.0, 0.3, 0.0}, 1.2);
  return scene;
}

Measurement box_on_floor(const SelftestContext& context) {
  Studio studio(context);
  Worst worst;
  const RenderPlan settings = square(context.full ? 64 : 32, context.full ? 64 : 16, 8);
  for (const double degrees : {0.0, 33.0})
    for (const float half : {0.5f, 1e2f, 1e4f, 1e7f}) {
      const Estimate leak = studio.measure(posed(closed_box(half), tilted(degrees)), settings, 1);
      worst.add(leak.mean, 0.0, 1e-5,
                fmt::format("sky within a box on a floor of {:g} m, tilted by {} degrees", half, degrees));
    }
  return worst.judge();
}

// Every pixel shows a ground of albedo 1/2 under a white sky: the light of one bounce is 1/2.
void judge_ground(const SelftestContext& context, const Scene& scene, const std::string& label, double tolerance,
                  Studio& studio, Worst& worst) {
  const RenderPlan settings = square(context.full ? 64 : 32, 4, 2);
  const Estimate ground = studio.measure(scene, settings, 1);
  worst.add(ground.smallest, 0.5, tolerance, "darkest pixel of " + label);
  worst.add(ground.largest, 0.5, tolerance, "brightest pixel of " + label);
}

Measurement ground_under_eye(const SelftestContext& context) {
  Studio studio(context);
  Worst worst;
  for (const double degrees : {0.0, 10.0, 33.0, 71.0})
    for (const double half : {1e1, 1e4, 1e6, 1e7}) {
      Scene scene;
      add_triangles(scene, floor_quad(static_cast<float>(half)), add_lambert(scene, glm::vec3(0.5f)));
      scene.environment.radiance = glm::vec3(1.0f);
      look_at(scene, {0.3, 1.0, 0.1}, {0.4, 0.0, 0.1}, 0.8);
      judge_ground(context, posed(scene, tilted(degrees)),
                   fmt::format("a ground of {:g} eye heights, tilted by {} degrees", half, degrees), 1e-5, studio,
                   worst);
    }
  return worst.judge();
}

// A ball of a few hundred facets, one of which the eye stands above.
Measurement planet_under_eye(const SelftestContext& context) {
  Studio studio(context);
  Worst worst;
  for (const double radius : {1e3, 6.4e6, 7e7}) {
    Scene scene;
    const Triangles facets = ball(glm::dvec3(0.0), radius, 12);
    add_triangles(scene, facets, add_lambert(scene, glm::vec3(0.5f)));
    scene.environment.radiance = glm::vec3(1.0f);
    const std::size_t facet = 3 * 57;
    const glm::dvec3 a = facets[facet], b = facets[facet + 1], c = facets[facet + 2];
    const glm::dvec3 up = glm::normalize(glm::cross(b - a, c - a)), foot = 0.4 * a + 0.35 * b + 0.25 * c;
    const glm::dvec3 ahead = glm::normalize(b - a);
    look_at(scene, foot + 2.0 * up, foot + 0.1 * ahead, 0.8, ahead);
    judge_ground(context, scene, fmt::format("a planet of {:g} m", radius), 1e-5, studio, worst);
  }
  return worst.judge();
}

constexpr SelftestCase kGroundCases[] = {
    {0, "closed box on floors of 1 m to 10^7 m", "light leaks in where things stand on a large ground", box_on_floor},
    {0, "ground of 10 to 10^7 eye heights", "large grounds vanish below the eye or have holes", ground_under_eye},
    {0, "planet from 2 m above", "planets vanish below the eye or have holes", planet_under_eye},
};

} // namespace

std::span<const SelftestCase> ground_cases() { return kGroundCases; }

} // namespace wavepath
