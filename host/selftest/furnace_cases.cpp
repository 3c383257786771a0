// Cases of energy: surfaces under a white sky, which must return what arrives, and closed rooms that glow.
#include <cmath>

#include <fmt/format.h>

#include "host/render/settings/integrator_kind.h"
#include "host/selftest/oracles.h"
#include "host/selftest/props.h"
#include "host/selftest/scenes.h"
#include "host/selftest/selftest.h"
#include "host/selftest/studio.h"

namespace wavepath {
namespace {

// A floor under a sky of radiance 1, seen along a direction with this cosine from 1 m away; `extent` of the picture,
// and half the side of the floor.
Scene floor_under_sky(double cosine, double extent = 0.01, float half = 1e3f) {
  Scene scene;
  add_triangles(scene, floor_quad(half), 0);
  scene.environment.radiance = glm::vec3(1.0f);
  look_down(scene, extent, 1.0, cosine);
  return scene;
}

// Every sample is exactly 1.
Measurement lambert_furnace(const SelftestContext& context) {
  Scene scene = floor_under_sky(0.5);
  add_lambert(scene, glm::vec3(1.0f));
  const Estimate estimate = Studio(context).measure(scene, square(16, 16, 4), 1);
  const bool dark = 1.0 - estimate.smallest > estimate.largest - 1.0;
  return judge_near(dark ? estimate.smallest : estimate.largest, 1.0, 1e-6, "the pixel farthest from 1");
}

// What meets a second facet comes back, too (kernels/surface/multiple.glsl): all of it, to the error of the
// interpolated tables. The facets and the wide lobe that makes up for the rest are drawn apart, so single samples are
// above 1 and below.
constexpr double kTableError = 2e-3;

Measurement ggx_furnace(const SelftestContext& context) {
  Studio studio(context);
  Worst worst;
  for (const double alpha : {0.1, 0.25, 0.5, 0.75, 1.0}) {
    for (const double cosine : {1.0, 0.7, 0.5, 0.2, 0.05}) {
      Scene scene = floor_under_sky(cosine);
      add_metal(scene, static_cast<float>(std::sqrt(alpha)));
      const Estimate estimate = studio.measure(scene, square(16, context.full ? 1024 : 64, 1), 2);
      const std::string label = fmt::format("alpha {}, cosine {}", alpha, cosine);
      worst.add(estimate, 1.0, kTableError, label);
    }
  }
  return worst.judge();
}

// A white base under a rough coat, what glTF makes of plastic: however the two share the light, it is no more than
// there was, to the 1e-3 by which the fit that couples them may be off. What is missing met a second facet of the coat,
// which single scattering leaves out, or is held back from the base by that fit (interface_transmittance() of
// fresnel.glsl errs on the side of reflection). By ior, roughness and cosine it is at most this, as measured with
// --full and rounded up to 1e-3.
constexpr double kCoatLoss[3][3][3] = {{{0.002, 0.031, 0.035}, {0.012, 0.033, 0.036}, {0.021, 0.025, 0.026}},
                                       {{0.006, 0.044, 0.036}, {0.057, 0.050, 0.036}, {0.139, 0.075, 0.040}},
                                       {{0.080, 0.231, 0.178}, {0.191, 0.159, 0.113}, {0.399, 0.206, 0.106}}};

Measurement coat_furnace(const SelftestContext& context) {
  constexpr float kIors[] = {1.5f, 3.0f, 10.0f}, kRoughness[] = {0.3f, 0.6f, 1.0f};
  constexpr double kCosines[] = {0.5, 0.1, 0.02};
  Studio studio(context);
  Worst worst;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 3; ++c) {
        const float ior = kIors[i], roughness = kRoughness[r];
        const double cosine = kCosines[c];
        Scene scene = floor_under_sky(cosine, 0.1 * cosine);
        Material plastic;
        plastic.metallic = 0.0f;
        plastic.roughness = roughness;
        plastic.ior = ior;
        add_material(scene, plastic);
        const Estimate estimate = studio.measure(scene, square(16, context.full ? 1024 : 64, 1), 2);
        worst.add_range(estimate, 1.0 - kCoatLoss[i][r][c], 1.0 + 1e-3,
                        fmt::format("ior {}, roughness {}, cosine {}", ior, roughness, cosine));
      }
    }
  }
  return worst.judge();
}

// Pictures of one sample a pixel show what every single sample weighs: no more than 1, but for rough metals, see above.
// Their mean is what each material returns: all of it where nothing is lost, a little less where light enters glass,
// within which radiance is larger by the square of the ior.
Measurement grazing(const SelftestContext& context) {
  Studio studio(context);
  Worst worst;
  for (const double cosine : {1e-3, 1e-4, 1e-5, 1e-6, 1e-7}) {
    // The picture stays as narrow as the camera is low, or part of it would look at the floor from below. The floor is
    // hardly larger than what the picture shows of it: from a height of less than 1e-6 of its edges single precision
    // cannot tell on which side of a triangle a camera is.
    const Scene floor = floor_under_sky(cosine, 0.01 * cosine, 0.02f);
    const auto try_material = [&](const Material& material, const char* name, double expected, double slack) {
      Scene scene = floor;
      add_material(scene, material);
      const Estimate estimate = studio.measure(scene, square(32, 1, 1), 4);
      const std::string label = fmt::format("{}, cosine {:g}", name, cosine);
      worst.add(estimate, expected, slack, label);
      if (slack < kTableError) worst.add(std::max(estimate.largest, 1.0), 1.0, 1e-5, label + ", largest sample");
    };
    Scene palette;
    add_lambert(palette, glm::vec3(1.0f));
    add_metal(palette, 0.0f);
    add_metal(palette, 0.5f);
    add_metal(palette, 1.0f);
    add_glass(palette, 1.5f);
    // The function shading_normal() of surface.glsl keeps all directions at least this far from grazing.
    const double held = std::max(cosine, 1e-3);
    const double reflected = fresnel(held, 1.5), within = 1.0 / (1.5 * 1.5);
    const struct {
      const char* name;
      double expected, slack;
    } trials[] = {{"diffuse", 1.0, 1e-5},
                  {"mirror", 1.0, 1e-5},
                  {"GGX of roughness 0.5", 1.0, kTableError},
                  {"GGX of roughness 1", 1.0, kTableError},
                  {"glass", reflected + (1.0 - reflected) * within, 1e-5}};
    for (std::size_t i = 0; i < std::size(trials); ++i)
      try_material(palette.materials[i], trials[i].name, trials[i].expected, trials[i].slack);
  }
  return worst.judge();
}

// A glowing closed box whose walls return `albedo` of what they receive: L = Le / (1 - albedo) everywhere, after D
// bounces the fraction 1 - albedo^(D+1) of it. Le = 1 - albedo makes that fraction the answer.
Scene glowing_box(double albedo) {
  Scene scene;
  const std::uint32_t wall =
      add_lambert(scene, glm::vec3(static_cast<float>(albedo)), glm::vec3(static_cast<float>(1.0 - albedo)));
  add_triangles(scene, box(glm::vec3(-1.0f), glm::vec3(1.0f)), wall);
  look_at(scene, {0, 0, 0}, {1, 0.3, 0.2}, 1.0);
  return scene;
}

double after_bounces(double albedo, std::uint32_t depth) { return 1.0 - std::pow(albedo, depth + 1.0); }

// Nearly all of the light has bounced a hundred or a thousand times, through as many rounds of Russian roulette: the
// number of bounces varies as much as its mean, so this is the noisiest of the cases. A short cut, where nearly all
// paths are still alive, tells the rest more precisely.
Measurement white_room(const SelftestContext& context) {
  constexpr double kRounding = 2e-6; // of albedo and Le as floats, magnified a thousandfold below
  Studio studio(context);
  Worst worst;
  const struct {
    double albedo;
    std::uint32_t depth, samples;
  } trials[] = {{0.99, 1023, 32}, {0.999, 4095, 24}, {0.999, 127, 64}};
  for (const auto& trial : trials) {
    RenderPlan settings = square(16, trial.samples * (context.full ? 32 : 1), trial.depth);
    settings.direct = gpu::kDirectBsdf;
    const double albedo = static_cast<float>(trial.albedo), glow = static_cast<float>(1.0 - trial.albedo);
    const double expected = glow / (1.0 - albedo) * after_bounces(albedo, trial.depth);
    worst.add(studio.measure(glowing_box(trial.albedo), settings, 2), expected, kRounding * expected,
              fmt::format("albedo {}, {} bounces", trial.albedo, trial.depth));
  }
  return worst.judge();
}

Measurement depth_cap(const SelftestContext& context) {
  RenderPlan settings = square(16, context.full ? 4096 : 256, 8);
  settings.direct = gpu::kDirectBsdf;
  Worst worst;
  worst.add(Studio(context).measure(glowing_box(0.9), settings), after_bounces(0.9, 8), 2e-6, "1 - 0.9^9");
  return worst.judge();
}

// Of the many ways to join two paths into one of so many bounces, the weights add up to 1.
Measurement both_ends(const SelftestContext& context) {
  RenderPlan settings = square(16, context.full ? 1024 : 32, 8);
  settings.integrator = find_integrator("bidirectional");
  Worst worst;
  worst.add(Studio(context).measure(glowing_box(0.9), settings), after_bounces(0.9, 8), 2e-6, "1 - 0.9^9");
  return worst.judge();
}

constexpr SelftestCase kFurnaceCases[] = {
    {22, "white furnace, Lambert", "diffuse surfaces gain or lose light at every bounce", lambert_furnace},
    {23, "white furnace, GGX", "rough metals come out too bright or too dark", ggx_furnace},
    {0, "white furnace, coated diffuse", "plastics glow at their edges", coat_furnace},
    {25, "grazing view", "edges of objects glow, or show black or bright specks", grazing},
    {29, "closed white room, albedo 0.99 and 0.999", "rooms with bright walls come out too dark or too bright",
     white_room},
    {30, "bias of the depth cap", "light of late bounces is lost or counted twice", depth_cap},
    {0, "closed room, paths from both ends", "pictures of --integrator bidirectional are too dark or too bright",
     both_ends},
};

} // namespace

std::span<const SelftestCase> furnace_cases() { return kFurnaceCases; }

} // namespace wavepath
