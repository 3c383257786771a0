// Techniques of reflections: against closed forms, against path tracing, and against mirrored rays.
#include "tests/shadow_scene.h"

#include <numbers>

#include <gtest/gtest.h>

#include "host/base/error.h"
#include "host/integrators/hybrid/antialias/catalogue.h"
#include "host/integrators/hybrid/reflections/catalogue.h"
#include "host/integrators/hybrid/shading/catalogue.h"
#include "host/integrators/path/kind.h"
#include "host/integrators/whitted/kind.h"

namespace wavepath::test {
namespace {

constexpr double kMetal = 0.8, kGrey = 0.5; // what the mirror reflects head-on, and the surfaces that it shows

// One frame through the middles of pixels. The ambient term is black, so that all light is known.
RenderPlan settings_for(std::string_view technique) {
  RenderPlan settings = shadow_settings("traced");
  settings.width = settings.height = 48;
  settings.max_depth = 2;
  settings.ambient = glm::vec3(0.0f);
  settings.antialias = index_of(kAntialiasTechniques.names(), "none");
  settings.reflections = index_of(kReflectionTechniques.names(), technique);
  return settings;
}

Material mirror_material(double base = kMetal) {
  Material material = plain_material();
  material.base_color = glm::vec4(glm::vec3(static_cast<float>(base)), 1.0f);
  material.metallic = 1.0f;
  material.roughness = 0.0f;
  return material;
}

constexpr double kLampHeight = 2.0, kCeiling = 4.0, kHalf = 0.9;

// A floor of this material, seen from straight above, and a grey ceiling behind the eye that a lamp between them
// lights.
Scene under_a_ceiling(const Material& floor) {
  Scene scene;
  scene.path = "test";
  scene.materials = {floor, plain_material()};
  add_instance(scene, add_mesh(scene, rectangle({0, 0, 0}, {0, 0, 2}, {2, 0, 0})));
  add_instance(scene, add_mesh(scene, rectangle({0, kCeiling, 0}, {2, 0, 0}, {0, 0, 2}), 1));
  scene.lights.push_back(lamp({0.3, kLampHeight, 0.2}));
  scene.cameras.push_back(camera_above({0, 0, 0}, kHalf));
  return scene;
}

// Radiance of that ceiling straight above a pixel, row by row.
std::vector<double> ceiling_light(std::uint32_t side) {
  std::vector<double> light;
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x) {
      const glm::dvec3 at((2.0 * (x + 0.5) / side - 1.0) * kHalf, kCeiling, (2.0 * (y + 0.5) / side - 1.0) * kHalf),
          offset = glm::dvec3(0.3, kLampHeight, 0.2) - at;
      const double d2 = glm::dot(offset, offset), cosine = (kCeiling - kLampHeight) / std::sqrt(d2);
      light.push_back(kGrey / std::numbers::pi * 20.0 * cosine / d2);
    }
  return light;
}

class ReflectionsTest : public ShadowTest {
protected:
  // What reflections add to each pixel.
  std::vector<double> added(const Scene& scene, RenderPlan settings) {
    const std::vector<float> with = light(scene, settings);
    settings.reflections = 0;
    const std::vector<float> without = light(scene, settings);
    std::vector<double> difference;
    for (std::size_t i = 0; i < with.size(); ++i) difference.push_back(double{with[i]} - double{without[i]});
    return difference;
  }
  void expect_ceiling(const Material& floor, const RenderPlan& settings, double reflectance) {
    const std::vector<double> reflected = added(under_a_ceiling(floor), settings), known = ceiling_light(48);
    for (std::size_t i = 0; i < known.size(); ++i)
      ASSERT_NEAR(reflected[i], reflectance * known[i], 2e-5 * known[i]) << "pixel " << i;
  }
};

TEST(Reflections, EveryValueIsATechnique) { expect_names_of_own(kReflectionTechniques); }

TEST_F(ReflectionsTest, AMirrorShowsALitSurface) {
  expect_ceiling(mirror_material(), settings_for("traced"), kMetal);
  RenderPlan settings = settings_for("traced");
  settings.shadow_samples = 3;
  expect_ceiling(mirror_material(), settings, kMetal);
}

TEST_F(ReflectionsTest, SurfacesThatAMirrorShowsAreShadedAsTheFramesOwn) {
  RenderPlan settings = settings_for("traced");
  settings.shading = index_of(kShadingModels.names(), "lambert");
  expect_ceiling(mirror_material(), settings, kMetal);
}

TEST_F(ReflectionsTest, SurfacesThatAMirrorShowsHaveTheAmbientTerm) {
  Scene scene = under_a_ceiling(mirror_material());
  scene.lights.clear();
  RenderPlan settings = settings_for("traced");
  settings.ambient = glm::vec3(0.7f);
  for (const double value : added(scene, settings)) ASSERT_NEAR(value, kMetal * kGrey * 0.7, 1e-6);
}

// Hall's rule: what reflects too little, or is too rough, sends no rays.
TEST_F(ReflectionsTest, OnlySurfacesThatReflectEnoughAreMirrors) {
  Material plastic = plain_material();
  plastic.specular = 1.0f; // 4 % head-on
  plastic.roughness = 0.0f;
  expect_ceiling(plastic, settings_for("traced"), 0.0);
  RenderPlan settings = settings_for("traced");
  settings.reflection_threshold = 0.03;
  expect_ceiling(plastic, settings, 0.04);
  settings.reflection_threshold = 0.9;
  expect_ceiling(mirror_material(), settings, 0.0);
  Material rough = mirror_material();
  rough.roughness = 0.31f;
  expect_ceiling(rough, settings_for("traced"), 0.0);
  EXPECT_EQ(render(under_a_ceiling(rough), settings_for("traced")).reflections->asked, 0u);
  EXPECT_EQ(render(under_a_ceiling(mirror_material()), settings_for("traced")).reflections->asked, 48u * 48u);
}

void look_at(Scene& scene, glm::dvec3 eye, glm::dvec3 target) {
  const glm::dvec3 forward = glm::normalize(target - eye),
                   right = glm::normalize(glm::cross(forward, glm::dvec3(0, 1, 0))), up = glm::cross(right, forward);
  Camera camera;
  camera.world_from_camera = {glm::dvec4(right, 0), glm::dvec4(up, 0), glm::dvec4(-forward, 0), glm::dvec4(eye, 1)};
  scene.cameras = {camera};
}

// Boxes on a mirror. Where the picture without reflections is black it shows the mirror.
Scene bodies_on_a_mirror(double base = 1.0) {
  Scene scene = lit_by(sun({0.3, -1.0, -0.6}));
  scene.materials.push_back(mirror_material(base));
  scene.meshes[0].primitives[0].material = 1;
  look_at(scene, {0.6, 1.2, 3.0}, {0.1, 0.3, 0.0});
  return scene;
}

// A perfect mirror adds paths of two bounces whose first one is the mirror's. Nothing but edges differs between one
// position in the pixel and many, as the light of a face is the same everywhere.
TEST_F(ReflectionsTest, TracedMirrorsAgreeWithPathTracing) {
  const Scene scene = bodies_on_a_mirror();
  RenderPlan settings = settings_for("traced");
  const std::vector<float> traced = light(scene, settings);
  const std::vector<double> reflected = added(scene, settings);
  RenderPlan paths = settings;
  paths.integrator = &kPath;
  paths.reflections = paths.antialias = 0;
  paths.ambient.reset();
  paths.last_sample = 16;
  const std::vector<float> truth = light(scene, paths);
  std::size_t mirrors = 0, same = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (reflected[i] != traced[i]) continue; // there is direct light: no mirror
    ++mirrors;
    if (std::abs(truth[i] - traced[i]) <= 1e-4 * traced[i]) ++same;
  }
  ASSERT_GT(mirrors, truth.size() / 3);
  EXPECT_GT(static_cast<double>(same), 0.9 * static_cast<double>(mirrors));
  EXPECT_GT(std::ranges::count_if(reflected, [](double value) { return value > 0.1; }), 100);
}

// Rough mirrors draw facets, so that a frame is noise, and many are the highlight of the path tracer.
TEST_F(ReflectionsTest, MirrorsThatAreNotQuiteSmoothAgreeWithPathTracingOnAverage) {
  Scene scene = bodies_on_a_mirror();
  scene.materials[1].roughness = 0.25f;
  RenderPlan settings = settings_for("traced");
  settings.width = settings.height = 16;
  settings.last_sample = 128;
  settings.antialias = 0;
  settings.aovs = {"metallic"};
  const Picture ours = render(scene, settings).picture;
  settings.reflections = 0;
  const Picture without = render(scene, settings).picture;
  RenderPlan paths = settings;
  paths.integrator = &kPath;
  paths.ambient.reset();
  paths.last_sample = 512;
  const std::vector<float> two = light(scene, paths);
  paths.max_depth = 1;
  const std::vector<float> one = light(scene, paths);
  const std::vector<float>& mirror = channel(ours, "metallic");
  double reflected = 0.0, truth = 0.0;
  for (std::size_t i = 0; i < two.size(); ++i) {
    if (mirror[i] < 0.999f) continue; // boxes light each other in path tracing
    reflected += ours.channels[1].values[i] - without.channels[1].values[i];
    truth += two[i] - one[i];
  }
  EXPECT_GT(truth, 1.0);
  EXPECT_NEAR(reflected, truth, 0.03 * truth);
}

// ---- mirrors in mirrors -----------------------------------------------------------------------------------------

// Two mirrors at 45 degrees: the camera above the first one sees the second one in it, and in that a ceiling, which
// stands 4 metres aside of the camera. Paths over both have three bounces.
constexpr double kAside = 4.0;
Scene periscope(const Material& mirrors) {
  Scene scene;
  scene.path = "test";
  scene.materials = {mirrors, plain_material()};
  add_instance(scene, add_mesh(scene, rectangle({0, 0, 0}, {0, 0, 2}, {1.2f, -1.2f, 0})));
  add_instance(scene, add_mesh(scene, rectangle({kAside, 0, 0}, {0, 0, 2}, {1.2f, 1.2f, 0})));
  add_instance(scene, add_mesh(scene, rectangle({kAside, kCeiling, 0}, {2, 0, 0}, {0, 0, 2}), 1));
  scene.lights.push_back(lamp({kAside + 0.3, kLampHeight, 0.2}));
  scene.cameras.push_back(camera_above({0, 0, 0}, kHalf));
  return scene;
}

TEST_F(ReflectionsTest, AMirrorInAMirrorShowsALitSurface) {
  // The picture is that of the ceiling, whose x axis both mirrors turn. Fresnel's factor is that of Schlick, twice.
  const double once = kMetal + (1.0 - kMetal) * std::pow(1.0 - std::sqrt(0.5), 5.0);
  const std::vector<double> known = ceiling_light(48);
  for (const std::string_view technique : {"traced", "planar", "stencil"}) {
    RenderPlan settings = settings_for(technique);
    for (const double value : added(periscope(mirror_material()), settings)) ASSERT_EQ(value, 0.0) << technique;
    settings.max_depth = 3;
    settings.shadow_samples = technique == "traced" ? 3 : 1;
    const std::vector<double> reflected = added(periscope(mirror_material()), settings);
    for (std::size_t i = 0; i < known.size(); ++i) {
      const double light = known[i / 48 * 48 + 47 - i % 48];
      ASSERT_NEAR(reflected[i], once * once * light, 3e-5 * light) << technique << ", pixel " << i;
    }
  }
}

// Facets of both mirrors are drawn at random, each by numbers of its own.
TEST_F(ReflectionsTest, RoughMirrorsInRoughMirrorsAgreeWithPathTracingOnAverage) {
  Material rough = mirror_material();
  rough.roughness = 0.25f;
  const Scene scene = periscope(rough);
  RenderPlan settings = settings_for("traced");
  settings.width = settings.height = 16;
  settings.max_depth = 3;
  settings.last_sample = 256;
  settings.antialias = 0;
  RenderPlan paths = settings;
  paths.integrator = &kPath;
  paths.reflections = 0;
  paths.ambient.reset();
  paths.last_sample = 1024;
  // What the third bounce adds: that of the ceiling.
  const auto third = [&](RenderPlan plan) {
    const std::vector<float> three = light(scene, plan);
    plan.max_depth = 2;
    const std::vector<float> two = light(scene, plan);
    double sum = 0.0;
    for (std::size_t i = 0; i < three.size(); ++i) sum += three[i] - two[i];
    return sum;
  };
  const double truth = third(paths);
  EXPECT_GT(truth, 1.0);
  EXPECT_NEAR(third(settings), truth, 0.03 * truth);
}

// Bodies between a mirror below, two that face each other, one at an angle, and a wall.
Scene bodies_among_mirrors(double base) {
  Scene scene = bodies_on_a_mirror(base);
  add_instance(scene, add_mesh(scene, rectangle({0, 1.5f, -2}, {2, 0, 0}, {0, 1.5f, 0}), 1));
  add_instance(scene, add_mesh(scene, rectangle({0, 1.5f, 3.6f}, {2, 0, 0}, {0, 1.5f, 0}), 1));
  add_instance(scene, add_mesh(scene, rectangle({-2.2f, 1, 0}, {0.4f, 0, 1.2f}, {0, 1, 0}), 1));
  add_instance(scene, add_mesh(scene, rectangle({2, 1.5f, 0.8f}, {0, 0, 2.8f}, {0, 1.5f, 0})));
  return scene;
}

// Whitted's ray tracer follows perfect mirrors, and sends shadow rays from what they show. So do these frames, as deep
// as two mirrors. Pixels are compared that show no edge, as their neighbours tell: the light of a face is the same
// everywhere.
TEST_F(ReflectionsTest, MirrorsInMirrorsAgreeWithWhittedsRayTracer) {
  const Scene scene = bodies_among_mirrors(1.0);
  RenderPlan settings = settings_for("traced");
  settings.max_depth = 3;
  const std::vector<float> ours = light(scene, settings);
  settings.max_depth = 2;
  const std::vector<float> one_deep = light(scene, settings);
  RenderPlan rays = settings;
  rays.integrator = &kWhitted;
  rays.max_depth = 3;
  rays.reflections = rays.antialias = 0;
  rays.last_sample = 16;
  const std::vector<float> truth = light(scene, rays);
  std::size_t nested = 0, flat = 0, same = 0;
  for (std::size_t y = 1; y < 47; ++y)
    for (std::size_t x = 1; x < 47; ++x) {
      const std::size_t i = 48 * y + x;
      bool is_flat = true;
      for (const std::size_t row : {i - 48, i, i + 48})
        for (std::size_t j = row - 1; j <= row + 1; ++j) is_flat &= std::abs(ours[j] - ours[i]) <= 1e-5 * ours[i];
      if (!is_flat) continue;
      ++flat;
      nested += ours[i] != one_deep[i];
      same += std::abs(truth[i] - ours[i]) <= 1e-4 * ours[i];
    }
  EXPECT_GT(flat, truth.size() / 2);
  EXPECT_GT(nested, truth.size() / 25);
  EXPECT_GT(static_cast<double>(same), 0.99 * static_cast<double>(flat));
}

// What lies in one plane does not see itself, and costs nothing.
TEST_F(ReflectionsTest, MirrorsInOnePlaneDoNotLookForOthers) {
  const auto result_of = [&](const Scene& scene, std::string_view technique, std::uint32_t max_depth) {
    RenderPlan settings = settings_for(technique);
    settings.max_depth = max_depth;
    return render(scene, settings);
  };
  const auto looks = [](const RenderResult& result) {
    return std::ranges::count(result.stages, "mirrors in mirrors", &StageTime::name) > 0;
  };
  for (const std::string_view technique : {"traced", "planar", "stencil"}) {
    const RenderResult one = result_of(bodies_on_a_mirror(), technique, 2),
                       deep = result_of(bodies_on_a_mirror(), technique, 8),
                       among = result_of(bodies_among_mirrors(0.9), technique, 8),
                       shallow = result_of(bodies_among_mirrors(0.9), technique, 2);
    EXPECT_FALSE(looks(one)) << technique;
    EXPECT_FALSE(looks(deep)) << technique;
    EXPECT_TRUE(looks(among)) << technique;
    EXPECT_FALSE(looks(shallow)) << technique;
    EXPECT_EQ(one.memory.paths, deep.memory.paths) << technique;
    EXPECT_LT(shallow.memory.paths, among.memory.paths) << technique;
  }
}

// ---- plane mirrors ----------------------------------------------------------------------------------------------

// Boxes between a mirror below and one behind.
Scene bodies_between_mirrors() {
  Scene scene = bodies_on_a_mirror(0.9);
  add_instance(scene, add_mesh(scene, rectangle({0, 1.5f, -2}, {2, 0, 0}, {0, 1.5f, 0}), 1));
  return scene;
}

// The point that a mirror shows is computed as by a ray, so that light is the same to the last bit wherever the
// rasterizer finds the same triangle: everywhere but at silhouettes.
TEST_F(ReflectionsTest, PlaneMirrorsHaveTheBitsOfTracedOnes) {
  const Scene one = bodies_on_a_mirror(), two = bodies_between_mirrors(), four = bodies_among_mirrors(0.9);
  for (const auto& [scene, max_depth] :
       {std::pair(one, 2u), {two, 2u}, {two, 3u}, {four, 2u}, {four, 3u}, {four, 8u}}) {
    RenderPlan settings = settings_for("traced");
    settings.max_depth = max_depth;
    const std::vector<float> traced = light(scene, settings);
    const std::uint64_t asked = render(scene, settings).reflections->asked;
    for (const std::string_view technique : {"planar", "stencil"}) {
      SCOPED_TRACE(technique);
      settings.reflections = index_of(kReflectionTechniques.names(), technique);
      const RenderResult result = render(scene, settings);
      const std::vector<float>& drawn = result.picture.channels[1].values;
      std::size_t differ = 0;
      for (std::size_t i = 0; i < traced.size(); ++i) differ += traced[i] != drawn[i];
      EXPECT_LE(differ, traced.size() / 200);
      EXPECT_EQ(result.reflections->asked, asked);
      EXPECT_EQ(result.reflections->answered, asked);
    }
  }
  for (const std::string_view technique : {"planar", "stencil"}) // through a parallel projection
    expect_ceiling(mirror_material(), settings_for(technique), kMetal);
}

// What bulges is no plane mirror.
TEST_F(ReflectionsTest, PlanarMirrorsMissWhatIsCurved) {
  Scene scene = bodies_on_a_mirror();
  scene.materials.push_back(plain_material());
  scene.meshes[0].primitives[0].material = 2;
  add_instance(scene, add_mesh(scene, ball({-1.0f, 0.6f, 0.8f}, 0.5f), 1));
  for (const std::string_view technique : {"planar", "stencil"}) {
    const RenderResult result = render(scene, settings_for(technique));
    EXPECT_GT(result.reflections->asked, 20u) << technique;
    EXPECT_LT(result.reflections->answered, result.reflections->asked / 4) << technique;
  }
}

// ---- screen space -----------------------------------------------------------------------------------------------

// A wall behind a mirror on the floor; the picture shows all that the mirror does.
Scene wall_behind_a_mirror() {
  Scene scene;
  scene.path = "test";
  scene.materials = {mirror_material(), plain_material()};
  add_instance(scene, add_mesh(scene, rectangle({0, 0, 0}, {0, 0, 1}, {0.4f, 0, 0})));
  add_instance(scene, add_mesh(scene, rectangle({0, 2, -1.5f}, {3, 0, 0}, {0, 2, 0}), 1));
  scene.lights.push_back(lamp({0.5, 1.5, 0.5}));
  look_at(scene, {0, 1.0, 3.0}, {0, 0.7, 0});
  return scene;
}

double median_error(const std::vector<double>& values, const std::vector<double>& truth) {
  std::vector<double> errors;
  for (std::size_t i = 0; i < truth.size(); ++i)
    if (truth[i] > 1e-3) errors.push_back(std::abs(values[i] - truth[i]) / truth[i]);
  EXPECT_GT(errors.size(), truth.size() / 50);
  std::ranges::sort(errors);
  return errors.empty() ? 1.0 : errors[errors.size() / 2];
}

TEST_F(ReflectionsTest, ScreenSpaceFindsWhatThePictureShows) {
  const Scene scene = wall_behind_a_mirror();
  RenderPlan settings = settings_for("ssr");
  settings.width = settings.height = 96;
  const std::vector<double> found = added(scene, settings);
  const RenderResult result = render(scene, settings);
  EXPECT_EQ(result.reflections->answered, result.reflections->asked);
  settings.reflections = index_of(kReflectionTechniques.names(), "traced");
  const std::vector<double> traced = added(scene, settings);
  for (std::size_t i = 0; i < traced.size(); ++i) ASSERT_NEAR(found[i], traced[i], 0.04 * traced[i] + 1e-6) << i;
  EXPECT_LT(median_error(found, traced), 0.01);
}

TEST_F(ReflectionsTest, ScreenSpaceMissesWhatThePictureDoesNotShow) {
  const Scene scene = under_a_ceiling(mirror_material());
  for (const double value : added(scene, settings_for("ssr"))) ASSERT_EQ(value, 0.0);
  const RenderResult result = render(scene, settings_for("ssr"));
  EXPECT_EQ(result.reflections->asked, 48u * 48u);
  EXPECT_EQ(result.reflections->answered, 0u);
}

// ---- maps -------------------------------------------------------------------------------------------------------

// A room lit by a lamp, with a square mirror of this half side at that height; at height 0 it stands for the floor.
Scene room_with_a_mirror(float half, float height) {
  Scene scene;
  scene.path = "test";
  scene.materials = {mirror_material(), plain_material()};
  constexpr float kSide = 2.0f, kTop = 3.0f;
  add_instance(scene, add_mesh(scene, rectangle({0, height, 0}, {0, 0, half}, {half, 0, 0})));
  add_instance(scene, add_mesh(scene, rectangle({0, kTop, 0}, {kSide, 0, 0}, {0, 0, kSide}), 1));
  for (const float sign : {-1.0f, 1.0f}) {
    add_instance(scene, add_mesh(scene, rectangle({sign * kSide, kTop / 2, 0}, {0, kTop / 2, 0}, {0, 0, kSide}), 1));
    add_instance(scene, add_mesh(scene, rectangle({0, kTop / 2, sign * kSide}, {kSide, 0, 0}, {0, kTop / 2, 0}), 1));
  }
  if (height > 0.0f) add_instance(scene, add_mesh(scene, rectangle({0, 0, 0}, {0, 0, kSide}, {kSide, 0, 0}), 1));
  scene.lights.push_back(lamp({0.4, 2.0, -0.3}));
  const double near = height > 0.0f ? 4.0 * half : 1.2;
  look_at(scene, {0.2 * near, height + near, near}, {0, height, 0});
  return scene;
}

// Around a small mirror everything is far away. In an empty room every surface lies on its bounding box.
TEST_F(ReflectionsTest, MapsAreRightWhereTheirAssumptionsHold) {
  RenderPlan settings = settings_for("traced");
  settings.width = settings.height = 128;
  const Scene small = room_with_a_mirror(0.05f, 1.2f), whole = room_with_a_mirror(2.0f, 0.0f);
  const std::vector<double> small_truth = added(small, settings), whole_truth = added(whole, settings);
  const auto error = [&](std::string_view technique, const Scene& scene, const std::vector<double>& truth) {
    settings.reflections = index_of(kReflectionTechniques.names(), technique);
    return median_error(added(scene, settings), truth);
  };
  EXPECT_LT(error("cube", small, small_truth), 0.03);
  EXPECT_LT(error("sphere", small, small_truth), 0.05); // its texels are larger where it bends more
  EXPECT_LT(error("probe", whole, whole_truth), 0.03);
  EXPECT_GT(error("cube", whole, whole_truth), 0.1);
  EXPECT_GT(error("sphere", whole, whole_truth), 0.1);
}

TEST_F(ReflectionsTest, WithoutReflectionsThereIsNothingOfThem) {
  const Scene scene = bodies_on_a_mirror();
  const RenderResult off = render(scene, settings_for("none")), on = render(scene, settings_for("traced"));
  EXPECT_FALSE(off.reflections);
  EXPECT_GT(on.memory.paths, off.memory.paths);
}

// Techniques of shadows answer for the camera's first hits, so what mirrors show has its shadows traced beside any.
TEST_F(ReflectionsTest, ShadowsOfWhatAMirrorShowsAreTraced) {
  Scene scene = under_a_ceiling(mirror_material());
  add_instance(scene, add_mesh(scene, rectangle({0.3, 3.0, 0.2}, {0.1, 0, 0}, {0, 0, 0.1}), 1)); // over the lamp
  for (const char* technique : {"traced", "planar", "cube"}) {
    RenderPlan settings = settings_for(technique);
    const std::vector<double> traced = added(scene, settings);
    EXPECT_GT(std::ranges::count_if(traced, [](double light) { return light < 1e-3; }), 20) << "no shadow to be seen";
    for (const char* shadows : {"map", "planar"}) {
      settings.shadows = index_of(kShadowTechniques.names(), shadows);
      EXPECT_EQ(added(scene, settings), traced) << technique << ", --shadows " << shadows;
    }
  }
}

TEST_F(ReflectionsTest, HowTheWorkIsCutUpDoesNotMatter) {
  const Scene scene = bodies_on_a_mirror();
  for (const char* technique : {"traced", "planar", "stencil", "cube", "ssr"}) {
    RenderPlan settings = settings_for(technique);
    const std::vector<float> whole = light(scene, settings);
    settings.wave_slots = 700;
    EXPECT_EQ(light(scene, settings), whole) << technique;
    settings.max_depth = 3;
    const std::vector<float> nested = light(bodies_among_mirrors(0.9), settings);
    settings.wave_slots = settings_for(technique).wave_slots;
    EXPECT_EQ(light(bodies_among_mirrors(0.9), settings), nested) << technique;
  }
}

TEST_F(ReflectionsTest, TheyRefuseWhatLeavesThemOut) {
  RenderPlan settings = settings_for("traced");
  settings.max_depth = 1;
  EXPECT_THROW(kHybrid.check(settings), UsageError);
  settings = settings_for("none");
  settings.reflection_threshold = 0.5;
  EXPECT_THROW(kHybrid.check(settings), UsageError);
}

} // namespace
} // namespace wavepath::test
