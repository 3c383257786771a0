// Cases of mirrors and glass: roughness down to zero, iors from 1 to 10, total reflection, slabs within slabs.
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "host/selftest/oracles.h"
#include "host/selftest/scenes.h"
#include "host/selftest/selftest.h"
#include "host/selftest/studio.h"

namespace wavepath {
namespace {

constexpr double kGlassRounding = 1e-5; // relative: a path crosses tens of surfaces, each of which rounds a few times

// A metal floor that mirrors a lamp and, beside it, a sky of another radiance: next-event estimation picks points of
// the lamp, so that a narrow lobe is met by both techniques.
Scene mirror_room(float roughness) {
  Scene scene;
  add_triangles(scene, floor_quad(1.0f), add_metal(scene, roughness));
  add_triangles(scene, quad({-100, 50, -200}, {200, 0, 0}, {0, 0, 200}), add_emitter(scene, 1.0f));
  scene.environment.radiance = glm::vec3(0.25f);
  look_down(scene, 0.1, 1.0, std::sqrt(0.5));
  return scene;
}

// Smooth mirrors show the lamp as it is; so must those that are nearly smooth, whose lobe stays far within the lamp. At
// most one sample in 1e5 may leave it.
Measurement nearly_smooth(const SelftestContext& context) {
  Studio studio(context);
  Worst worst;
  for (const double alpha : {0.0, 1e-8, 1e-6, 1e-4, 1e-3}) {
    const Scene scene = mirror_room(static_cast<float>(std::sqrt(alpha)));
    const Estimate estimate = studio.measure(scene, square(16, context.full ? 1024 : 64, 1), 2);
    const std::string label = fmt::format("alpha {:g}", alpha);
    worst.add(estimate.nonfinite > 0 ? std::nan("") : estimate.mean, 1.0, 1e-3, label);
    worst.add(std::max(estimate.largest, 1.0), 1.0, 0.05, label + ", brightest pixel"); // a speck would be
  }
  return worst.judge();
}

// Bodies that absorb nothing are invisible in an environment of radiance 1. A bubble is a body turned
// inside out: its surface is met from the dense side first, at the ior 1 / n.
Measurement clear_bodies(const SelftestContext& context) {
  Studio studio(context);
  Worst worst;
  for (const double ior : {1.0, 1.0 + 1e-6, 1.5, 10.0}) {
    for (const bool bubble : {false, true}) {
      for (const float roughness : {0.0f, 0.001f}) {
        Scene scene;
        const std::uint32_t glass = add_glass(scene, static_cast<float>(ior), roughness);
        add_triangles(scene, box(glm::vec3(-1.0f), glm::vec3(1.0f)), glass);
        if (bubble) add_triangles(scene, flipped(box(glm::vec3(-0.5f), glm::vec3(0.5f))), glass);
        scene.environment.radiance = glm::vec3(1.0f);
        look_down(scene, 0.9, 5.0, 0.9);
        const Estimate estimate = studio.measure(scene, square(8, context.full ? 256 : 16, 128), 1);
        const bool dark = 1.0 - estimate.smallest > estimate.largest - 1.0;
        worst.add(estimate.nonfinite > 0 ? std::nan("")
                  : dark                 ? estimate.smallest
                                         : estimate.largest,
                  1.0, kGlassRounding,
                  fmt::format("ior {:.7g}{}, roughness {:g}", ior, bubble ? " with a bubble of ior 1" : "", roughness));
      }
    }
  }
  return worst.judge();
}

// From inside of glass of ior 1.5 at `degrees` from the normal of its surface: what comes back from a lamp inside, or
// what comes in from one outside.
Scene inside_glass(double degrees, bool lamp_inside) {
  Scene scene;
  const double angle = degrees * std::numbers::pi / 180.0;
  const std::uint32_t glass = add_glass(scene, 1.5f);
  add_triangles(scene, flipped(floor_quad(10.0f)), glass); // its front faces down, away from the camera inside
  scene.materials[glass].double_sided = true;
  const std::uint32_t lamp = add_emitter(scene, 1.0f);
  if (lamp_inside)
    add_triangles(scene, disc({0, 200, 0}, 1e3f, 64), lamp);
  else
    add_triangles(scene, floor_quad(1e4f), lamp), scene.instances.back().world_from_object[3][1] = -1.0;
  look_down(scene, 1e-3, 1.0, std::cos(angle));
  return scene;
}

// The critical angle of ior 1.5 is 41.8103 degrees.
Measurement total_reflection(const SelftestContext& context) {
  Studio studio(context);
  Worst worst;
  for (const double degrees : {41.80, 41.82}) {
    const double reflected = fresnel(std::cos(degrees * std::numbers::pi / 180.0), 1.0 / 1.5);
    const RenderPlan settings = square(16, context.full ? 4096 : 256, 1);
    const std::string label = fmt::format("{:.2f} degrees", degrees);
    // 1 - F has a root of infinite slope at the critical angle: the direction's last bit moves it by 1e-4 here.
    const double slack = reflected < 1.0 ? 2e-4 : 0.0;
    worst.add(studio.measure(inside_glass(degrees, true), settings), reflected, slack, label + ", reflected");
    worst.add(studio.measure(inside_glass(degrees, false), settings), (1.0 - reflected) * 1.5 * 1.5, 2.25 * slack,
              label + ", transmitted");
  }
  return worst.judge();
}

// `slabs` plates of this ior with gaps between them, seen along their normal, above a lamp or below a white sky.
Scene slabs(float ior, int count, bool lamp_below) {
  Scene scene;
  const std::uint32_t glass = add_glass(scene, ior);
  for (int i = 0; i < count; ++i) add_triangles(scene, box({-50, -1.0f - i, -50}, {50, -0.5f - i, 50}), glass);
  const std::uint32_t bottom = lamp_below ? add_emitter(scene, 1.0f) : add_lambert(scene, glm::vec3(0.0f));
  add_triangles(scene, floor_quad(), bottom);
  scene.instances.back().world_from_object[3][1] = -10.0;
  if (!lamp_below) scene.environment.radiance = glm::vec3(1.0f);
  look_down(scene, 0.1, 1.0);
  return scene;
}

// All internal reflections summed: k surfaces of reflectance F reflect k F / (1 + (k - 1) F).
double stack_reflectance(double ior, int surfaces) {
  const double f = fresnel(1.0, ior);
  return surfaces * f / (1.0 + (surfaces - 1) * f);
}

Measurement glass_slab(const SelftestContext& context) {
  const double reflected = stack_reflectance(1.5, 2); // 0.076923
  Studio studio(context);
  Worst worst;
  const RenderPlan settings = square(16, context.full ? 8192 : 256, 32);
  worst.add(studio.measure(slabs(1.5f, 1, false), settings), reflected, kGlassRounding, "reflected");
  worst.add(studio.measure(slabs(1.5f, 1, true), settings), 1.0 - reflected, kGlassRounding, "transmitted");
  return worst.judge();
}

// Glass within glass: a body whose hollow holds another body, six surfaces along the line of sight.
Measurement nested_glass(const SelftestContext& context) {
  Studio studio(context);
  Worst worst;
  for (const double ior : {1.0, 1.0 + 1e-6, 1.5, 10.0}) {
    Scene scene;
    const std::uint32_t glass = add_glass(scene, static_cast<float>(ior));
    for (const int shell : {0, 1, 2}) {
      const glm::vec3 half(50.0f - shell, 3.0f - shell, 50.0f - shell);
      add_triangles(scene, shell == 1 ? flipped(box(-half, half)) : box(-half, half), glass);
    }
    add_triangles(scene, floor_quad(), add_emitter(scene, 1.0f));
    scene.instances.back().world_from_object[3][1] = -10.0;
    look_down(scene, 0.1, 5.0);
    const double expected = 1.0 - stack_reflectance(static_cast<double>(static_cast<float>(ior)), 6);
    const std::uint32_t samples = ior < 10.0 ? 64 : 256; // of an ior of 10 little light gets through
    worst.add(studio.measure(scene, square(16, context.full ? 8192 : samples, 128), 2), expected, kGlassRounding,
              fmt::format("ior {:.7g}", ior));
  }
  return worst.judge();
}

constexpr SelftestCase kGlassCases[] = {
    {24, "roughness near zero", "polished metal shows specks, or the wrong brightness", nearly_smooth},
    {26, "white furnace, glass of ior 1 to 10", "glass gains or loses light", clear_bodies},
    {27, "total reflection", "the rim of the window seen from under water is in the wrong place, or holes show",
     total_reflection},
    {28, "glass slab", "window panes are too bright or too dark", glass_slab},
    {0, "glass within glass, ior 1 to 10", "a bottle in a showcase is too bright or too dark", nested_glass},
};

} // namespace

std::span<const SelftestCase> glass_cases() { return kGlassCases; }

} // namespace wavepath
