// Whole renders of materials that a picture alone can prove: bodies that scatter, glass that disperses, normal maps.
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/integrators/path/kind.h"
#include "host/render/render.h"
#include "host/scene/pack/pack.h"
#include "host/scene/view.h"
#include "tests/scene_builder.h"
#include "tests/shared_kernels.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {
namespace {

constexpr double kPi = std::numbers::pi;

class MaterialRender : public VulkanTest {
protected:
  // Mean over the picture.
  glm::dvec3 mean(Scene scene, const View& view, std::uint32_t side, std::uint32_t spp, std::uint32_t depth) {
    RenderSettings asked;
    asked.width = asked.height = side;
    asked.last_sample = spp;
    asked.max_depth = depth;
    asked.integrator = &kPath;
    asked.filter = gpu::kFilterBox;
    const PackedScene packed = pack(scene);
    const Picture picture = render(device(), packed, view, asked, RenderHooks{}, shared_kernels(device())).picture;
    glm::dvec3 sum(0.0);
    for (int c = 0; c < 3; ++c)
      for (const float v : picture.channels[static_cast<std::size_t>(c)].values) sum[c] += v;
    return sum / static_cast<double>(side * side);
  }
};

// Parallel rays towards `target`.
View orthographic(glm::dvec3 target, glm::dvec3 towards, double half, double distance) {
  View view;
  view.orthographic = true;
  view.forward = glm::normalize(towards);
  view.position = target - distance * view.forward;
  const glm::dvec3 aside = std::abs(view.forward.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
  view.right = half * glm::normalize(glm::cross(view.forward, aside));
  view.up = glm::cross(view.right, view.forward);
  return view;
}

// Two triangles that face away from the origin.
void add_face(std::vector<glm::vec3>& mesh, glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d) {
  if (glm::dot(glm::cross(b - a, c - a), a + c) < 0.0f) std::swap(b, d);
  mesh.insert(mesh.end(), {a, b, c, a, c, d});
}

std::vector<glm::vec3> box(glm::vec3 half) {
  std::vector<glm::vec3> mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0f, 1.0f}) {
      const auto corner = [&](float u, float v) {
        glm::vec3 p;
        p[axis] = side, p[(axis + 1) % 3] = u, p[(axis + 2) % 3] = v;
        return p * half;
      };
      add_face(mesh, corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1));
    }
  return mesh;
}

Material clear_body(float ior) {
  Material body = plain_material();
  body.base_color = glm::vec4(1.0f);
  body.specular = 1.0f;
  body.roughness = 0.0f;
  body.transmission = 1.0f;
  body.volume = true;
  body.ior = ior;
  return body;
}

Scene body_scene(const std::vector<glm::vec3>& mesh, const Material& body) {
  Scene scene;
  scene.path = "test";
  scene.materials = {body};
  add_instance(scene, add_mesh(scene, mesh));
  scene.environment.radiance = glm::vec3(1.0f);
  return scene;
}

// ---- scattering in volumes ------------------------------------------------------------------------------------------

// Chandrasekhar's H function for isotropic scattering, by iteration (Radiative Transfer, 1950, chapter V).
double chandrasekhar_h(double mu, double albedo) {
  constexpr std::size_t kNodes = 400;
  std::vector<double> h(kNodes, 1.0);
  const auto value = [&](double m) {
    double integral = 0.0;
    for (std::size_t i = 0; i < kNodes; ++i) {
      const double x = (static_cast<double>(i) + 0.5) / kNodes;
      integral += x * h[i] / (m + x) / kNodes;
    }
    return 1.0 / (std::sqrt(1.0 - albedo) + 0.5 * albedo * integral);
  };
  for (int round = 0; round < 200; ++round) {
    std::vector<double> next(kNodes);
    for (std::size_t i = 0; i < kNodes; ++i) next[i] = value((static_cast<double>(i) + 0.5) / kNodes);
    h = next;
  }
  return value(mu);
}

// A deep body without an interface under a white sky reflects 1 - H(mu) sqrt(1 - albedo) towards mu. Three albedos at
// once: every channel must be right though one alone draws the distances.
TEST_F(MaterialRender, DeepBodiesReflectAsChandrasekharSays) {
  const glm::dvec3 albedo(0.5, 0.9, 0.98);
  Material milk = clear_body(1.0f);
  milk.attenuation = glm::vec3(1.0f); // extinction
  milk.scattering = glm::vec3(albedo);
  const Scene scene = body_scene(box({200.0f, 30.0f, 200.0f}), milk);
  for (const double mu : {1.0, 0.4}) {
    const glm::dvec3 down(std::sqrt(1.0 - mu * mu), -mu, 0.0);
    const glm::dvec3 seen = mean(scene, orthographic({0, 30, 0}, down, 0.5, 5.0), 16, 256, 2000);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(seen[c], 1.0 - chandrasekhar_h(mu, albedo[c]) * std::sqrt(1.0 - albedo[c]), 0.006)
          << "mu " << mu << ", albedo " << albedo[c];
  }
}

// Light is neither lost nor gained in a body of glass that only scatters, forward or back.
TEST_F(MaterialRender, BodiesThatOnlyScatterReturnAllLight) {
  for (const float g : {0.0f, 0.8f, -0.5f}) {
    Material marble = clear_body(1.5f);
    marble.attenuation = marble.scattering = glm::vec3(2.0f, 1.0f, 0.5f);
    marble.scattering_anisotropy = g;
    const glm::dvec3 seen = mean(body_scene(box(glm::vec3(0.5f)), marble),
                                 orthographic({0, 0, 0}, {0.3, -0.5, 0.8}, 0.3, 5.0), 16, 256, 2000);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], 1.0, 0.015) << "g " << g;
  }
}

// The share of once scattered light that goes on into the forward hemisphere, by Henyey and Greenstein.
double forward_share(double g) { return (1.0 - g * g) / (2.0 * g) * (1.0 / (1.0 - g) - 1.0 / std::sqrt(1.0 + g * g)); }

// A thin mist before the dark half of a sky shows what it throws back of the light behind the camera.
TEST_F(MaterialRender, MistScattersAsItsPhaseFunctionSays) {
  constexpr float kDensity = 0.02f; // times a metre: little is scattered twice
  for (const double g : {0.7, -0.7}) {
    Material mist = clear_body(1.0f);
    mist.attenuation = mist.scattering = glm::vec3(kDensity);
    mist.scattering_anisotropy = static_cast<float>(g);
    Scene scene = body_scene(box(glm::vec3(0.5f)), mist);
    Environment& sky = scene.environment;
    sky.width = 64, sky.height = 32;
    sky.map.assign(64 * 32, glm::vec3(0.0f));
    for (std::size_t y = 0; y < 32; ++y)
      for (std::size_t x = 0; x < 64; ++x)
        if (x < 16 || x >= 48) sky.map[y * 64 + x] = glm::vec3(1.0f); // towards -X
    const double scattered = 1.0 - std::exp(-kDensity);
    const double seen = mean(scene, orthographic({0, 0, 0}, {1, 0, 0}, 0.2, 3.0), 16, 4096, 50).y / scattered;
    EXPECT_NEAR(seen, 1.0 - forward_share(g), g > 0.0 ? 0.012 : 0.04) << "g " << g;
  }
}

// ---- dispersion -----------------------------------------------------------------------------------------------------

double fresnel(double c, double eta) {
  const double refracted = std::sqrt(1.0 - (1.0 - c * c) / (eta * eta));
  const double s = (c - eta * refracted) / (c + eta * refracted), p = (eta * c - refracted) / (eta * c + refracted);
  return 0.5 * (s * s + p * p);
}

// A prism bends each channel by Snell's law for its own ior. The sky's radiance is the angle by which light is bent, so
// that the picture tells the angle.
TEST_F(MaterialRender, PrismsBendEachChannelByItsIor) {
  constexpr double kApex = 40.0 * kPi / 180.0;
  const float base = static_cast<float>(2.0 * std::tan(0.5 * kApex));
  std::vector<glm::vec3> prism;
  const auto add_side = [&](glm::vec3 a, glm::vec3 b) {
    const glm::vec3 y(0.0f, 5.0f, 0.0f);
    add_face(prism, a - y, b - y, b + y, a + y);
  };
  add_side({0, 0, 1}, {-base, 0, -1});
  add_side({0, 0, 1}, {base, 0, -1});
  add_side({-base, 0, -1}, {base, 0, -1});
  for (const float dispersion : {0.0f, 4.0f}) {
    Material flint = clear_body(1.5f);
    flint.dispersion = dispersion;
    Scene scene = body_scene(prism, flint);
    Environment& sky = scene.environment;
    sky.width = 1440, sky.height = 2;
    for (std::size_t i = 0; i < 2 * 1440; ++i) {
      const double turned = -((static_cast<double>(i % 1440) + 0.5) / 1440.0 - 0.5) * 2.0 * kPi; // from +X towards -Z
      sky.map.push_back(glm::vec3(turned > 0.1 && turned < 0.8 ? static_cast<float>(turned) : 0.0f));
    }
    const glm::dvec3 seen = mean(scene, orthographic({-0.3, 0, 0}, {1, 0, 0}, 0.1, 3.0), 16, 768, 2);
    for (int c = 0; c < 3; ++c) {
      const double n = 1.5 + (c - 1) * 0.025 * dispersion * 0.5; // (n - 1) / Abbe number from red to blue
      const double in = 0.5 * kApex, r1 = std::asin(std::sin(in) / n), r2 = kApex - r1;
      const double out = std::asin(n * std::sin(r2)), bent = in + out - kApex;
      const double passed = (1.0 - fresnel(std::cos(in), n)) * (1.0 - fresnel(std::cos(r2), 1.0 / n));
      EXPECT_NEAR(seen[c], passed * bent, 0.01 * bent) << "dispersion " << dispersion << ", channel " << c;
    }
  }
}

// ---- bodies that overlap --------------------------------------------------------------------------------------------

gpu::Feature features_of_scene(Scene scene) { return pack(scene).features; }

Scene over_dark_side(Scene scene, bool from_above) { // white where the camera looks, black behind it
  Environment& sky = scene.environment;
  sky.width = 8, sky.height = 64;
  sky.map.assign(8 * 64, glm::vec3(0.0f));
  for (std::size_t i = 0; i < 8 * 64; ++i)
    if ((i / 8 < 32) != from_above) sky.map[i] = glm::vec3(1.0f);
  return scene;
}

std::vector<glm::vec3> slab(float low, float high) {
  std::vector<glm::vec3> mesh = box({20.0f, 0.5f * (high - low), 20.0f});
  for (glm::vec3& p : mesh) p.y += 0.5f * (high + low);
  return mesh;
}

// Water that reaches into the wall of its glass: where they overlap there is one of them alone, the thinner one, from
// either side; light bends once between the two.
TEST_F(MaterialRender, BodiesThatOverlapAreOneAfterTheOther) {
  constexpr double kGlass = 1.5, kWater = 1.33, kInGlass = 0.3, kInWater = 0.5; // iors, attenuations
  Material glass = clear_body(kGlass), water = clear_body(kWater);
  glass.attenuation = glm::vec3(kInGlass);
  water.attenuation = glm::vec3(kInWater);
  Scene both = body_scene(slab(0.0f, 1.0f), glass);
  both.materials.push_back(water);
  add_instance(both, add_mesh(both, slab(0.75f, 2.75f), 1));
  EXPECT_TRUE(features_of_scene(both) & gpu::kLobeNested);
  const double sine = 0.6, cos_air = 0.8;
  const double cos_glass = std::sqrt(1.0 - sine * sine / (kGlass * kGlass));
  const double cos_water = std::sqrt(1.0 - sine * sine / (kWater * kWater));
  // The glass has the smaller box, hence 1 m of it and 1.75 m of water.
  const double passed = (1.0 - fresnel(cos_air, kGlass)) * (1.0 - fresnel(cos_glass, kWater / kGlass)) *
                        (1.0 - fresnel(cos_air, kWater)) *
                        std::exp(-kInGlass / cos_glass - kInWater * 1.75 / cos_water);
  for (const bool from_above : {true, false}) {
    const glm::dvec3 towards(sine, from_above ? -cos_air : cos_air, 0.0);
    // Four surfaces and no bounce more: what is reflected twice within does not get out.
    EXPECT_NEAR(mean(over_dark_side(both, from_above), orthographic({0, 1, 0}, towards, 0.3, 6.0), 16, 512, 4).y,
                passed, 0.004)
        << (from_above ? "from above" : "from below");
  }
  // One above the other there is no list.
  Scene apart = body_scene(slab(0.0f, 1.0f), glass);
  add_instance(apart, add_mesh(apart, slab(1.5f, 2.5f)));
  EXPECT_FALSE(features_of_scene(apart) & gpu::kLobeNested);
}

// A camera in water knows it, with one body and with a list of them.
TEST_F(MaterialRender, TheEyeMayBeWithinABody) {
  constexpr double kIor = 1.33, kDensity = 0.4, kWay = 1.5;
  Material water = clear_body(kIor);
  water.attenuation = glm::vec3(kDensity);
  const double mirrored = fresnel(1.0, 1.0 / kIor);
  const double seen = kIor * kIor * (1.0 - mirrored) * std::exp(-kDensity * kWay); // radiance within is denser
  for (const bool nested : {false, true}) {
    Scene scene = body_scene(box({20.0f, 2.0f, 20.0f}), water);
    if (nested) { // far away, but its box meets that of the water
      scene.materials.push_back(clear_body(1.5f));
      std::vector<glm::vec3> far = box(glm::vec3(1.0f));
      for (glm::vec3& p : far) p += glm::vec3(19.0f, 0.0f, 19.0f);
      add_instance(scene, add_mesh(scene, far, 1));
    }
    EXPECT_EQ((features_of_scene(scene) & gpu::kLobeNested) != 0, nested);
    View view;
    view.position = {0, 0.5, 0};
    view.forward = {0, 1, 0};
    view.right = {1e-3, 0, 0};
    view.up = {0, 0, 1e-3};
    EXPECT_NEAR(mean(over_dark_side(scene, false), view, 8, 512, 1).y, seen, 0.01) << nested;
  }
}

// A bubble in glass is one, and a ball that another one hides leaves no trace.
TEST_F(MaterialRender, TheInnerBodyCounts) {
  Material glass = clear_body(1.5f), air = clear_body(1.0f);
  glass.attenuation = glm::vec3(0.5f);
  Scene scene = body_scene(box(glm::vec3(1.0f)), glass);
  scene.materials.push_back(air);
  add_instance(scene, add_mesh(scene, box(glm::vec3(0.5f)), 1));
  const double r = fresnel(1.0, 1.5), passed = std::pow(1.0 - r, 4) * std::exp(-0.5);
  EXPECT_NEAR(mean(over_dark_side(scene, true), orthographic({0, 0, 0}, {0, -1, 0}, 0.3, 5.0), 8, 1024, 4).y, passed,
              0.01);
}

// ---- normal maps ----------------------------------------------------------------------------------------------------

// White surfaces return all light whatever their map says.
TEST_F(MaterialRender, NormalMapsKeepTheLight) {
  Scene scene;
  scene.path = "test";
  scene.environment.radiance = glm::vec3(1.0f);
  Image map;
  map.name = "bumps";
  map.width = map.height = 16;
  std::uint32_t state = 1;
  const auto next = [&] { return static_cast<double>((state = state * 1664525u + 1013904223u) >> 8) * 0x1p-24; };
  for (int i = 0; i < 16 * 16; ++i) {
    const double tilt = 1.2 * next(), around = 2.0 * kPi * next(); // up to 69 degrees
    for (const double v : {std::sin(tilt) * std::cos(around), std::sin(tilt) * std::sin(around), std::cos(tilt), 1.0})
      map.bytes.push_back(static_cast<std::uint8_t>(std::lround(127.5 + 127.5 * v)));
  }
  scene.images = {map};
  const std::uint32_t floor = add_mesh(scene, {{-9, 0, -9}, {9, 0, 9}, {9, 0, -9}, {-9, 0, -9}, {-9, 0, 9}, {9, 0, 9}});
  for (const glm::vec3& p : scene.meshes[floor].positions) {
    scene.meshes[floor].uvs[0].push_back({p.x, p.z});
    scene.meshes[floor].tangents.push_back({1, 0, 0, -1});
  }
  add_instance(scene, floor);
  for (const auto& [metallic, roughness] : {std::pair{0.0f, 0.5f}, {1.0f, 0.5f}, {1.0f, 0.0f}}) {
    Material bumpy = plain_material();
    bumpy.base_color = glm::vec4(1.0f);
    bumpy.metallic = metallic;
    bumpy.roughness = roughness;
    bumpy.normal_texture.image = 0;
    scene.materials = {bumpy};
    for (const double mu : {0.9, 0.3}) {
      const View view = orthographic({0, 0, 0}, {std::sqrt(1.0 - mu * mu), -mu, 0.0}, 1.0, 5.0);
      EXPECT_NEAR(mean(scene, view, 32, 256, 1).y, 1.0, 0.01)
          << "metallic " << metallic << ", roughness " << roughness << ", cosine " << mu;
    }
  }
}

} // namespace
} // namespace wavepath::test
