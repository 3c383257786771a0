// Whole renders of materials that a picture alone can prove: bodies that scatter, glass that disperses, normal maps.
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/integrators/path/kind.h"
#include "host/render/render.h"
#include "host/scene/gltf/tangents.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"
#include "tests/scene_builder.h"
#include "tests/shared_kernels.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {
namespace {

constexpr double kPi = std::numbers::pi;

class MaterialRender : public VulkanTest {
protected:
  Picture render_picture(Scene scene, const View& view, std::uint32_t side, std::uint32_t spp, std::uint32_t depth,
                         std::uint32_t direct = gpu::kDirectMis) {
    RenderPlan asked;
    asked.width = asked.height = side;
    asked.last_sample = spp;
    asked.max_depth = depth;
    asked.integrator = &kPath;
    asked.filter = gpu::kFilterBox;
    asked.direct = direct;
    const PackedScene packed = pack(scene, {.direct = direct});
    return render(device(), packed, view, asked, RenderHooks{}, shared_kernels(device())).picture;
  }
  // Mean over the picture.
  glm::dvec3 mean(const Scene& scene, const View& view, std::uint32_t side, std::uint32_t spp, std::uint32_t depth,
                  std::uint32_t direct = gpu::kDirectMis) {
    const Picture picture = render_picture(scene, view, side, spp, depth, direct);
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

std::vector<glm::vec3> slab(float low, float high) {
  std::vector<glm::vec3> mesh = box({20.0f, 0.5f * (high - low), 20.0f});
  for (glm::vec3& p : mesh) p.y += 0.5f * (high + low);
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

// The fraction of once scattered light that goes on into the forward hemisphere, by Henyey and Greenstein.
double forward_fraction(double g) {
  return (1.0 - g * g) / (2.0 * g) * (1.0 / (1.0 - g) - 1.0 / std::sqrt(1.0 + g * g));
}

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
    EXPECT_NEAR(seen, 1.0 - forward_fraction(g), g > 0.0 ? 0.012 : 0.04) << "g " << g;
  }
}

// A floor under fog of ior 1 has what the sun keeps on its way, whatever the walls: rough, tinted, nested, overlapping,
// mirrored.
TEST_F(MaterialRender, FogDimsTheSun) {
  constexpr float kThick = 0.3f, kOther = 0.9f;
  constexpr double kCosine = 0.8, kAbove = 0.5; // of the sun; the camera above the floor, which lies at y = -1
  Material fog = clear_body(1.0f), other = clear_body(1.0f), glass = clear_body(1.0f);
  fog.attenuation = glm::vec3(kThick), other.attenuation = glm::vec3(kOther);
  glass.volume = false;
  glass.base_color = {0.5f, 0.5f, 0.5f, 1.0f};
  const auto narrow = [](float low, float high) {
    std::vector<glm::vec3> mesh = slab(low, high);
    for (glm::vec3& p : mesh) p.x *= 0.8f, p.z *= 0.8f;
    return mesh;
  };
  struct Case {
    const char* name;
    std::vector<std::pair<std::vector<glm::vec3>, Material>> bodies;
    double fog, other; // metres up
    double passed = 1.0;
    bool mirrored = false;
  };
  Material rough = fog, tinted = fog;
  rough.roughness = 1.0f;
  tinted.base_color = {0.25f, 0.25f, 0.25f, 1.0f};
  const std::vector<glm::vec3> around = slab(-2.0f, 2.0f);
  for (const Case& c :
       std::vector<Case>{{"around all", {{around, fog}}, 3.0, 0.0},
                         {"above all", {{slab(0.0f, 1.5f), fog}}, 1.5, 0.0},
                         {"rough", {{around, rough}}, 3.0, 0.0},
                         {"tinted", {{around, tinted}}, 3.0, 0.0, 0.25},
                         {"mirrored", {{around, fog}}, 3.0, 0.0, 1.0, true},
                         {"nested", {{around, fog}, {narrow(0.0f, 1.0f), other}}, 2.0, 1.0},
                         {"overlapping", {{around, fog}, {narrow(1.5f, 3.0f), other}}, 2.5, 1.5},
                         {"one above the other", {{around, fog}, {slab(2.5f, 3.5f), other}}, 3.0, 1.0},
                         {"around and within", {{around, fog}, {narrow(-1.8f, 1.0f), other}}, 1.0, 2.0},
                         {"a pane above", {{around, fog}, {slab(4.0f, 4.0f), glass}}, 3.0, 0.0, 0.25}}) {
    Scene scene;
    scene.path = "test";
    scene.materials.push_back(plain_material());
    std::vector<glm::vec3> floor;
    add_face(floor, {-9, -1, -9}, {-9, -1, 9}, {9, -1, 9}, {9, -1, -9});
    add_instance(scene, add_mesh(scene, floor));
    for (const auto& [mesh, material] : c.bodies) {
      scene.materials.push_back(material);
      const glm::dmat4 place(glm::dvec4(c.mirrored ? -1 : 1, 0, 0, 0), {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1});
      add_instance(scene, add_mesh(scene, mesh, static_cast<std::uint32_t>(scene.materials.size() - 1)), place);
    }
    PunctualLight sun;
    sun.kind = LightKind::directional;
    sun.direction = {0.6, -0.8, 0.0};
    scene.lights.push_back(sun);
    const bool camera_in_fog = c.name != std::string("above all"),
               in_other = c.name == std::string("around and within");
    const double eye = !camera_in_fog ? 0.0 : in_other ? kOther * kAbove : kThick * kAbove;
    const double passed = c.passed * std::exp(-(kThick * c.fog + kOther * c.other) / kCosine - eye);
    const double expected = 0.5 / kPi * kCosine * passed;
    EXPECT_NEAR(mean(scene, orthographic({0, -1, 0}, {0, -1, 0}, 0.01, kAbove), 2, 4, 6).y, expected, 2e-5 * expected)
        << c.name;
  }
}

// A lamp within milk that bends light, which no shadow ray could leave, lights it: radiance of a thin body that
// scatters once.
TEST_F(MaterialRender, LampsWithinBodiesLightThem) {
  constexpr float kDensity = 0.01f; // per metre: little is scattered twice
  for (const float ior : {1.0f, 1.33f}) {
    Material milk = clear_body(ior);
    milk.attenuation = milk.scattering = glm::vec3(kDensity);
    Scene scene = body_scene(box(glm::vec3(1.0f)), milk);
    scene.environment.radiance = glm::vec3(0.0f);
    PunctualLight lamp;
    lamp.position = {0.0, 0.5, 0.0};
    scene.lights.push_back(lamp);
    // Along x from the eye within, past the lamp at half a metre: the integral of p I / (x^2 + 1/4).
    View view = orthographic({0, 0, 0}, {1, 0, 0}, 1e-3, 0.9);
    const double expected = kDensity / (4.0 * kPi) * 2.0 * (std::atan(2.0 * 0.9) + std::atan(2.0));
    EXPECT_NEAR(mean(scene, view, 8, 4096, 1).y, expected, 0.04 * expected) << ior;
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

// ---- cut-offs -------------------------------------------------------------------------------------------------------

// Alpha that equals the cut-off is kept at every point, whatever the weights of the corners and of texels round to.
TEST_F(MaterialRender, CutoffsKeepWhatEqualsThem) {
  struct Case {
    float vertex, factor;
    int texel; // of 255
  };
  for (const Case& c : {Case{1.0f, 1.0f, 255}, Case{0.5f, 1.0f, 255}, Case{0.3f, 1.0f, 255}, Case{1.0f, 0.3f, 255},
                        Case{128 / 255.0f, 0.7f, 255}, Case{1.0f, 1.0f, 77}, Case{0.3f, 0.9f, 200}}) {
    Scene scene;
    scene.path = "test";
    Material leaf = plain_material();
    leaf.unlit = true;
    leaf.base_color = {1.0f, 1.0f, 1.0f, c.factor};
    leaf.alpha_mode = AlphaMode::mask;
    leaf.alpha_cutoff = c.factor * c.vertex * (static_cast<float>(c.texel) / 255.0f);
    leaf.base_color_texture.image = 0;
    leaf.base_color_texture.wrap_u = leaf.base_color_texture.wrap_v = Wrap::clamp;
    Image image{.name = "leaf", .width = 4, .height = 2};
    for (int i = 0; i < 8; ++i) // clear on the left, so that the host cannot tell all of it
      image.bytes.insert(image.bytes.end(), {255, 255, 255, static_cast<std::uint8_t>(i % 4 == 0 ? 0 : c.texel)});
    scene.images = {image};
    scene.materials = {leaf};
    const glm::vec3 a{-1.0f, -0.98f, 0}, b{1.01f, -1, 0}, d{-1, 1.03f, 0}, e{0.97f, 1, 0};
    const std::uint32_t quad = add_mesh(scene, {a, b, e, a, e, d});
    for (const glm::vec3& p : scene.meshes[quad].positions) {
      scene.meshes[quad].uvs[0].push_back(0.5f + 0.49f * glm::vec2(p));
      scene.meshes[quad].colors.emplace_back(1.0f, 1.0f, 1.0f, c.vertex);
    }
    add_instance(scene, quad);
    const glm::dvec3 seen = mean(scene, orthographic({0.4, 0, 0}, {0, 0, -1}, 0.5, 5.0), 32, 16, 1);
    EXPECT_EQ(seen, glm::dvec3(1.0)) << c.vertex << " x " << c.factor << " x " << c.texel;
  }
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

// Facet, smooth normal and map that lean different ways: light samples find no light that drawn directions do not.
TEST_F(MaterialRender, BentNormalsReturnWhatArrives) {
  Scene scene;
  scene.path = "test";
  Environment& sky = scene.environment; // a picture, which light samples look for
  sky.radiance = glm::vec3(1.0f);
  sky.width = 8, sky.height = 4;
  sky.map.assign(32, glm::vec3(1.0f));
  Material matt = plain_material();
  matt.base_color = glm::vec4(1.0f);
  matt.normal_texture.image = 0;
  scene.materials = {matt};
  const auto byte = [](double v) { return static_cast<std::uint8_t>(std::lround(127.5 + 127.5 * v)); };
  scene.images = {{"lean", 1, 1, {byte(-std::sin(0.6)), byte(0.0), byte(std::cos(0.6)), 255}, {}}};
  const std::uint32_t floor = add_mesh(scene, {{-9, 0, -9}, {9, 0, 9}, {9, 0, -9}, {-9, 0, -9}, {-9, 0, 9}, {9, 0, 9}});
  Mesh& mesh = scene.meshes[floor];
  mesh.normals.assign(6, glm::vec3(std::sin(0.5f), std::cos(0.5f), 0.0f));
  mesh.tangents.assign(6, glm::vec4(std::cos(0.5f), -std::sin(0.5f), 0.0f, 1.0f));
  mesh.uvs[0].assign(6, glm::vec2(0.5f));
  mesh.primitives[0].has_normals = true;
  add_instance(scene, floor);
  const View view = orthographic({0, 0, 0}, {0, -1, 0}, 1.0, 5.0);
  const double expected = mean(scene, view, 16, 256, 1, gpu::kDirectBsdf).y;
  EXPECT_GT(expected, 0.9);
  for (const std::uint32_t estimator : {gpu::kDirectNee, gpu::kDirectMis})
    EXPECT_NEAR(mean(scene, view, 16, 256, 1, estimator).y, expected, 0.004) << estimator;
}

// ---- texture transforms ---------------------------------------------------------------------------------------------

// A textured quad that is turned and leaning, with generated tangents.
Scene mapped_quad(const Material& material, const glm::mat2& first, const glm::mat2& second) {
  Scene scene;
  scene.path = "test";
  PunctualLight sun;
  sun.kind = LightKind::directional;
  sun.direction = glm::normalize(glm::dvec3(-1, -2, -1));
  sun.intensity = glm::vec3(3.0f);
  scene.lights = {sun};
  scene.materials = {material};
  Image slopes{.name = "slopes", .width = 4, .height = 4};
  for (int i = 0; i < 16; ++i)
    slopes.bytes.insert(slopes.bytes.end(), {static_cast<std::uint8_t>(60 + 40 * (i % 4)),
                                             static_cast<std::uint8_t>(90 + 20 * (i / 4)), 220, 255});
  Image grain = slopes;
  for (std::size_t i = 2; i < grain.bytes.size(); i += 4) grain.bytes[i] = 255;
  scene.images = {slopes, grain};
  const glm::vec3 a{-1, 0, -1}, b{-1, 0.2f, 1}, c{1, 0.1f, 1}, d{1, -0.1f, -1};
  const std::uint32_t quad = add_mesh(scene, {a, b, c, a, c, d});
  Mesh& mesh = scene.meshes[quad];
  for (const glm::vec3& p : mesh.positions) {
    const glm::vec2 uv(0.4f * p.x + 0.1f * p.z, 0.3f * p.z);
    mesh.uvs[0].push_back(first * uv), mesh.uvs[1].push_back(second * uv);
  }
  add_tangents(mesh, material);
  add_instance(scene, quad);
  return scene;
}

// A texture that is moved looks as one whose coordinates were: its tangents go with it, of each texture by itself.
TEST_F(MaterialRender, TangentsGoWithTheTexture) {
  const View view = orthographic({0, 0, 0}, glm::normalize(glm::dvec3(0.3, -1, -0.2)), 0.7, 5.0);
  const glm::mat2 same(1.0f), turned(0.0f, 1.0f, -1.0f, 0.0f), mirrored(1.0f, 0.0f, 0.0f, -1.5f),
      sheared(1.0f, 0.5f, 0.8f, 1.2f);
  for (const auto& [first, second] :
       {std::pair{turned, same}, {mirrored, turned}, {same, sheared}, {sheared, mirrored}}) {
    for (const bool coated : {true, false}) {
      Material m = plain_material();
      m.specular = 1.0f, m.roughness = 0.5f, m.base_color = {0.3f, 0.5f, 0.8f, 1.0f};
      m.normal_texture.image = 0;
      TextureSlot& layer = coated ? m.coat_normal_texture : m.anisotropy_texture;
      layer.image = coated ? 0 : 1;
      if (coated)
        m.coat = 1.0f, m.coat_roughness = 0.4f;
      else
        m.metallic = 1.0f, m.anisotropy = 0.8f, m.anisotropy_rotation = 0.4f;
      Material moved = m;
      moved.normal_texture.uv_matrix = first;
      (coated ? moved.coat_normal_texture : moved.anisotropy_texture).uv_matrix = second;
      layer.uv_set = 1;
      const auto by_transform = render_picture(mapped_quad(moved, same, same), view, 16, 4, 1),
                 by_coordinates = render_picture(mapped_quad(m, first, second), view, 16, 4, 1);
      const auto judge = [&](const Picture& found, const Picture& expected, const char* what) {
        double difference = 0.0, light = 0.0;
        for (std::size_t i = 0; i < 256; ++i) {
          const double value = expected.channels[1].values[i];
          difference += std::abs(found.channels[1].values[i] - value), light += value;
        }
        EXPECT_GT(light, 1.0);
        EXPECT_LT(difference, 2e-3 * light) << what << ", " << (coated ? "coat" : "grain");
      };
      judge(by_transform, by_coordinates, "both maps");
      // Beside a map that bends nothing, the layer is as it is alone.
      Scene beside = mapped_quad(moved, same, same), alone = mapped_quad(m, first, second);
      beside.images.push_back({.name = "flat", .width = 1, .height = 1, .floats = {0.5f, 0.5f, 1.0f, 1.0f}});
      beside.materials[0].normal_texture.image = 2;
      alone.materials[0].normal_texture = {};
      alone.meshes[0].tangents.clear();
      for (auto& tangents : alone.meshes[0].layer_tangents) tangents.clear();
      add_tangents(alone.meshes[0], alone.materials[0]);
      judge(render_picture(beside, view, 16, 4, 1), render_picture(alone, view, 16, 4, 1), "one map");
    }
  }
}

} // namespace
} // namespace wavepath::test
