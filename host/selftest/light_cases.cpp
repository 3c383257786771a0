// Cases of lights: tiny, touching, a sun's strength or ten decades apart, three estimators that must agree, light that
// bounces, and lamps with an extent.
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "host/selftest/oracles.h"
#include "host/selftest/scenes.h"
#include "host/selftest/selftest.h"
#include "host/selftest/studio.h"

namespace wavepath {
namespace {

using std::numbers::pi;
constexpr double kLightRounding = 1e-5; // relative
constexpr double kExtent = 1e-6; // of the picture: one point of the receiver, to 1e-6 of the distance to its lights

// A small white receiver at zero that faces up: what it shows is irradiance / pi.
Scene receiver(double camera_height = 0.05) {
  Scene scene;
  add_triangles(scene, floor_quad(1.0f), add_lambert(scene, glm::vec3(1.0f)));
  look_down(scene, kExtent, camera_height);
  return scene;
}

Scene under_light(const Triangles& light, float radiance) {
  Scene scene = receiver();
  add_triangles(scene, light, add_emitter(scene, radiance));
  return scene;
}

// The same power from a ball of a metre and from one of ten microns.
Measurement tiny_light(const SelftestContext& context) {
  Studio studio(context);
  Worst worst;
  for (const double radius : {1.0, 1e-5}) {
    const Triangles light = ball({0, 3, 0}, radius, 16);
    const double radiance = static_cast<double>(static_cast<float>(1.0 / (radius * radius)));
    const Scene scene = under_light(light, static_cast<float>(radiance));
    const double expected = radiance * irradiance(light) / pi;
    const std::string label = fmt::format("radius {:g} m", radius);
    worst.add(studio.measure(scene, square(16, context.full ? 2048 : 256, 1)), expected, 1e-4 * expected, label);
    // One sample a pixel: the brightest pixel is the largest sample.
    const Estimate samples = studio.measure(scene, square(64, 1, 1), 1);
    worst.add(samples.largest / (samples.mean * 64 * 64), 0.0, 0.01, label + ", largest sample's fraction");
  }
  return worst.judge();
}

// A bright light behind a screen, picked for all but one of 1e10 shadow rays, must not hide the dim one in view, which
// fills a part of the receiver's sky.
Measurement dynamic_range(const SelftestContext& context) {
  const Triangles dim = disc({0, 1, 0}, 2.0f, 64);
  Scene scene = under_light(dim, 1.0f);
  add_triangles(scene, disc({20, 1, 0}, 2.0f, 64), add_emitter(scene, 1e10f));
  add_triangles(scene, quad({10, -50, -50}, {0, 100, 0}, {0, 0, 100}), add_lambert(scene, glm::vec3(0.0f)));
  const double expected = irradiance(dim) / pi;
  Worst worst;
  worst.add(Studio(context).measure(scene, square(16, context.full ? 4096 : 512, 1)), expected,
            kLightRounding * expected, "radiance 1 in view, 1e10 behind a screen");
  return worst.judge();
}

// Nearly the whole sky is the light. Next-event estimation alone has no finite variance here.
Measurement touching_light(const SelftestContext& context) {
  Scene scene = receiver(5e-7);
  const Triangles light = quad({-0.05f, 1e-6f, -0.05f}, {0.1f, 0, 0}, {0, 0, 0.1f});
  add_triangles(scene, light, add_emitter(scene, 1.0f));
  Worst worst;
  worst.add(Studio(context).measure(scene, square(16, context.full ? 1024 : 64, 1)), irradiance(light) / pi, 1e-5,
            "1 um above the receiver");
  return worst.judge();
}

// Every scene here that all three techniques can render, and a room of several bounces, whose answer is the others'.
Measurement estimators_agree(const SelftestContext& context) {
  Scene room;
  const std::uint32_t wall = add_lambert(room, glm::vec3(0.7f));
  add_triangles(room, flipped(box(glm::vec3(-1.0f), glm::vec3(1.0f))), wall);
  add_triangles(room, box({-0.5f, -1, -0.5f}, {0.2f, -0.2f, 0.3f}), wall);
  add_triangles(room, disc({0, 0.99f, 0}, 0.4f, 16), add_emitter(room, 10.0f));
  look_at(room, {0, 0, 0.9}, {0, -0.3, -1}, 1.0);
  const struct {
    const char* name;
    Scene scene;
    std::uint32_t depth;
  } trials[] = {{"disc", under_light(disc({0, 2, 0}, 1.0f, 64), 1.0f), 1},
                {"ball", under_light(ball({0, 3, 0}, 1.0, 16), 1.0f), 1},
                {"square", under_light(quad({0, 1, 0}, {1, 0, 0}, {0, 0, 1}), 1.0f), 1},
                {"room", room, 3}};
  Studio studio(context);
  Worst worst;
  for (const auto& trial : trials) {
    RenderPlan settings = square(16, context.full ? 1024 : 64, trial.depth);
    const Estimate mis = studio.measure(trial.scene, settings);
    for (const std::uint32_t direct : {gpu::kDirectNee, gpu::kDirectBsdf}) {
      settings.direct = direct;
      if (direct == gpu::kDirectBsdf) settings.last_sample *= 4; // it finds lamps by chance
      Estimate other = studio.measure(trial.scene, settings);
      other.standard_error = std::hypot(other.standard_error, mis.standard_error);
      worst.add(other, mis.mean, kLightRounding * mis.mean,
                fmt::format("{}, {} against mis", trial.name, direct == gpu::kDirectNee ? "nee" : "bsdf"));
    }
  }
  return worst.judge();
}

// A receiver that sees no light but a small ceiling, which the sun lights from below, past the receiver's edge.
Measurement indirect_light(const SelftestContext& context, const RenderPlan& settings) {
  const Triangles ceiling = disc({0, 1, 0}, 0.3f, 32);
  Scene scene;
  const std::uint32_t white = add_lambert(scene, glm::vec3(1.0f));
  add_triangles(scene, floor_quad(0.2f), white);
  add_triangles(scene, ceiling, white);
  look_down(scene, kExtent, 0.05);
  PunctualLight sun;
  sun.kind = LightKind::directional;
  sun.intensity = glm::vec3(10.0f);
  sun.direction = glm::normalize(glm::dvec3(1, 1, 0));
  scene.lights.push_back(sun);
  const double radiance = 10.0 * sun.direction.y / pi, expected = irradiance(ceiling) * radiance / pi;
  Worst worst;
  worst.add(Studio(context).measure(scene, settings), expected, kLightRounding * expected,
            "a ceiling that the sun lights");
  return worst.judge();
}

Measurement guided_paths(const SelftestContext& context) {
  RenderPlan settings = square(16, context.full ? 2048 : 128, 2);
  settings.guide = true;
  return indirect_light(context, settings);
}

Measurement shared_paths(const SelftestContext& context) {
  RenderPlan settings = square(16, context.full ? 2048 : 128, 2);
  settings.reuse = kReuseOn;
  return indirect_light(context, settings);
}

PunctualLight soft_sphere(const glm::dvec3& position, double radius, double intensity) {
  PunctualLight lamp;
  lamp.position = position;
  lamp.extent = radius;
  lamp.intensity = glm::vec3(static_cast<float>(intensity));
  return lamp;
}

// At the zenith, or at this angle to it.
PunctualLight soft_sun(double degrees, double tilt = 0.0) {
  PunctualLight sun;
  sun.kind = LightKind::directional;
  sun.direction = {std::sin(tilt), -std::cos(tilt), 0.0};
  sun.extent = glm::radians(0.5 * degrees);
  return sun;
}

void measure_soft(const SelftestContext& context, Studio& studio, const Scene& scene, double irradiance,
                  const std::string& label, Worst& worst) {
  for (const std::uint32_t direct : {gpu::kDirectMis, gpu::kDirectNee}) {
    RenderPlan settings = square(16, context.full ? 2048 : 256, 1);
    settings.direct = direct;
    worst.add(studio.measure(scene, settings), irradiance / pi, kLightRounding * irradiance,
              label + (direct == gpu::kDirectMis ? ", mis" : ", nee"));
  }
}

// An extent changes neither what a surface receives that sees all of a lamp, nor does it darken what a mirror shows.
Measurement soft_lamps(const SelftestContext& context) {
  Studio studio(context);
  Worst worst;
  const glm::dvec3 at(0.6, 2.0, -0.5);
  for (const double radius : {1e-9, 1e-3, 1.0, 1.99}) {
    Scene scene = receiver(1e-3);
    scene.lights = {soft_sphere(at, radius, 1.0)};
    measure_soft(context, studio, scene, at.y / std::pow(glm::length(at), 3.0), fmt::format("radius {:g} m", radius),
                 worst);
  }
  for (const double degrees : {1e-6, 0.53, 89.0}) {
    Scene scene = receiver();
    scene.lights = {soft_sun(degrees, 0.7)};
    measure_soft(context, studio, scene, std::cos(0.7), fmt::format("a sun {:g} degrees across", degrees), worst);
  }
  for (const bool is_sun : {false, true}) {
    const double extent = 0.5;
    Scene scene;
    add_triangles(scene, floor_quad(1.0f), add_metal(scene, 0.0f));
    look_down(scene, kExtent, 0.05);
    scene.lights = {is_sun ? soft_sun(glm::degrees(2.0 * extent)) : soft_sphere({0, 2, 0}, extent, 1.0)};
    const double size = is_sun ? std::sin(extent) : extent, expected = 1.0 / (pi * size * size);
    worst.add(studio.measure(scene, square(16, 16, 1)), expected, 1e-5 * expected,
              is_sun ? "a sun in a mirror" : "a sphere in a mirror");
  }
  return worst.judge();
}

// The shadow of a half-plane 2 m above the receiver, from nearly all to nearly none of a lamp 16 degrees across.
Measurement penumbrae(const SelftestContext& context) {
  const double half_angle = glm::radians(8.0), reach = std::tan(half_angle), distance = 5.0;
  Studio studio(context);
  Worst worst;
  for (const double place : {-0.9, -0.4, 0.0, 0.6, 0.8}) {
    const double slope = place * reach, expected = sun_past_edge(half_angle, slope);
    Scene scene = receiver();
    const auto edge = static_cast<float>(2.0 * slope);
    add_triangles(scene, quad({edge - 50.0f, 2, -50}, {0, 0, 100}, {50, 0, 0}), add_lambert(scene, glm::vec3(0.0f)));
    for (const bool is_sun : {false, true}) {
      scene.lights = {is_sun ? soft_sun(glm::degrees(2.0 * half_angle))
                             : soft_sphere({0, distance, 0}, distance * std::sin(half_angle), distance * distance)};
      measure_soft(context, studio, scene, expected,
                   fmt::format("{} at {:g} of its penumbra", is_sun ? "a sun" : "a sphere", place), worst);
    }
  }
  return worst.judge();
}

constexpr SelftestCase kLightCases[] = {
    {31, "tiny bright light", "small lamps come out too bright or too dark, or sprinkle the picture with fireflies",
     tiny_light},
    {32, "light of 1 beside a light of 1e10", "dim lights vanish in scenes that hold a bright one", dynamic_range},
    {43, "light 1 um above a surface", "lights that touch a surface leak, flicker or leave it black", touching_light},
    {44, "three estimators agree", "the picture depends on --direct by more than noise", estimators_agree},
    {0, "indirect light, guided paths", "pictures with --guide are too dark or too bright", guided_paths},
    {0, "indirect light, shared paths", "pictures with --reuse are too dark or too bright", shared_paths},
    {0, "soft lamps", "--lamp-radius and --sun-angle change the light of lamps, or what mirrors show of them",
     soft_lamps},
    {0, "penumbrae of soft lamps", "shadows under --lamp-radius and --sun-angle are too wide or too narrow", penumbrae},
};

} // namespace

std::span<const SelftestCase> light_cases() { return kLightCases; }

} // namespace wavepath
