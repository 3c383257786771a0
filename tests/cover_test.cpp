// Transparency, the shadow catcher and the passes beside them: pictures put over a background are those with it.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>

#include <gtest/gtest.h>

#include "host/base/error.h"
#include "host/codecs/png.h"
#include "host/film/film.h"
#include "host/picture/files/exr.h"
#include "host/picture/files/picture_io.h"
#include "host/picture/tonemap.h"
#include "host/render/progressive/display.h"
#include "host/render/progressive/progressive.h"
#include "host/render/settings/integrator_kind.h"
#include "host/scene/gltf/motion.h"
#include "host/scene/staging/catcher.h"
#include "host/scene/staging/ground.h"
#include "tests/mean_picture.h"
#include "tests/shadow_scene.h"
#include "tests/temporary_folder.h"

namespace wavepath::test {
namespace {

Camera camera_at(glm::dvec3 eye, glm::dvec3 target, double yfov = 0.8) {
  Camera camera;
  camera.yfov = yfov;
  const glm::dvec3 forward = glm::normalize(target - eye);
  const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(0, 1, 0))), up = glm::cross(right, forward);
  camera.world_from_camera = {glm::dvec4(right, 0), glm::dvec4(up, 0), glm::dvec4(-forward, 0), glm::dvec4(eye, 1)};
  return camera;
}

std::uint32_t add_material(Scene& scene, const std::function<void(Material&)>& change) {
  Material material = plain_material();
  change(material);
  scene.materials.push_back(material);
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

// Side by side before nothing: a half transparent card, a mirror, a diffuse card, grey glass as a body and as a pane.
Scene display() {
  Scene scene;
  scene.path = "test";
  const auto add = [&](const std::vector<glm::vec3>& corners, const std::function<void(Material&)>& change) {
    add_instance(scene, add_mesh(scene, corners, add_material(scene, change)));
  };
  const auto card = [](float x) { return rectangle({x, 0, 0}, {0.35f, 0, 0}, {0, 0.5f, 0}); };
  add(card(-2.0f), [](Material& m) {
    m.alpha_mode = AlphaMode::blend;
    m.base_color = {0.8f, 0.8f, 0.8f, 0.4f};
  });
  add(card(-1.0f), [](Material& m) {
    m.metallic = 1.0f;
    m.roughness = 0.0f;
    m.base_color = {0.9f, 0.9f, 0.9f, 1.0f};
  });
  add(card(0.0f), [](Material& m) { m.base_color = {0.7f, 0.3f, 0.2f, 1.0f}; });
  add(box({1.0f, 0.0f, 0.0f}, {0.35f, 0.5f, 0.35f}), [](Material& m) {
    m.specular = 1.0f;
    m.base_color = {0.9f, 0.9f, 0.9f, 1.0f};
    m.transmission = 1.0f;
    m.roughness = 0.0f;
    m.volume = true;
    m.double_sided = false;
  });
  add(card(2.0f), [](Material& m) {
    m.specular = 1.0f;
    m.base_color = {0.6f, 0.6f, 0.6f, 1.0f};
    m.transmission = 1.0f;
    m.roughness = 0.0f;
  });
  scene.environment.radiance = glm::vec3(0.5f, 1.0f, 2.0f);
  scene.cameras.push_back(camera_at({0.1, 0.2, 5.0}, {0, 0, 0}, 0.27));
  return scene;
}

RenderPlan path_settings(std::uint32_t width, std::uint32_t height, std::uint32_t samples) {
  RenderPlan settings;
  settings.integrator = find_integrator("path");
  settings.width = width, settings.height = height;
  settings.last_sample = samples;
  settings.reuse = kReuseOff;
  return settings;
}

constexpr std::uint32_t kWidth = 60, kHeight = 16;

class CoverTest : public ShadowTest {
protected:
  // The pixel in the middle of a card of display().
  static std::size_t at(double x) {
    return std::size_t{kHeight / 2} * kWidth + static_cast<std::size_t>(kWidth / 2 + x * kWidth / 5.08);
  }

  void expect_over_background(const char* integrator) {
    RenderPlan opaque = path_settings(kWidth, kHeight, 32);
    opaque.integrator = find_integrator(integrator);
    RenderPlan transparent = opaque;
    transparent.transparent = true;
    const Picture whole = render(display(), opaque).picture, cut = render(display(), transparent).picture;
    const glm::vec3 background = display().environment.radiance;
    const std::vector<float>& alpha = channel(cut, "A");
    for (int c = 0; c < 3; ++c)
      for (std::size_t i = 0; i < alpha.size(); ++i) {
        const float over = cut.channels[c].values[i] + (1.0f - alpha[i]) * background[c];
        ASSERT_NEAR(over, whole.channels[c].values[i], 2e-5f * (1.0f + whole.channels[c].values[i])) << c << ' ' << i;
      }
    EXPECT_EQ(alpha[0], 0.0f) << "a corner, where nothing is";
    EXPECT_EQ(cut.channels[0].values[0], 0.0f);
    EXPECT_NEAR(alpha[at(-2.0)], 0.4f, 0.2f) << "half transparent";
    EXPECT_EQ(alpha[at(-1.0)], 1.0f) << "a mirror";
    EXPECT_GT(cut.channels[2].values[at(-1.0)], 1.0f) << "which shows the environment";
    EXPECT_EQ(alpha[at(0.0)], 1.0f);
    EXPECT_LT(alpha[at(1.0)], 0.6f) << "glass";
    EXPECT_GT(alpha[at(1.0)], 0.05f);
    EXPECT_NEAR(alpha[at(2.0)], 1.0f - 0.6f * 0.92f, 0.1f) << "a grey pane";
  }
};

// All samples are those of the picture with the background, so that only rounding differs.
TEST_F(CoverTest, OverABackgroundIsThePictureWithIt) {
  for (const char* integrator : {"path", "bidirectional"}) expect_over_background(integrator);
}

TEST_F(CoverTest, AlphaDoesNotDependOnTheEnvironment) {
  RenderPlan settings = path_settings(kWidth, kHeight, 16);
  settings.transparent = true;
  Scene dark = display();
  dark.environment.radiance = glm::vec3(0.0f);
  dark.lights.push_back(sun());
  const Picture lit = render(display(), settings).picture, unlit = render(dark, settings).picture;
  // Without light samples to a sky, panes let no shadow rays pass: the same paths.
  EXPECT_EQ(channel(lit, "A"), channel(unlit, "A"));
}

TEST_F(CoverTest, TheEnvironmentPassIsWhatBecomesTransparent) {
  RenderPlan opaque = path_settings(kWidth, kHeight, 16);
  const Picture plain = render(display(), opaque).picture;
  opaque.aovs = {"environment"};
  RenderPlan transparent = opaque;
  transparent.transparent = true;
  const Picture whole = render(display(), opaque).picture, cut = render(display(), transparent).picture;
  for (const char* name : {"environment.R", "environment.G", "environment.B"})
    EXPECT_EQ(channel(whole, name), channel(cut, name));
  for (int c = 0; c < 3; ++c) {
    EXPECT_EQ(whole.channels[c].values, plain.channels[c].values) << "the pass changes the picture";
    const std::vector<float>& seen = channel(cut, std::string("environment.") + "RGB"[c]);
    for (std::size_t i = 0; i < seen.size(); ++i)
      ASSERT_NEAR(cut.channels[c].values[i] + seen[i], whole.channels[c].values[i],
                  2e-5f * (1.0f + whole.channels[c].values[i]));
  }
  EXPECT_TRUE(std::ranges::all_of(channel(whole, "A"), [](float a) { return a == 1.0f; }));
}

// ---- the shadow catcher ---------------------------------------------------------------------------------------------

// A box and a ball on a floor far wider than the picture, which is node 0.
Scene stage(bool objects) {
  Scene scene;
  scene.path = "test";
  scene.node_names = {"floor", "box"};
  scene.materials.push_back(plain_material());
  add_instance(scene, add_mesh(scene, rectangle({0, 0, 0}, {0, 0, 300}, {300, 0, 0})));
  scene.instances[0].node = 0;
  if (objects) {
    const std::uint32_t red = add_material(scene, [](Material& m) { m.base_color = {0.8f, 0.3f, 0.3f, 1.0f}; });
    add_instance(scene, add_mesh(scene, box({-0.5f, 0.5f, 0.1f}, {0.3f, 0.5f, 0.3f}), red));
    scene.instances[1].node = 1;
    add_instance(scene, add_mesh(scene, ball({0.6f, 0.41f, -0.2f}, 0.4f), red));
  }
  scene.cameras.push_back(camera_at({0.4, 2.6, 3.0}, {0.0, 0.2, 0.0}));
  return scene;
}

// So far that the light of the floor differs little within a pixel: alpha and the photograph are means over pixels, and
// what is multiplied afterwards does not know how both vary within one.
PunctualLight far_lamp() {
  PunctualLight light = lamp({-24.0, 40.0, -16.0});
  light.intensity = glm::vec3(8000.0f);
  return light;
}

class CatcherTest : public ShadowTest {
protected:
  // Puts renders with a catcher over the floor without objects, and compares them with renders of everything.
  void expect_composite(const std::function<void(Scene&)>& light, const std::function<void(Scene&)>& more = {},
                        const std::function<void(RenderPlan&)>& by = {}) {
    Scene floor = stage(false), whole = stage(true);
    light(floor), light(whole);
    if (more) more(whole);
    Scene caught = whole;
    add_catcher(caught, "floor");
    RenderPlan settings = path_settings(24, 18, 64);
    settings.max_depth = 4;
    RenderPlan photographing = settings;
    if (by) by(settings);
    RenderPlan catching = settings;
    catching.catches = catching.transparent = true;
    photographing.last_sample = 4096;
    photographing.max_depth = 1;
    const Picture photograph = render(floor, photographing).picture;
    std::vector<float> alpha;
    const auto composed = [&](const RenderPlan& of) {
      RenderResult result = render(caught, of);
      alpha = channel(result.picture, "A");
      for (int c = 0; c < 3; ++c)
        for (std::size_t i = 0; i < alpha.size(); ++i)
          result.picture.channels[c].values[i] += (1.0f - alpha[i]) * photograph.channels[c].values[i];
      return result;
    };
    expect_same_mean(mean_picture(settings, [&](const RenderPlan& of) { return render(whole, of); }),
                     mean_picture(catching, composed), 0.3, 0.02);
    EXPECT_LT(std::ranges::min(alpha), 0.2f) << "no floor is seen";
    EXPECT_GT(std::ranges::max(alpha), 0.9f) << "no object is seen";
  }
};

TEST_F(CatcherTest, ALampsShadow) {
  expect_composite([](Scene& scene) { scene.lights.push_back(far_lamp()); });
}

TEST_F(CatcherTest, TheShadowOfASky) {
  expect_composite([](Scene& scene) { scene.environment.radiance = glm::vec3(0.7f); });
}

TEST_F(CatcherTest, ALampAndAnEnvironmentMap) {
  expect_composite([](Scene& scene) {
    scene.lights.push_back(far_lamp());
    scene.environment.radiance = glm::vec3(1.0f);
    scene.environment.width = 8, scene.environment.height = 4;
    scene.environment.map.assign(32, glm::vec3(0.2f));
    scene.environment.map[11] = glm::vec3(6.0f);
  });
}

// The photograph has the light of a soft lamp, whichever way it would come to the floor.
TEST_F(CatcherTest, SoftLamps) {
  PunctualLight sphere = far_lamp(), disc = sun();
  sphere.extent = 1.5, disc.extent = 0.05;
  for (const std::uint32_t direct : {gpu::kDirectMis, gpu::kDirectNee})
    for (const PunctualLight& lamp : {sphere, disc})
      expect_composite([&](Scene& scene) { scene.lights = {lamp}; }, {}, [&](RenderPlan& s) { s.direct = direct; });
}

// Samples pick one of the lamps. Nets of 64 points pick each of them as often for nearly all seeds, so that the spread
// of eight renders does not tell the error of the render without a catcher: independent samples do.
TEST_F(CatcherTest, SeveralLamps) {
  for (const bool soft : {false, true})
    expect_composite(
        [&](Scene& scene) {
          scene.lights = {far_lamp(), sun()};
          if (soft) scene.lights[0].extent = 1.5, scene.lights[1].extent = 0.05;
        },
        {}, [](RenderPlan& settings) { settings.sampler = gpu::kSamplerIndependent; });
}

// What glows is an object: its light on the floor is in the picture.
TEST_F(CatcherTest, ObjectsThatGlow) {
  expect_composite([](Scene& scene) { scene.lights.push_back(far_lamp()); },
                   [](Scene& scene) {
                     const std::uint32_t glows = add_material(scene, [](Material& m) {
                       m.emission = glm::vec3(2.0f, 4.0f, 1.0f);
                       m.double_sided = false;
                     });
                     add_instance(scene, add_mesh(scene, box({0.1f, 0.2f, 0.6f}, {0.1f, 0.1f, 0.1f}), glows));
                   });
}

TEST(Catcher, GivesOnlyItsNodeOtherMaterials) {
  Scene scene = stage(true);
  const std::size_t materials = scene.materials.size(), meshes = scene.meshes.size();
  scene.instances[1].mesh = 0; // the box looks like the floor
  add_catcher(scene, "floor");
  EXPECT_EQ(scene.first_catcher, materials);
  EXPECT_EQ(scene.end_catcher, materials + 1);
  ASSERT_EQ(scene.meshes.size(), meshes + 1);
  EXPECT_EQ(scene.instances[0].mesh, meshes);
  EXPECT_EQ(scene.instances[1].mesh, 0u);
  EXPECT_EQ(scene.meshes[0].primitives[0].material, 0u);
  EXPECT_EQ(scene.meshes[meshes].primitives[0].material, materials);
  Scene by_index = stage(true);
  add_catcher(by_index, "1");
  EXPECT_EQ(by_index.instances[0].mesh, 0u);
  EXPECT_EQ(by_index.instances[1].mesh, meshes);
  EXPECT_THROW(add_catcher(scene, "wall"), Error);
  EXPECT_THROW(add_catcher(scene, "7"), Error);
}

// As artists group what belongs together: the node that is named need not show triangles itself.
TEST(Catcher, TakesAllBelowItsNode) {
  Scene scene = stage(true);
  scene.instances[2].node = 4; // box and ball are below "toys" in "room", the floor is beside it
  scene.node_names = {"floor", "box", "toys", "room", ""};
  scene.node_parents = {3, 2, 3, kNoIndex, 2};
  const std::size_t materials = scene.materials.size();
  for (const char* toys : {"toys", "2"}) {
    Scene caught = scene;
    add_catcher(caught, toys);
    const auto caught_at = [&](std::size_t instance) {
      return caught.meshes[caught.instances[instance].mesh].primitives[0].material >= materials;
    };
    EXPECT_FALSE(caught_at(0));
    EXPECT_TRUE(caught_at(1) && caught_at(2));
  }
  Scene all = scene;
  add_catcher(all, "room");
  for (const Instance& instance : all.instances)
    EXPECT_GE(all.meshes[instance.mesh].primitives[0].material, all.first_catcher);
}

TEST(Catcher, TellsThatNothingLightsIt) {
  const auto warnings = [](const std::function<void(Scene&)>& light) {
    Scene scene = stage(true);
    light(scene);
    warn_of_unlit_catcher(scene);
    return scene.warnings.counts().size();
  };
  EXPECT_EQ(warnings([](Scene&) {}), 1u);
  EXPECT_EQ(warnings([](Scene& scene) { scene.materials[0].emission = glm::vec3(1.0f); }), 1u);
  EXPECT_EQ(warnings([](Scene& scene) { scene.lights.push_back(sun()); }), 0u);
  EXPECT_EQ(warnings([](Scene& scene) { scene.environment.radiance = glm::vec3(0.1f); }), 0u);
}

// With --shutter the floor of --ground stands in the scene before the file is posed for the end of the shutter.
TEST(Catcher, TheGroundStaysWhileTheFileMoves) {
  Scene scene = stage(true);
  scene.instances.pop_back(); // which has no node
  Scene end = scene;
  end.instances[1].world_from_object[3].x = 0.25;
  Bounds bounds;
  bounds.add(glm::dvec3(-1.0)), bounds.add(glm::dvec3(1.0));
  add_ground(scene, bounds);
  catch_ground(scene);
  ASSERT_NO_THROW(gltf::add_motion(scene, end));
  EXPECT_TRUE(scene.meshes[scene.instances[1].mesh].moves());
  EXPECT_FALSE(scene.meshes[scene.instances[2].mesh].moves());
  end.instances.pop_back();
  EXPECT_THROW(gltf::add_motion(scene, end), Error);
}

// ---- passes ---------------------------------------------------------------------------------------------------------

TEST_F(CoverTest, TheShadowPassIsTheShareOfLightThatArrives) {
  Scene scene = lit_by(sun());
  RenderPlan settings = path_settings(64, 48, 4);
  settings.filter = gpu::kFilterBox;
  settings.max_depth = 1;
  settings.aovs = {"shadow"};
  const Picture picture = render(scene, settings).picture;
  RenderPlan all = settings;
  all.aovs = {};
  const Picture plain = render(scene, all).picture;
  EXPECT_EQ(picture.channels[1].values, plain.channels[1].values);
  // Light of all samples of a pixel on the floor is the same: the fraction that arrives is that of the lit samples.
  const std::vector<float>& shadow = channel(picture, "shadow");
  const float lit = *std::ranges::max_element(plain.channels[1].values);
  std::size_t dark = 0, bright = 0;
  for (std::size_t i = 0; i < shadow.size(); ++i) {
    if (shadow[i] == 0.0f) {
      ++dark;
      EXPECT_EQ(plain.channels[1].values[i], 0.0f);
    }
    if (shadow[i] == 1.0f && plain.channels[1].values[i] > 0.5f * lit) ++bright;
  }
  EXPECT_GT(dark, 50u);
  EXPECT_GT(bright, 500u);
}

// Where light does not come from a point the ratio is that of pictures with and without what blocks it.
class ShadowPass : public CoverTest {
protected:
  void expect_ratio(const Scene& scene, std::uint32_t direct = gpu::kDirectMis) {
    Scene open = scene;
    open.instances.erase(open.instances.begin() + 1, open.instances.begin() + 3); // the boxes
    RenderPlan settings = path_settings(32, 24, 1024);
    settings.max_depth = 1;
    settings.direct = direct;
    settings.filter = gpu::kFilterBox;
    settings.aovs = {"shadow", "position"};
    const Picture picture = render(scene, settings).picture;
    settings.aovs = {"direct"};
    const Picture lit = render(scene, settings).picture, unblocked = render(open, settings).picture;
    std::size_t judged = 0, partly = 0;
    double difference = 0.0;
    for (std::size_t i = 0; i < channel(picture, "shadow").size(); ++i) {
      const bool on_floor = std::abs(channel(picture, "P.Y")[i]) < 1e-6f && channel(unblocked, "direct.G")[i] > 0.01f;
      if (!on_floor) continue;
      const double expected = channel(lit, "direct.G")[i] / channel(unblocked, "direct.G")[i];
      EXPECT_NEAR(channel(picture, "shadow")[i], expected, 0.08) << i;
      difference += channel(picture, "shadow")[i] - expected;
      ++judged;
      partly += expected > 0.1 && expected < 0.9;
    }
    EXPECT_GT(judged, 300u);
    EXPECT_GT(partly, 20u);
    EXPECT_LT(std::abs(difference) / static_cast<double>(judged), 0.004);
  }
};

TEST_F(ShadowPass, KnowsSurfacesThatGlow) { expect_ratio(lit_by_square(0.6f)); }

TEST_F(ShadowPass, KnowsSoftLamps) {
  Scene scene = lit_by(sun());
  scene.lights[0].extent = glm::radians(10.0);
  for (const std::uint32_t direct : {gpu::kDirectMis, gpu::kDirectNee}) expect_ratio(scene, direct);
  scene = lit_by(lamp());
  scene.lights[0].extent = 0.4;
  expect_ratio(scene);
}

// ---- sums -----------------------------------------------------------------------------------------------------------

TEST_F(CoverTest, PartsJoinToTheBitsOfTheWhole) {
  Scene scene = stage(true);
  scene.lights.push_back(far_lamp());
  add_catcher(scene, "floor");
  for (const std::uint32_t probes_from : {1u << 15, 1u}) {
    RenderPlan settings = path_settings(40, 32, 8);
    settings.transparent = settings.catches = true;
    settings.aovs = {"shadow", "environment"};
    settings.sample_total = 8;
    settings.probes_from = probes_from;
    const RenderResult whole = render(scene, settings);
    ASSERT_EQ(whole.film->has_probes, probes_from == 1u);
    settings.first_sample = 0, settings.last_sample = 3;
    Film film = *render(scene, settings).film;
    settings.first_sample = 3, settings.last_sample = 8;
    join(film, *render(scene, settings).film);
    EXPECT_TRUE(film == *whole.film);

    const TemporaryFolder folder;
    const std::string path = folder.file("sums.exr");
    PictureInfo info;
    info.film = whole.film;
    info.seed = settings.seed;
    write_picture(path, whole.picture, info, {});
    const std::shared_ptr<const Film> stored = read_film(path);
    ASSERT_TRUE(stored);
    EXPECT_TRUE(*stored == *whole.film);
    const Picture again = read_picture(path);
    EXPECT_EQ(channel(again, "A"), channel(whole.picture, "A"));
    EXPECT_EQ(channel(again, "shadow"), channel(whole.picture, "shadow"));
  }
}

TEST_F(CoverTest, OtherRendersHaveNoneOfIt) {
  const RenderPlan settings = path_settings(16, 8, 1);
  EXPECT_TRUE(render(display(), settings).film->cover.empty());
  EXPECT_FALSE(find_integrator("path")->features(settings) & gpu::kFeatureCover);
}

// The window shows squares of two greys behind what is transparent, with error probes too.
TEST_F(CoverTest, AWindowShowsSquaresBehindIt) {
  Scene scene = stage(true);
  scene.lights.push_back(far_lamp());
  add_catcher(scene, "floor");
  for (const std::uint32_t probes_from : {1u << 15, 1u}) {
    RenderPlan settings = path_settings(40, 32, 8);
    settings.transparent = settings.catches = true;
    settings.probes_from = probes_from;
    const PackedScene packed = pack(scene, {.direct = settings.direct});
    Progressive progressive(device(), packed, resolve_view(scene, {}, 40, 32), settings, shared_kernels(device()));
    while (progressive.status().fraction < 1.0) progressive.step();
    const Picture picture = progressive.picture();
    const std::vector<float>& alpha = channel(picture, "A");
    EXPECT_LT(std::ranges::min(alpha), 0.1f);
    Display display(device());
    display.draw(progressive, {.exposure = 1.0, .tonemap = Tonemap::none});
    const auto words = download<std::uint32_t>(display.pixels(), alpha.size());
    for (std::size_t i = 0; i < words.size(); ++i) {
      const float square = (i % 40 / 8 + i / 40 / 8) % 2 == 0 ? gpu::kDarkSquare : gpu::kBrightSquare;
      for (std::size_t c = 0; c < 3; ++c) {
        const float light = 2.0f * picture.channels[c].values[i] + (1.0f - alpha[i]) * square;
        ASSERT_NEAR(static_cast<int>(words[i] >> 8 * c & 0xff), 255.0f * to_srgb(std::min(light, 1.0f)), 1.0) << i;
      }
    }
  }
}

// ---- files ----------------------------------------------------------------------------------------------------------

DecodedImage decoded(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  return decode_png({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, [](const ImageShape&) {});
}

TEST(CoverFiles, PngHasStraightAlpha) {
  Picture picture{3, 1, {}};
  picture.channels = {
      {"R", {0.1f, 0.2f, 0.3f}}, {"G", {0.1f, 0.0f, 0.3f}}, {"B", {0.1f, 0.0f, 0.3f}}, {"A", {1.0f, 0.4f, 0.0f}}};
  const TemporaryFolder folder;
  WriteOptions options;
  options.exposure = 0.0;
  options.tonemap = Tonemap::none;
  for (const std::uint32_t bits : {8u, 16u}) {
    options.bits = bits;
    write_picture(folder.file("a.png"), picture, {}, options);
    const DecodedImage read = decoded(folder.file("a.png"));
    ASSERT_EQ(read.shape.channels, 4u);
    const auto at = [&](std::size_t i) {
      return bits == 8 ? static_cast<float>(read.bytes[i]) / 255.0f : static_cast<float>(read.words[i]) / 65535.0f;
    };
    EXPECT_NEAR(at(0), to_srgb(0.1f), 3e-3f);
    EXPECT_NEAR(at(4), to_srgb(0.5f), 3e-3f);
    EXPECT_NEAR(at(7), 0.4f, 3e-3f);
    EXPECT_EQ(at(8), 0.0f);
    EXPECT_EQ(at(11), 0.0f);
  }
  picture.channels[3].values = {1.0f, 1.0f, 1.0f};
  write_picture(folder.file("b.png"), picture, {}, options);
  EXPECT_EQ(decoded(folder.file("b.png")).shape.channels, 3u) << "opaque pictures stay as they were";
}

} // namespace
} // namespace wavepath::test
