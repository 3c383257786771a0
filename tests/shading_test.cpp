// Local illumination: the formulas of its models, where it is evaluated, and what each of that gets wrong.
#include "tests/shadow_scene.h"

#include <array>
#include <numbers>
#include <set>

#include <gtest/gtest.h>

#include "host/base/error.h"
#include "host/integrators/hybrid/shading/catalogue.h"
#include "host/render/settings/settings_table.h"
#include "host/render/settings/shading_settings.h"

namespace wavepath::test {
namespace {

constexpr double kPi = std::numbers::pi;

RenderPlan shading_settings(std::string_view model, std::string_view interpolation = "phong") {
  RenderPlan settings = shadow_settings("traced", 1024);
  settings.shading = index_of(kShadingModels.names(), model);
  settings.interpolation = index_of(kInterpolationNames, interpolation);
  settings.aovs = {"position", "depth"};
  return settings;
}

// Half of a dielectric that reflects nothing, half of metal: diffuse and highlight both have half of the colour.
constexpr float kColour = 0.5f;
Material shiny_material() {
  Material material = plain_material();
  material.metallic = 0.5f;
  return material;
}

constexpr glm::dvec3 kLamp(0.3, 1.5, -0.2);
constexpr double kIntensity = 20.0;

// Triangles of which pixels can be told, under a lamp and an eye.
Scene floor_scene(const std::vector<glm::vec3>& corners, const Material& material) {
  Scene scene;
  scene.path = "test";
  scene.materials.push_back(material);
  add_instance(scene, add_mesh(scene, corners));
  scene.lights.push_back(lamp(kLamp));
  scene.cameras.push_back(camera_above({0, 0, 0}, 0.9));
  return scene;
}
Scene quad_scene(const Material& material) {
  return floor_scene(rectangle({0, 0, 0}, {0, 0, 1}, {1, 0, 0}), material); // faces up
}

struct Seen {
  glm::dvec3 position;
  double depth, light;
};
std::vector<Seen> seen_points(const Picture& picture) {
  std::vector<Seen> seen;
  const auto &x = channel(picture, "P.X"), &y = channel(picture, "P.Y"), &z = channel(picture, "P.Z"),
             &depth = channel(picture, "Z"), &light = channel(picture, "G");
  for (std::size_t i = 0; i < light.size(); ++i)
    if (std::isfinite(depth[i]) && depth[i] > 0.0f && depth[i] < 1e9f)
      seen.push_back({{x[i], y[i], z[i]}, depth[i], light[i]});
  EXPECT_GT(seen.size(), 1000u);
  return seen;
}

// What a floor point of that colour sends straight up, of light that falls off by 1 / (a + b d + c d^2).
double expected(std::string_view model, glm::dvec3 p, double exponent, glm::dvec3 falloff = {0, 0, 1}) {
  const glm::dvec3 n(0, 1, 0), wo(0, 1, 0), offset = kLamp - p, wi = glm::normalize(offset);
  const double d = glm::length(offset);
  const double irradiance = kIntensity * wi.y / (falloff.x + falloff.y * d + falloff.z * d * d);
  if (model == "lambert") return irradiance * kColour / kPi;
  double highlight = 0.0;
  if (model == "phong")
    highlight = (exponent + 2.0) / (2.0 * kPi) * std::pow(std::max(glm::dot(wo, glm::reflect(-wi, n)), 0.0), exponent);
  else
    highlight = (exponent + 8.0) / (8.0 * kPi) * std::pow(glm::dot(n, glm::normalize(wi + wo)), exponent);
  return irradiance * kColour * 0.5 * (1.0 / kPi + highlight);
}

using ShadingTest = ShadowTest;

TEST_F(ShadingTest, ModelsAreTheirFormulas) {
  for (const std::string_view model : {"lambert", "phong", "blinn-phong"}) {
    SCOPED_TRACE(model);
    const bool shines = model != "lambert";
    RenderPlan settings = shading_settings(model);
    if (shines) settings.shininess = 20.0;
    const Scene scene = quad_scene(shines ? shiny_material() : plain_material());
    for (const Seen& seen : seen_points(render(scene, settings).picture))
      ASSERT_NEAR(seen.light / expected(model, seen.position, 20.0), 1.0, 1e-4);
  }
}

TEST_F(ShadingTest, LambertOfMattSurfacesIsGltf) {
  for (const auto& [name, scene] :
       {std::pair{"sun", lit_by(sun())}, {"lamp", lit_by(lamp())}, {"square", lit_by_square()}}) {
    SCOPED_TRACE(name);
    const std::vector<float> gltf = light(scene, shading_settings("gltf")),
                             lambert = light(scene, shading_settings("lambert"));
    for (std::size_t i = 0; i < gltf.size(); ++i) ASSERT_NEAR(lambert[i], gltf[i], 1e-5f * gltf[i]) << i;
  }
}

// Shadow techniques know nothing of the model: what they falsely light and darken stays.
TEST_F(ShadingTest, ShadowTechniquesAnswerItsRays) {
  const Scene scene = lit_by(spot());
  RenderPlan local = shading_settings("blinn-phong"), gltf = shading_settings("gltf");
  local.shadows = gltf.shadows = index_of(kShadowTechniques.names(), "map");
  const std::vector<float> a = light(scene, local), b = light(scene, gltf);
  EXPECT_EQ(false_fractions(a, b).total(), 0.0);
  EXPECT_GT(false_fractions(light(scene, shading_settings("blinn-phong")), a).total(), 0.0); // it is a map
}

TEST_F(ShadingTest, ExponentsFollowFromRoughness) {
  Material material = shiny_material();
  material.roughness = 0.5f; // alpha = 1/4: Blinn's exponent is 2 / alpha^2 - 2 = 30, Phong's a quarter of it
  const Scene scene = quad_scene(material);
  for (const auto& [model, exponent] : {std::pair{"phong", 7.5}, {"blinn-phong", 30.0}}) {
    SCOPED_TRACE(model);
    RenderPlan told = shading_settings(model);
    told.shininess = exponent;
    const std::vector<float> a = light(scene, shading_settings(model)), b = light(scene, told);
    for (std::size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], 1e-5f * b[i]);
  }
}

// The triangle of these corners, the upper side of which is the first octant's.
const std::array<glm::dvec3, 3> kCorners = {{{-0.8, 0, -0.8}, {-0.7, 0, 0.9}, {0.9, 0, -0.6}}};
std::vector<glm::vec3> triangle() { return {kCorners[0], kCorners[1], kCorners[2]}; }

glm::dvec3 weights_at(glm::dvec3 p) {
  const glm::dmat2 sides(glm::dvec2(kCorners[1].x - kCorners[0].x, kCorners[1].z - kCorners[0].z),
                         glm::dvec2(kCorners[2].x - kCorners[0].x, kCorners[2].z - kCorners[0].z));
  const glm::dvec2 b = glm::inverse(sides) * glm::dvec2(p.x - kCorners[0].x, p.z - kCorners[0].z);
  return {1.0 - b.x - b.y, b.x, b.y};
}

// And so it is Phong's interpolation in a corner, where one of the weights is 1.
TEST_F(ShadingTest, GouraudInterpolatesTheLightOfCorners) {
  RenderPlan settings = shading_settings("blinn-phong", "gouraud");
  settings.shininess = 10.0;
  for (const Seen& seen : seen_points(render(floor_scene(triangle(), shiny_material()), settings).picture)) {
    const glm::dvec3 weights = weights_at(seen.position);
    double sum = 0.0;
    for (int i = 0; i < 3; ++i) sum += weights[i] * expected("blinn-phong", kCorners[i], 10.0);
    ASSERT_NEAR(seen.light / sum, 1.0, 2e-4);
  }
}

// Barycentrics of an image would curve where the triangle leans away from the eye; those of the triangle do not.
TEST_F(ShadingTest, GouraudIsCorrectInPerspective) {
  Scene scene = floor_scene(triangle(), shiny_material());
  scene.materials[0].metallic = 0.0f; // highlights of corners would follow the eye
  const glm::dvec3 eye(-1.2, 0.5, 1.4), forward = glm::normalize(-eye);
  const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(0, 1, 0))), up = glm::cross(right, forward);
  Camera& camera = scene.cameras[0];
  camera.orthographic = false;
  camera.world_from_camera = {glm::dvec4(right, 0), glm::dvec4(up, 0), glm::dvec4(-forward, 0), glm::dvec4(eye, 1)};
  for (const Seen& seen : seen_points(render(scene, shading_settings("lambert", "gouraud")).picture)) {
    const glm::dvec3 weights = weights_at(seen.position);
    double sum = 0.0;
    for (int i = 0; i < 3; ++i) sum += weights[i] * expected("lambert", kCorners[i], 0.0);
    ASSERT_NEAR(seen.light / sum, 1.0, 5e-4);
  }
}

TEST_F(ShadingTest, GouraudMissesHighlightsInsideATriangle) {
  const auto brightest = [&](std::string_view interpolation) {
    RenderPlan settings = shading_settings("phong", interpolation);
    settings.shininess = 100.0;
    return std::ranges::max(light(quad_scene(shiny_material()), settings));
  };
  EXPECT_GT(brightest("phong"), 10.0f * brightest("gouraud"));
}

TEST_F(ShadingTest, FlatHasOneLightAFace) {
  RenderPlan settings = shading_settings("phong", "flat");
  settings.shininess = 5.0;
  std::set<double> lights;
  for (const Seen& seen : seen_points(render(quad_scene(shiny_material()), settings).picture))
    lights.insert(seen.light);
  EXPECT_EQ(lights.size(), 2u); // of the quad's two triangles
  for (const double one : lights) {
    const glm::dvec3 middles[] = {
        {1.0 / 3, 0, 1.0 / 3}, {-1.0 / 3, 0, -1.0 / 3}, {1.0 / 3, 0, -1.0 / 3}, {-1.0 / 3, 0, 1.0 / 3}};
    EXPECT_TRUE(std::ranges::any_of(
        middles, [&](glm::dvec3 p) { return std::abs(one / expected("phong", p, 5.0) - 1.0) < 1e-4; }));
  }
}

// Normals of vertices make a flat mesh look round, but for its outline; flat shading shows the mesh.
TEST_F(ShadingTest, FlatKnowsNothingOfVertexNormals) {
  Scene scene = floor_scene(triangle(), plain_material());
  Mesh& mesh = scene.meshes[0];
  mesh.normals = {glm::normalize(glm::vec3(-1, 1, -1)), glm::normalize(glm::vec3(-1, 1, 1)),
                  glm::normalize(glm::vec3(1, 1, -1))};
  mesh.primitives[0].has_normals = true;
  const std::vector<float> flat = light(scene, shading_settings("lambert", "flat"));
  const std::vector<float> smooth = light(scene, shading_settings("lambert", "phong"));
  std::set<float> lights(flat.begin(), flat.end());
  EXPECT_EQ(lights.size(), 2u); // the triangle's and none
  EXPECT_GT(std::set<float>(smooth.begin(), smooth.end()).size(), 100u);
}

TEST_F(ShadingTest, AttenuationIsItsPolynomial) {
  RenderPlan settings = shading_settings("lambert");
  for (const glm::vec3 terms : {glm::vec3(1, 0, 0), glm::vec3(0.5f, 0.25f, 2), glm::vec3(0, 0, 1)}) {
    settings.attenuation = terms;
    for (const Seen& seen : seen_points(render(quad_scene(plain_material()), settings).picture))
      ASSERT_NEAR(seen.light / expected("lambert", seen.position, 0.0, terms), 1.0, 1e-4);
  }
}

// A leaning wall that shows its own colour reaches from before NEAR to behind FAR.
TEST_F(ShadingTest, DepthCueFadesIntoTheBackground) {
  Material material = plain_material();
  material.unlit = true;
  material.base_color = {0.8f, 0.8f, 0.8f, 1.0f};
  Scene scene = floor_scene(rectangle({0, 0, 0}, {0, 0, 1}, {1, 1, 0}), material);
  scene.lights.clear();
  scene.environment.radiance = glm::vec3(0.25f);
  RenderPlan settings = shading_settings("lambert");
  settings.depth_cue = glm::vec2(2.6f, 3.5f);
  int near = 0, far = 0, between = 0;
  for (const Seen& seen : seen_points(render(scene, settings).picture)) {
    const double fraction = std::clamp((3.5 - seen.depth) / (3.5 - 2.6), 0.0, 1.0);
    ASSERT_NEAR(seen.light, fraction * 0.8 + (1.0 - fraction) * 0.25, 1e-5) << seen.depth;
    ++(fraction == 1.0 ? near : fraction == 0.0 ? far : between);
  }
  EXPECT_GT(std::min({near, far, between}), 100);
}

// Reflected light and the ambient term fade as well: behind FAR there is nothing but the background.
TEST_F(ShadingTest, DepthCueHidesAllLightBehindFar) {
  Scene scene = lit_by(sun());
  RenderPlan settings = shading_settings("blinn-phong");
  settings.max_depth = 4;
  settings.ambient = glm::vec3(0.5f);
  EXPECT_GT(std::ranges::max(light(scene, settings)), 0.1f);
  settings.depth_cue = glm::vec2(0.1f, 0.2f);
  EXPECT_EQ(std::ranges::max(light(scene, settings)), 0.0f);
}

TEST(ShadingSettings, RefusesWhatAModelDoesNotTake) {
  const auto refusal = [](const RenderPlan& settings) {
    try {
      settings.integrator->check(settings);
    } catch (const UsageError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(refusal(shading_settings("lambert", "gouraud")), "");
  EXPECT_NE(refusal(shading_settings("gltf", "flat")).find("--interpolation"), std::string::npos);
  RenderPlan settings = shading_settings("lambert");
  settings.shininess = 3.0;
  EXPECT_NE(refusal(settings).find("--shininess"), std::string::npos);
  settings = shading_settings("phong");
  settings.shininess = 3.0;
  EXPECT_EQ(refusal(settings), "");
  settings.direct = gpu::kDirectBsdf;
  EXPECT_NE(refusal(settings).find("--direct bsdf"), std::string::npos);
  for (const auto& [flag, text] :
       {std::pair{"attenuation", "0,0,0"}, {"attenuation", "-1,0,1"}, {"depth-cue", "3,2"}, {"depth-cue", "3"}}) {
    RenderPlan any;
    EXPECT_THROW(read_setting(setting_named(flag), text, any), UsageError) << flag << " " << text;
  }
}

} // namespace
} // namespace wavepath::test
