// Cases of size and position: one picture at every scale and far from zero, and a bolt on a planet.
#include <cmath>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/bench/builtin_scene.h"
#include "host/picture/metrics/metrics.h"
#include "host/selftest/props.h"
#include "host/selftest/scenes.h"
#include "host/selftest/selftest.h"
#include "host/selftest/studio.h"

namespace wavepath {
namespace {

// The scene and its camera under a transform that keeps directions.
Scene placed(Scene scene, const glm::dmat4& transform) {
  for (Instance& instance : scene.instances) instance.world_from_object = transform * instance.world_from_object;
  for (Camera& camera : scene.cameras) camera.world_from_camera[3] = transform * camera.world_from_camera[3];
  return scene;
}

Scene moved(const Scene& scene, glm::dvec3 by) { return placed(scene, glm::translate(glm::dmat4(1.0), by)); }
Scene scaled(const Scene& scene, double by) { return placed(scene, glm::scale(glm::dmat4(1.0), glm::dvec3(by))); }

// The room with everything in it twice, the copy `by` away.
Scene doubled(Scene scene, glm::dvec3 by) {
  const Scene copy = moved(scene, by);
  scene.instances.insert(scene.instances.end(), copy.instances.begin(), copy.instances.end());
  return scene;
}

// Many samples, so that a path which takes another turn at an edge, for the last bit of a coordinate, counts for
// little.
RenderPlan room_settings(const SelftestContext& context) { return square(16, context.full ? 1024 : 64, 3); }

std::uint64_t differing_values(const Picture& a, const Picture& b) {
  std::uint64_t count = 0;
  for (std::size_t c = 0; c < a.channels.size(); ++c)
    for (std::size_t i = 0; i < a.channels[c].values.size(); ++i)
      count += !(a.channels[c].values[i] == b.channels[c].values[i]);
  return count;
}

// Powers of two change no mantissa, so not a bit of the picture; others round differently.
Measurement scale(const SelftestContext& context) {
  const Scene room = builtin_scene();
  const RenderPlan settings = room_settings(context);
  Studio studio(context);
  const Picture at_one = studio.render(room, settings).picture;
  Worst worst;
  for (const int power : {-20, 20}) {
    const Picture picture = studio.render(scaled(room, std::exp2(power)), settings).picture;
    worst.add(static_cast<double>(differing_values(picture, at_one)), 0.0, 0.0,
              fmt::format("values that differ at scale 2^{}", power));
  }
  for (const double factor : {1e-6, 1e-3, 1e3, 1e6}) {
    const Picture picture = studio.render(scaled(room, factor), settings).picture;
    worst.add(compare_pictures(picture, at_one).mrse, 0.0, 1e-5, fmt::format("MRSE at scale {:g}", factor));
  }
  return worst.judge();
}

Measurement translation(const SelftestContext& context) {
  const Scene room = builtin_scene();
  Studio studio(context);
  const Picture at_zero = studio.render(room, room_settings(context)).picture;
  const Picture far = studio.render(moved(room, glm::dvec3(1e6)), room_settings(context)).picture;
  return judge_near(compare_pictures(far, at_zero).mrse, 0.0, 1e-6, "MRSE at (1e6, 1e6, 1e6)");
}

// Two placed copies of a room 1e7 m apart; the camera is in the one that is 1e7 m from zero.
Measurement far_instance(const SelftestContext& context) {
  const glm::dvec3 far(1e7, 0.0, 0.0);
  const Scene rooms = doubled(builtin_scene(), far);
  Studio studio(context);
  const Picture at_zero = studio.render(rooms, room_settings(context)).picture;
  const Picture away = studio.render(moved(rooms, far), room_settings(context)).picture;
  return judge_near(compare_pictures(away, at_zero).mrse, 0.0, 1e-4, "MRSE");
}

// A ball and a block of 1e-4 m on a plate of a metre, in the sun.
Scene bolt() {
  Scene scene;
  const std::uint32_t steel = add_metal(scene, 0.3f), paint = add_lambert(scene, {0.6f, 0.6f, 0.6f});
  add_triangles(scene, floor_quad(0.5f), paint);
  add_triangles(scene, box({-1e-4f, 0, -0.5e-4f}, {0, 0.4e-4f, 0.5e-4f}), paint);
  add_triangles(scene, ball({0.5e-4, 0.5e-4, 0}, 0.5e-4, 12), steel);
  scene.environment.radiance = glm::vec3(0.3f);
  PunctualLight sun;
  sun.kind = LightKind::directional;
  sun.direction = glm::normalize(glm::dvec3(-1, -2, -1));
  scene.lights.push_back(sun);
  look_at(scene, {1e-4, 3e-4, 4e-4}, {0, 0.3e-4, 0}, 0.6);
  return scene;
}

// The ball's pole, with edges of five thousand kilometres, `depth` below zero.
void add_planet(Scene& scene, double depth) {
  constexpr double kRadius = 1e8;
  add_triangles(scene, ball(glm::dvec3(0.0), kRadius, 64), add_lambert(scene, glm::vec3(1.0f)),
                glm::translate(glm::dmat4(1.0), glm::dvec3(0.0, -kRadius - depth, 0.0)));
}

Measurement bolt_on_planet(const SelftestContext& context) {
  Studio studio(context);
  const RenderPlan settings = square(32, context.full ? 1024 : 64, 3);
  Scene scene = bolt();
  const Picture alone = studio.render(scene, settings).picture;
  add_planet(scene, 1.0);
  Worst worst;
  const Picture on_planet = studio.render(scene, settings).picture;
  worst.add(compare_pictures(on_planet, alone).mrse, 0.0, 1e-3, "MRSE of a bolt of 1e-4 m on a planet of 1e8 m");

  // The planet from 100 m above, under a white sky: what is less than 1 was hidden by the ground itself.
  Scene ground;
  add_planet(ground, 0.0);
  ground.environment.radiance = glm::vec3(1.0f);
  look_at(ground, {300, 100, 500}, {0, 0, 0}, 0.1);
  const Estimate open = studio.measure(ground, square(32, 16, 1), 1);
  worst.add(std::min(open.mean, 2.0 - open.largest), 1.0, 0.01, "sky seen from the planet's ground, of radiance 1");
  return worst.judge();
}

constexpr SelftestCase kScaleCases[] = {
    {8, "Cornell box at scales 1e-6 to 1e6", "very small or very large scenes show leaks, specks or wrong light",
     scale},
    {9, "Cornell box 1e6 m from zero", "scenes in map coordinates show cracks or noise", translation},
    {10, "instance 1e7 m from zero", "objects placed far apart show cracks or noise when looked at closely",
     far_instance},
    {11, "bolt of 1e-4 m on a planet of 1e8 m", "small things on large ground vanish, or flat ground shows stripes",
     bolt_on_planet},
};

} // namespace

std::span<const SelftestCase> scale_cases() { return kScaleCases; }

} // namespace wavepath
