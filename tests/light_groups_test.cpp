// Groups of lights: which light belongs to which, sums that add up in integers, and pictures that are mixed anew.
#include "host/scene/pack/light_groups.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <numeric>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>
#include <nlohmann/json.hpp>

#include "host/base/error.h"
#include "host/film/exact_sum.h"
#include "host/film/film.h"
#include "host/film/group_layers.h"
#include "host/picture/files/picture_io.h"
#include "host/picture/files/relight.h"
#include "host/plan/memory.h"
#include "host/render/progressive/display.h"
#include "host/render/progressive/progressive.h"
#include "host/render/render.h"
#include "host/render/settings/integrator_kind.h"
#include "host/scene/pack/features.h"
#include "host/scene/pack/pack.h"
#include "host/scene/pack/plan.h"
#include "host/session/viewing/render_line.h"
#include "tests/gltf_builder.h"
#include "tests/probe.h"
#include "tests/run_wavepath.h"
#include "tests/shadow_scene.h"
#include "tests/temporary_folder.h"

namespace wavepath::test {
namespace {

using Names = std::vector<std::string>;
using Json = nlohmann::json;

// A floor and a mirror-smooth pane of glass above it, under a lamp, a sun, a sky, two panels that share a mesh, another
// that does not, and a sign that is unlit.
Scene lit_room() {
  Scene scene;
  scene.path = "test";
  Material paint = plain_material(), glow = plain_material(), sign = plain_material(), glass = plain_material();
  paint.name = "paint", glow.name = "glow", sign.name = "sign", glass.name = "glass";
  glow.emission = {6.0f, 5.0f, 3.0f};
  sign.unlit = true;
  sign.base_color = {0.2f, 0.9f, 0.4f, 1.0f};
  glass.specular = 1.0f, glass.roughness = 0.0f, glass.transmission = 1.0f;
  scene.materials = {paint, glow, sign, glass};
  scene.node_names = {"floor", "left", "right", "third", "board", "Key.001", "window", ""};
  const auto add = [&](std::uint32_t mesh, std::uint32_t node, const glm::dmat4& transform = glm::dmat4(1.0)) {
    add_instance(scene, mesh, transform);
    scene.instances.back().node = node;
  };
  add(add_mesh(scene, rectangle({0, 0, 0}, {0, 0, 1.5f}, {1.5f, 0, 0})), 0);
  const std::uint32_t panel = add_mesh(scene, rectangle({0, 0.5f, 0}, {0, 0.3f, 0}, {0, 0, 0.3f}), 1);
  add(panel, 1, glm::translate(glm::dmat4(1.0), {-1.2, 0.0, 0.0}));
  add(panel, 2, glm::translate(glm::dmat4(1.0), {1.2, 0.0, 0.0}));
  add(add_mesh(scene, rectangle({0, 0.5f, -1.2f}, {0.2f, 0, 0}, {0, 0.2f, 0}), 1), 3);
  add(add_mesh(scene, rectangle({0.6f, 0.3f, -0.9f}, {0.2f, 0, 0}, {0, 0.2f, 0}), 2), 4);
  add(add_mesh(scene, rectangle({-0.5f, 0.4f, 0.4f}, {0, 0, 0.3f}, {0.3f, 0, 0}), 3), 6);
  PunctualLight key;
  key.name = "Key", key.node = 5;
  key.position = {0.3, 1.4, 0.6};
  key.intensity = {2.0f, 2.0f, 2.5f};
  PunctualLight sun;
  sun.name = "sun", sun.kind = LightKind::directional;
  sun.direction = glm::normalize(glm::dvec3(0.4, -1.0, 0.2));
  sun.intensity = {1.0f, 0.9f, 0.7f};
  scene.lights = {key, sun};
  scene.environment.radiance = {0.1f, 0.15f, 0.3f};
  scene.cameras.push_back(camera_above({0, 0, 0}, 1.3));
  return scene;
}

TEST(LightGroups, EachLampMaterialAndSkyMakesOne) {
  const LightGroups groups = find_light_groups(lit_room(), {"each"});
  EXPECT_EQ(groups.names, (Names{"Key.001", "sun", "glow", "sign", "environment"}));
  EXPECT_EQ(groups.of_lamps, (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(groups.of_environment, 4u);
}

// A light belongs to the first group that names it, be it by node, by its own name or by material; all others make one.
TEST(LightGroups, NamesAreOfNodesLightsAndMaterials) {
  const LightGroups groups = find_light_groups(lit_room(), {"right", "Key", "glow", "environment"});
  EXPECT_EQ(groups.names, (Names{"right", "Key", "glow", "environment", "rest"}));
  EXPECT_EQ(groups.of_lamps, (std::vector<std::uint32_t>{1, kNoIndex}));
  EXPECT_EQ(groups.of_nodes[2], 0u);
  EXPECT_EQ(groups.of_nodes[1], kNoIndex);
  EXPECT_EQ(groups.of_materials, (std::vector<std::uint32_t>{kNoIndex, 2, kNoIndex, kNoIndex}));
  // Without others there is no such group.
  EXPECT_EQ(find_light_groups(lit_room(), {"glow", "sun", "sign", "Key.001", "environment"}).names.size(), 5u);
}

TEST(LightGroups, RefusesNamesOfNoLight) {
  for (const char* name : {"paint", "floor", "window", "", "nothing"}) {
    try {
      find_light_groups(lit_room(), {"sun", name});
      ADD_FAILURE() << name;
    } catch (const UsageError& error) {
      EXPECT_NE(std::string(error.what()).find("Key.001"), std::string::npos) << error.what();
    }
  }
  Scene dark = lit_room();
  dark.environment = {};
  EXPECT_THROW(find_light_groups(dark, {"environment"}), UsageError);
  dark.lights[1].intensity = glm::vec3(0.0f);
  EXPECT_THROW(find_light_groups(dark, {"sun"}), UsageError);
}

// What info tells: lamps by their nodes, surfaces by material and node, each once.
TEST(LightGroups, ListTheirLights) {
  const Scene room = lit_room();
  EXPECT_EQ(light_names(room), (Names{"Key.001", "sun", "glow", "sign", "environment"}));
  const std::vector<Names> lights = lights_of(room, find_light_groups(room, {"right", "Key", "glow"}));
  ASSERT_EQ(lights.size(), 4u);
  EXPECT_EQ(lights[0], (Names{"glow on right"}));
  EXPECT_EQ(lights[1], (Names{"Key.001"}));
  EXPECT_EQ(lights[2], (Names{"glow on left", "glow on third"}));
  EXPECT_EQ(lights[3], (Names{"sun", "sign on board", "environment"}));
  EXPECT_EQ(in_short(Names(12, "a")).find("more"), std::string::npos);
  EXPECT_EQ(in_short(Names(15, "a")), "a, a, a, a, a, a, a, a, a, a, a, a, and 3 more");
  EXPECT_EQ(in_short({}), "");
}

// At most 16, the last of which holds what is left.
TEST(LightGroups, EachStopsAtTheMostThatThereMayBe) {
  Scene scene = lit_room();
  for (int i = 0; i < 20; ++i) {
    scene.lights.push_back(scene.lights[0]);
    scene.lights.back().node = kNoIndex;
    scene.lights.back().name = fmt::format("lamp {}", i);
  }
  const LightGroups groups = find_light_groups(scene, {"each"});
  ASSERT_EQ(groups.names.size(), gpu::kMostLightGroups);
  EXPECT_EQ(groups.names.back(), "rest");
  Names sixteen;
  for (int i = 0; i < 16; ++i) sixteen.push_back(fmt::format("lamp {}", i));
  EXPECT_THROW(find_light_groups(scene, sixteen), UsageError);
  sixteen.pop_back();
  EXPECT_EQ(find_light_groups(scene, sixteen).names.size(), gpu::kMostLightGroups);
}

TEST(LightGroups, LayersHaveSafeNamesThatDiffer) {
  const Names names{"Key.001", "Key 001", "Lampe \xc3\xa9t\xc3\xa9", "a\"b\\"};
  const Names layers = group_layers(names);
  EXPECT_EQ(layers[0], "group.Key_001");
  EXPECT_EQ(layers[1], "group.Key_001_2");
  EXPECT_EQ(layers[2], "group.Lampe___t__");
  EXPECT_EQ(group_names_of(group_names_text(names).second), names);
  EXPECT_TRUE(group_names_of("no JSON").empty());
}

TEST(Relight, ScalesLayersAndAddsThemUp) {
  Picture picture{2, 1, {}};
  const auto add = [&](const std::string& name, float a, float b) { picture.channels.push_back({name, {a, b}}); };
  for (const char* c : {"R", "G", "B", "A"}) add(c, 9.0f, 9.0f);
  for (const char* c : {"R", "G", "B"}) add(std::string("group.one.") + c, 1.0f, 2.0f);
  for (const char* c : {"R", "G", "B"}) add(std::string("group.two.") + c, 4.0f, 8.0f);
  add("albedo.R", 0.5f, 0.5f), add("direct.R", 1.0f, 1.0f), add("denoised.R", 1.0f, 1.0f);
  const Names left_out = relight("in.exr", {"one", "two"}, {{"two", {0.5, 1.0, 0.0}}}, picture);
  EXPECT_EQ(left_out, (Names{"direct", "denoised"}));
  EXPECT_EQ(find_channel(picture, "R")->values, (std::vector<float>{3.0f, 6.0f}));
  EXPECT_EQ(find_channel(picture, "G")->values, (std::vector<float>{9.0f, 9.0f})); // whose gains are all 1
  EXPECT_EQ(find_channel(picture, "B")->values, (std::vector<float>{1.0f, 2.0f}));
  EXPECT_EQ(find_channel(picture, "group.two.R")->values, (std::vector<float>{2.0f, 4.0f}));
  EXPECT_EQ(find_channel(picture, "albedo.R")->values, (std::vector<float>{0.5f, 0.5f}));
  EXPECT_THROW(relight("in.exr", {"one", "two"}, {{"three", glm::dvec3(1.0)}}, picture), UsageError);
  EXPECT_THROW(relight("in.exr", {}, {}, picture), Error);
  EXPECT_THROW(relight("in.exr", {"one", "gone"}, {}, picture), Error);
}

struct Way {
  const char* integrator;
  std::vector<std::string> aovs; // "variance": two replicates a pixel
  std::uint32_t side = 24;       // large pictures have error probes
  std::uint32_t techniques = gpu::kTechniquesAll;
  std::string with; // what else decides which light a picture has
};

// Scenes that find light otherwise.
Scene scene_with(const std::string& what, Scene scene) {
  if (what == "soft_lamps") scene.lights[0].extent = 0.35, scene.lights[1].extent = 0.3;
  if (what == "volume") {
    scene.materials[3].volume = true, scene.materials[3].attenuation = {0.2f, 0.5f, 1.5f};
    scene.instances.back().mesh = add_mesh(scene, box({-0.5f, 0.4f, 0.4f}, glm::vec3(0.25f)), 3);
  }
  if (what == "catcher") scene.first_catcher = 0, scene.end_catcher = 1; // the floor
  return scene;
}

void change_plan(const std::string& what, RenderPlan& plan) {
  plan.transparent = what == "transparent" || what == "catcher", plan.catches = what == "catcher";
  if (what == "clamp") plan.clamp = 0.5;
  if (what == "guide") plan.guide = true, plan.last_sample = 16;
  if (what == "adaptive") plan.adaptive = kAdaptiveOn, plan.last_sample = 64;
}

class RenderWithGroups : public VulkanTest, public testing::WithParamInterface<Way> {
protected:
  static RenderPlan settings(const Scene& scene, const Names& groups) {
    RenderPlan settings;
    settings.integrator = find_integrator(GetParam().integrator);
    settings.width = settings.height = GetParam().side;
    settings.last_sample = 5;
    settings.max_depth = 5;
    settings.techniques = GetParam().techniques;
    settings.aovs = GetParam().aovs;
    settings.reuse = kReuseOff;
    settings.light_groups = groups;
    settings.group_names = find_group_names(scene, groups);
    change_plan(GetParam().with, settings);
    return settings;
  }
  RenderResult render_room(const Scene& room, const RenderPlan& settings) {
    Scene scene = scene_with(GetParam().with, room);
    const View view = resolve_view(scene, {}, settings.width, settings.height);
    const PackedScene packed = pack(scene, {.direct = settings.direct, .light_groups = settings.light_groups});
    return render(device(), packed, view, settings, RenderHooks{}, shared_kernels(device()));
  }
  void expect_sums_of_picture();
};

class GroupRender : public RenderWithGroups {};
class GroupsWith : public RenderWithGroups {}; // other things asked for
class GroupAlone : public RenderWithGroups {}; // of few ways, as it takes longer

struct Total {
  gpu::ExactSum sum[3]{};
  std::uint32_t top[3]{}, count = 0;
};

void add_up(Total& total, const gpu::FilmPixel& pixel) {
  const gpu::ExactSum* sums[] = {&pixel.red, &pixel.green, &pixel.blue};
  for (int c = 0; c < 3; ++c) add(total.sum[c], total.top[c], *sums[c], pixel.tops >> 8 * c & 0xff);
  total.count += pixel.count;
}

void add_up(std::array<std::uint32_t, 12>& total, const gpu::SplatPixel& pixel) {
  for (int c = 0; c < 3; ++c) {
    const std::uint32_t* words = c == 0 ? pixel.red : c == 1 ? pixel.green : pixel.blue;
    std::uint64_t carry = 0;
    for (int w = 0; w < 4; ++w) {
      carry += std::uint64_t{total[static_cast<std::size_t>(4 * c + w)]} + words[w];
      total[static_cast<std::size_t>(4 * c + w)] = static_cast<std::uint32_t>(carry);
      carry >>= 32;
    }
  }
}

// Not to within rounding: digit by digit.
void RenderWithGroups::expect_sums_of_picture() {
  const Scene scene = lit_room();
  const RenderResult result = render_room(scene, settings(scene, {"left", "Key", "glow", "environment"}));
  const Film& film = *result.film;
  ASSERT_EQ(film.group_count, 5u);
  const std::size_t pixels = std::size_t{film.width} * film.height, entries = film.shape().entries();
  ASSERT_EQ(film.has_probes, GetParam().side > 100);
  std::array<bool, 5> shines{};
  for (std::size_t entry = 0; entry < entries; ++entry) {
    Total picture, groups;
    if (film.has_probes)
      add_up(picture, film.pixels[entry]);
    else
      add_up(picture, film.pixels[2 * entry]), add_up(picture, film.pixels[2 * entry + 1]);
    for (std::uint32_t g = 0; g < film.group_count; ++g) {
      const gpu::FilmPixel& group = film.groups[entry * film.group_count + g];
      add_up(groups, group);
      ASSERT_EQ(group.count, picture.count);
      shines[g] = shines[g] || group.largest > 0.0f;
    }
    for (int c = 0; c < 3; ++c) {
      ASSERT_EQ(groups.top[c], picture.top[c]) << entry;
      ASSERT_EQ(digit_sum(groups.sum[c].high), digit_sum(picture.sum[c].high)) << entry;
      ASSERT_EQ(digit_sum(groups.sum[c].low), digit_sum(picture.sum[c].low)) << entry;
    }
  }
  EXPECT_TRUE(std::ranges::count(shines, true) > 0 || !film.splats.empty());
  if (GetParam().techniques == gpu::kTechniquesAll) {
    EXPECT_EQ(std::ranges::count(shines, true), 5) << "a group that gets no light shows nothing";
  }
  ASSERT_EQ(film.group_splats.empty(), film.splats.empty());
  bool splatted = false;
  for (std::size_t pixel = 0; pixel < (film.splats.empty() ? 0 : pixels); ++pixel) {
    std::array<std::uint32_t, 12> picture{}, groups{};
    for (std::size_t r = 0; r < 2; ++r) add_up(picture, film.splats[2 * pixel + r]);
    for (std::uint32_t g = 0; g < film.group_count; ++g)
      add_up(groups, film.group_splats[pixel * film.group_count + g]);
    ASSERT_EQ(groups, picture) << pixel;
    splatted = splatted || std::ranges::any_of(picture, [](std::uint32_t word) { return word != 0; });
  }
  EXPECT_EQ(splatted, !film.splats.empty() && GetParam().techniques & gpu::kTechniqueSplat);
  // In floats: each layer is rounded once, and so is the picture.
  const Picture& picture = result.picture;
  for (const char* c : {"R", "G", "B"}) {
    const std::vector<float>& all = find_channel(picture, c)->values;
    std::vector<double> sum(all.size());
    for (const char* name : {"left", "Key", "glow", "environment", "rest"}) {
      const Channel* layer = find_channel(picture, fmt::format("group.{}.{}", name, c));
      ASSERT_NE(layer, nullptr) << name;
      for (std::size_t i = 0; i < all.size(); ++i) sum[i] += double{layer->values[i]};
    }
    for (std::size_t i = 0; i < all.size(); ++i)
      ASSERT_NEAR(sum[i], double{all[i]}, 3.0 * 0x1p-23 * double{all[i]}) << i;
  }
}

TEST_P(GroupRender, SumsOfGroupsAreThoseOfThePictureInIntegers) { expect_sums_of_picture(); }
TEST_P(GroupsWith, SumsOfGroupsAreThoseOfThePictureInIntegers) { expect_sums_of_picture(); }

// The picture is the same but for the rounding of sums of few floats.
TEST_P(GroupRender, GroupsLeaveThePictureAsItIs) {
  const Scene scene = lit_room();
  const Picture with = render_room(scene, settings(scene, {"each"})).picture,
                without = render_room(scene, settings(scene, {})).picture;
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < with.channels[c].values.size(); ++i)
      ASSERT_NEAR(with.channels[c].values[i], without.channels[c].values[i],
                  2e-6 * (1e-3 + without.channels[c].values[i]));
}

// Light of a whole picture by several seeds.
struct Spread {
  double mean = 0.0, variance = 0.0; // of the mean
};
template <class Light>
Spread spread_of(Light light) {
  constexpr std::uint32_t kSeeds = 16;
  double sum = 0.0, squares = 0.0;
  for (std::uint32_t seed = 1; seed <= kSeeds; ++seed) {
    const double value = light(seed);
    sum += value, squares += value * value;
  }
  const double mean = sum / kSeeds;
  return {mean, std::max(0.0, squares / kSeeds - mean * mean) / (kSeeds - 1)};
}

double light_of(const Picture& picture, const std::string& prefix) {
  double sum = 0.0;
  for (const char* c : {"R", "G", "B"}) {
    const std::vector<float>& values = find_channel(picture, prefix + c)->values;
    sum += std::accumulate(values.begin(), values.end(), 0.0);
  }
  return sum;
}

// The scene with the light of one group alone: by name as in the test below.
Scene room_with_only(const std::string& name) {
  Scene scene = lit_room();
  if (name != "environment") scene.environment = {};
  if (name != "Key") scene.lights[0].intensity = glm::vec3(0.0f);
  if (name != "rest") scene.lights[1].intensity = glm::vec3(0.0f);
  if (name != "rest") scene.materials[2].base_color = {0.0f, 0.0f, 0.0f, 1.0f};
  Material dark = scene.materials[1];
  dark.emission = glm::vec3(0.0f);
  scene.materials.push_back(dark);
  const auto darken = [&](std::uint32_t node) {
    for (Instance& instance : scene.instances)
      if (instance.node == node) {
        scene.meshes.push_back(scene.meshes[instance.mesh]);
        scene.meshes.back().primitives[0].material = 4;
        instance.mesh = static_cast<std::uint32_t>(scene.meshes.size() - 1);
      }
  };
  if (name != "left") darken(1);
  if (name != "glow") darken(2), darken(3);
  return scene;
}

TEST_P(GroupAlone, IsTheLightOfItsLights) {
  const Scene scene = lit_room();
  RenderPlan with = settings(scene, {"left", "Key", "glow", "environment"});
  with.last_sample = std::max(with.last_sample, 16u);
  std::vector<Picture> pictures;
  for (with.seed = 1; with.seed <= 16; ++with.seed) pictures.push_back(render_room(scene, with).picture);
  for (const std::string name : {"left", "Key", "glow", "environment", "rest"}) {
    const Spread group =
        spread_of([&](std::uint32_t seed) { return light_of(pictures[seed - 1], fmt::format("group.{}.", name)); });
    const Scene alone = room_with_only(name);
    RenderPlan plain = settings(alone, {});
    plain.last_sample = with.last_sample;
    const Spread other = spread_of([&](std::uint32_t seed) {
      plain.seed = 1000 + seed;
      return light_of(render_room(alone, plain).picture, "");
    });
    const double deviation = std::sqrt(group.variance + other.variance);
    EXPECT_GT(group.mean, 0.0) << name;
    EXPECT_LT(std::abs(group.mean - other.mean), 4.5 * deviation + 1e-6 * other.mean)
        << name << ": " << group.mean << " and " << other.mean;
    EXPECT_LT(deviation, 0.03 * other.mean) << name << ": too much noise to tell";
  }
}

// The sliders of a window: each group by its gain, as `relight` mixes them.
TEST_P(GroupRender, AWindowMixesThem) {
  Scene scene = lit_room();
  const RenderPlan plan = settings(scene, {"left", "Key", "environment"});
  const PackedScene packed = pack(scene, {.direct = plan.direct, .light_groups = plan.light_groups});
  const View view = resolve_view(scene, {}, plan.width, plan.height);
  Progressive progressive(device(), packed, view, plan, shared_kernels(device()));
  while (progressive.status().fraction < 1.0) progressive.step();
  Display display(device());
  for (const std::vector<float>& gains : {std::vector<float>{0.0f, 2.0f, 0.5f, 1.0f}, {1.0f, 1.0f, 1.0f, 1.0f}, {}}) {
    Picture expected = progressive.picture();
    std::vector<GroupGain> factors;
    for (std::size_t g = 0; g < gains.size(); ++g) factors.push_back({plan.group_names[g], glm::dvec3(gains[g])});
    relight("", plan.group_names, factors, expected);
    display.draw(progressive, {.tonemap = Tonemap::none, .group_gains = gains});
    const auto words = download<std::uint32_t>(display.pixels(), std::size_t{plan.width} * plan.height);
    for (std::size_t i = 0; i < words.size(); ++i)
      for (std::size_t c = 0; c < 3; ++c) {
        const float value = to_srgb(std::clamp(expected.channels[c].values[i], 0.0f, 1.0f));
        ASSERT_NEAR(static_cast<int>(words[i] >> 8 * c & 0xff), 255.0f * value, 1.0) << i;
      }
  }
}

std::string name_of(const testing::TestParamInfo<Way>& info) {
  const Way& way = info.param;
  return fmt::format("{}{}{}{}", way.integrator, way.aovs.empty() ? "" : "_halved", way.side > 100 ? "_probes" : "",
                     way.techniques == gpu::kTechniquesAll ? "" : fmt::format("_{}", way.techniques)) +
         (way.with.empty() ? "" : "_" + way.with);
}

INSTANTIATE_TEST_SUITE_P(All, GroupRender,
                         testing::Values(Way{"path", {}}, Way{"path", {"variance"}}, Way{"path", {}, 192},
                                         Way{"bidirectional", {}},
                                         Way{"bidirectional", {}, 24, gpu::kTechniqueConnect | gpu::kTechniqueSplat},
                                         Way{"bidirectional", {}, 24, gpu::kTechniqueMerge}),
                         name_of);
Way way_with(const char* integrator, const char* what) { return {integrator, {}, 24, gpu::kTechniquesAll, what}; }

INSTANTIATE_TEST_SUITE_P(All, GroupsWith,
                         testing::Values(way_with("path", "soft_lamps"), way_with("bidirectional", "soft_lamps"),
                                         way_with("path", "volume"), way_with("bidirectional", "volume"),
                                         way_with("path", "transparent"), way_with("bidirectional", "transparent"),
                                         way_with("path", "catcher"), way_with("path", "clamp"),
                                         way_with("path", "guide"), way_with("path", "adaptive")),
                         name_of);
INSTANTIATE_TEST_SUITE_P(All, GroupAlone,
                         testing::Values(Way{"path", {}}, Way{"bidirectional", {}}, way_with("path", "soft_lamps"),
                                         way_with("bidirectional", "soft_lamps"), way_with("path", "volume"),
                                         way_with("path", "guide")),
                         name_of);

TEST(LightGroups, MemoryPlanCountsTheirBuffers) {
  const Scene scene = lit_room();
  RenderPlan settings;
  settings.integrator = find_integrator("path");
  const ScenePlan planned = plan(scene);
  const gpu::Feature features = expected_features(scene, settings.direct);
  const MemoryPlan without = plan_memory(settings, planned, features);
  settings.light_groups = {"each"}, settings.group_names = find_group_names(scene, {"each"});
  settings.reuse = kReuseOff;
  const MemoryPlan with = plan_memory(settings, planned, features);
  const std::uint64_t film = std::uint64_t{settings.width} * settings.height * 5 * sizeof(gpu::FilmPixel);
  EXPECT_GE(total_bytes(with.render), total_bytes(without.render) + film);
  EXPECT_EQ(total_bytes(with.path), total_bytes(without.path) + 16 * sizeof(float));
}

// Of the program.
class GroupProgram : public ProgramTest {
protected:
  Outcome run(std::vector<std::string> words) const {
    words.insert(words.begin(), WAVEPATH_BINARY);
    return run_program(words, {.folder = folder_.path().string()});
  }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  bool exists(const std::string& name) const { return std::filesystem::exists(path(name)); }

  // A floor under two lamps, "Key" and "Fill light", and a panel of material "glow".
  std::string scene(double key = 3.0, double fill = 3.0, const std::array<double, 3>& glow = {1.0, 0.6, 0.2}) const {
    GltfBuilder b;
    const int positions = b.floats("VEC3", {-1, 0, 1, 1, 0, 1, 1, 0, -1, -1, 0, -1});
    const int indices = b.accessor("SCALAR", kUshort, std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3});
    b.root["materials"] = {{{"name", "paint"}}, {{"name", "glow"}, {"emissiveFactor", glow}, {"doubleSided", true}}};
    const int floor = b.mesh_node({{"POSITION", positions}}, {{"indices", indices}, {"material", 0}});
    const int panel = b.mesh_node({{"POSITION", positions}}, {{"indices", indices}, {"material", 1}});
    b.root["nodes"][static_cast<unsigned>(floor)]["scale"] = {3, 1, 3};
    b.root["nodes"][static_cast<unsigned>(panel)]["translation"] = {1.5, 1.0, 0};
    b.root["nodes"][static_cast<unsigned>(panel)]["scale"] = {0.4, 1, 0.4};
    std::vector<int> shown = {floor, panel};
    nlohmann::json& lights = b.root["extensions"]["KHR_lights_punctual"]["lights"];
    for (const char* name : {"Key", "Fill light"}) {
      lights.push_back({{"type", "point"}, {"intensity", name[0] == 'K' ? key : fill}});
      shown.push_back(b.add("nodes", {{"name", name},
                                      {"translation", {name[0] == 'K' ? -1.0 : 1.0, 1.5, 0.5}},
                                      {"extensions", {{"KHR_lights_punctual", {{"light", lights.size() - 1}}}}}}));
    }
    b.root["extensionsUsed"] = {"KHR_lights_punctual"};
    b.root["scenes"] = {{{"nodes", shown}}};
    b.root["scene"] = 0;
    return folder_.write("scene.glb", b.glb()).string();
  }
  Outcome render(const std::string& output, std::vector<std::string> flags) const {
    std::vector<std::string> all{"render", scene(), "--size", "48x32", "--spp", "12",
                                 "--env",  "black", "-q",     "-o",    output};
    all.insert(all.end(), flags.begin(), flags.end());
    return run(all);
  }
  void expect_same_bits(const std::string& a, const std::string& b) const {
    const Picture first = read_picture(path(a)), second = read_picture(path(b));
    ASSERT_EQ(first.channels.size(), second.channels.size());
    for (const Channel& channel : first.channels) {
      ASSERT_NE(find_channel(second, channel.name), nullptr) << channel.name;
      EXPECT_EQ(channel.values, find_channel(second, channel.name)->values) << channel.name;
    }
  }

  TempFolder folder_;
};

TEST_F(GroupProgram, PartsStatesAndDevicesGiveTheBitsOfTheWhole) {
  for (const std::string integrator : {"path", "bidirectional"}) {
    const std::vector<std::string> flags{"--integrator", integrator, "--light-groups", "Key,glow"};
    const auto with = [&](std::vector<std::string> more) {
      more.insert(more.begin(), flags.begin(), flags.end());
      return more;
    };
    ASSERT_EQ(render("whole.exr", with({"--mergeable"})).exit_code, 0);
    ASSERT_EQ(render("a.exr", with({"--samples", "0:5"})).exit_code, 0);
    ASSERT_EQ(render("b.exr", with({"--samples", "5:12"})).exit_code, 0);
    const Outcome merged = run({"merge", "a.exr", "b.exr", "-q", "-o", "merged.exr"});
    ASSERT_EQ(merged.exit_code, 0) << merged.err;
    expect_same_bits("merged.exr", "whole.exr");
    EXPECT_NE(find_channel(read_picture(path("merged.exr")), "group.rest.G"), nullptr);
    EXPECT_EQ(read_attribute(path("merged.exr"), kGroupsText), read_attribute(path("whole.exr"), kGroupsText));

    std::filesystem::remove(path("state"));
    ASSERT_EQ(render("first.exr", with({"--mergeable", "--spp", "4", "--checkpoint", "state"})).exit_code, 0);
    const Outcome resumed = render("resumed.exr", with({"--mergeable", "--checkpoint", "state", "--resume"}));
    ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
    expect_same_bits("resumed.exr", "whole.exr");

    const Outcome shared = render("shared.exr", with({"--devices", "0,0"}));
    ASSERT_EQ(shared.exit_code, 0) << shared.err;
    expect_same_bits("shared.exr", "whole.exr");

    // Other groups are another film.
    ASSERT_EQ(
        render("other.exr", {"--integrator", integrator, "--light-groups", "each", "--samples", "5:12"}).exit_code, 0);
    EXPECT_EQ(run({"merge", "a.exr", "other.exr", "-q", "-o", "no.exr"}).exit_code, 1);
    EXPECT_FALSE(exists("no.exr"));
  }
}

TEST_F(GroupProgram, ACommandRepeatsThemAndStatsTellTheirShares) {
  ASSERT_EQ(render("whole.exr", {"--light-groups", "Fill light,glow", "--stats", "stats.json"}).exit_code, 0);
  const Json stats = Json::parse(std::ifstream(path("stats.json")));
  ASSERT_EQ(stats["light_groups"].size(), 3u);
  EXPECT_EQ(stats["light_groups"][0]["name"], "Fill light");
  EXPECT_EQ(stats["light_groups"][0]["layer"], "group.Fill_light");
  double shares = 0.0;
  for (const Json& group : stats["light_groups"]) shares += group["share"].get<double>();
  EXPECT_NEAR(shares, 1.0, 1e-12);
  EXPECT_EQ(stats["settings"]["reuse"], "off");
  const std::string command = stats["repeat"];
  EXPECT_NE(command.find("--light-groups 'Fill light,glow'"), std::string::npos) << command;
  const std::string line = WAVEPATH_BINARY + command.substr(8) + " -q -o again.exr";
  ASSERT_EQ(run_program({"/bin/sh", "-c", line}, {.folder = folder_.path().string()}).exit_code, 0) << line;
  expect_same_bits("again.exr", "whole.exr");
}

TEST_F(GroupProgram, InfoListsThemOrTheNamesThatTheyMayHave) {
  const auto told = [&](std::vector<std::string> more) {
    std::vector<std::string> words{"info", scene(), "--env", "black"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.out;
  };
  const Json without = Json::parse(told({"--json"}))["lights"];
  EXPECT_TRUE(without["groups"].is_null());
  EXPECT_EQ(without["names"], (Json{"Key", "Fill light", "glow"}));
  EXPECT_NE(told({}).find("\n  named       Key, Fill light, glow\n"), std::string::npos);
  const Json groups = Json::parse(told({"--json", "--light-groups", "Fill light,glow"}))["lights"]["groups"];
  ASSERT_EQ(groups.size(), 3u);
  EXPECT_EQ(groups[0]["layer"], "group.Fill_light");
  EXPECT_EQ(groups[1]["lights"], Json{"glow"});
  EXPECT_EQ(groups[2], (Json{{"name", "rest"}, {"layer", "group.rest"}, {"lights", {"Key"}}}));
  EXPECT_NE(told({"--light-groups", "Fill light"}).find("\n  group       rest: Key, glow\n"), std::string::npos);
  const Outcome refused = run({"info", scene(), "--light-groups", "nobody"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("Key, Fill light, glow"), std::string::npos) << refused.err;
}

// The picture that the window saves is that of the line which it copies.
TEST_F(GroupProgram, TheCopiedLineOfAMixRepeatsIt) {
  ASSERT_EQ(render("whole.exr", {"--light-groups", "Fill light,glow", "--reuse", "off"}).exit_code, 0);
  RenderPlan settings;
  settings.integrator = find_integrator("path");
  settings.width = 48, settings.height = 32, settings.last_sample = 12;
  settings.reuse = kReuseOff;
  settings.light_groups = {"Fill light", "glow"}, settings.group_names = {"Fill light", "glow", "rest"};
  DisplayOptions display{.exposure = 0.5, .tonemap = Tonemap::aces};
  display.group_gains = {1.0f, 1.0f, 1.0f};
  const std::string plain = render_line(scene(), {}, settings, display, " --env black");
  EXPECT_EQ(plain.find("relight"), std::string::npos) << plain;
  EXPECT_NE(plain.find(" --exposure 0.5 --tonemap aces"), std::string::npos) << plain;

  display.group_gains = {0.3f, 1.0f, 2.25f};
  const std::string line = render_line(scene(), {}, settings, display, " --env black");
  EXPECT_NE(line.find(" && wavepath relight light_groups.exr --gain 'Fill light=0.3' --gain rest=2.25 --exposure 0.5"),
            std::string::npos)
      << line;
  const std::string words =
      fmt::format("wavepath() {{ {} \"$@\" -q; }}; {} -o mix.exr -o mix.png", WAVEPATH_BINARY, line);
  const Outcome outcome = run_program({"/bin/sh", "-c", words}, {.folder = folder_.path().string()});
  ASSERT_EQ(outcome.exit_code, 0) << words << outcome.err;
  EXPECT_TRUE(exists("mix.png"));
  Picture shown = read_picture(path("whole.exr"));
  relight("whole.exr", settings.group_names, gains_of(settings, display), shown);
  const Picture mix = read_picture(path("mix.exr"));
  for (const char* c : {"R", "G", "B"}) EXPECT_EQ(find_channel(mix, c)->values, find_channel(shown, c)->values) << c;
}

// The mix of scaled layers is the sum of those that it holds, whatever their names.
TEST_F(GroupProgram, RelightWritesTheNewMix) {
  for (const std::string names : {"plain", "blender"}) {
    ASSERT_EQ(render("in.exr", {"--light-groups", "each", "--layers", names, "--aov", "albedo,direct"}).exit_code, 0);
    const Outcome outcome = run({"relight", "in.exr", "--gain", "Key=0", "--gain", "glow=2,1,0.5", "--layers", names,
                                 "-o", "out.exr", "-o", "out.png", "--exposure", "0"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("direct"), std::string::npos) << outcome.err;
    EXPECT_TRUE(exists("out.png"));
    const Picture before = read_picture(path("in.exr")), after = read_picture(path("out.exr"));
    EXPECT_EQ(find_channel(after, "direct.R"), nullptr);
    EXPECT_EQ(find_channel(after, "albedo.R")->values, find_channel(before, "albedo.R")->values);
    EXPECT_EQ(read_attribute(path("out.exr"), kGainsText), "Key=0,0,0 glow=2,1,0.5");
    const double gains[3][3] = {{0, 0, 0}, {1, 1, 1}, {2, 1, 0.5}};
    const char* layers[] = {"group.Key.", "group.Fill_light.", "group.glow."};
    for (int c = 0; c < 3; ++c) {
      const std::string letter(1, "RGB"[c]);
      for (std::size_t i = 0; i < after.channels[0].values.size(); ++i) {
        double sum = 0.0;
        for (int g = 0; g < 3; ++g) {
          const double scaled = gains[g][c] * double{find_channel(before, layers[g] + letter)->values[i]};
          ASSERT_EQ(find_channel(after, layers[g] + letter)->values[i], static_cast<float>(scaled));
          sum += scaled;
        }
        ASSERT_EQ(find_channel(after, letter)->values[i], static_cast<float>(sum));
      }
    }
    // A mix can be mixed again.
    ASSERT_EQ(run({"relight", "out.exr", "--gain", "glow=0", "-q", "-o", "dark.exr"}).exit_code, 0);
    EXPECT_EQ(find_channel(read_picture(path("dark.exr")), "R")->values,
              find_channel(after, "group.Fill_light.R")->values);
  }
  const std::string header = [&] {
    std::ifstream file(path("in.exr"), std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
  }();
  EXPECT_NE(header.find("ViewLayer.Combined_Fill_light.R"), std::string::npos);
}

// Where paths do not go by the power of lights, or all lights change alike, a mix is the render of a scene that has
// other lamps, but for rounding.
TEST_F(GroupProgram, AMixIsTheRenderOfOtherLamps) {
  struct Case {
    std::vector<std::string> flags, gains;
    double key, fill;
    std::array<double, 3> glow;
  };
  const Case cases[] = {
      {{"--integrator", "path", "--reuse", "off", "--direct", "bsdf"}, {"glow=0.5,1,4"}, 3.0, 3.0, {0.5, 0.6, 0.8}},
      {{"--integrator", "path", "--reuse", "off"},
       {"Key=0.5", "Fill light=0.5", "glow=0.5"},
       1.5,
       1.5,
       {0.5, 0.3, 0.1}},
      {{"--integrator", "bidirectional"}, {"Key=0.5", "Fill light=0.5", "glow=0.5"}, 1.5, 1.5, {0.5, 0.3, 0.1}}};
  for (const Case& test : cases) {
    const auto shoot = [&](const std::string& file, const std::string& output, std::vector<std::string> more) {
      std::vector<std::string> words{"render", file,    "--size", "48x32", "--spp", "12",
                                     "--env",  "black", "-q",     "-o",    output};
      words.insert(words.end(), test.flags.begin(), test.flags.end());
      words.insert(words.end(), more.begin(), more.end());
      const Outcome outcome = run(words);
      ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    };
    shoot(scene(), "groups.exr", {"--light-groups", "each"});
    shoot(scene(test.key, test.fill, test.glow), "other.exr", {});
    std::vector<std::string> words{"relight", "groups.exr", "-q", "-o", "mix.exr"};
    for (const std::string& gain : test.gains) words.insert(words.end(), {"--gain", gain});
    ASSERT_EQ(run(words).exit_code, 0);
    const Picture mix = read_picture(path("mix.exr")), other = read_picture(path("other.exr"));
    EXPECT_NE(find_channel(read_picture(path("groups.exr")), "B")->values, find_channel(mix, "B")->values);
    for (const char* c : {"R", "G", "B"})
      for (std::size_t i = 0; i < mix.channels[0].values.size(); ++i) {
        const double expected = find_channel(other, c)->values[i];
        ASSERT_NEAR(find_channel(mix, c)->values[i], expected, 1e-5 * (1e-3 + expected))
            << test.flags[1] << " " << c << " " << i;
      }
  }
}

TEST_F(GroupProgram, BadInputIsOneLineAndNoFile) {
  ASSERT_EQ(render("in.exr", {"--light-groups", "Key"}).exit_code, 0);
  ASSERT_EQ(render("plain.exr", {}).exit_code, 0);
  const auto refused = [&](const Outcome& outcome, int code, const std::string& says) {
    EXPECT_EQ(outcome.exit_code, code) << outcome.err;
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
    EXPECT_NE(outcome.err.find(says), std::string::npos) << outcome.err;
    EXPECT_FALSE(exists("out.exr"));
  };
  std::string many = "a0";
  for (int i = 1; i < 17; ++i) many += fmt::format(",a{}", i);
  for (const auto& [names, says] : {std::pair<std::string, std::string>{"nobody", "glow"},
                                    {"Key,Key", "twice"},
                                    {"Key,,glow", "empty"},
                                    {"", "empty"},
                                    {"each,Key", "each"},
                                    {"environment", "environment"},
                                    {many, "16"}})
    refused(render("out.exr", {"--light-groups", names}), 2, says);
  refused(render("out.exr", {"--light-groups", "Key", "--reuse", "on"}), 2, "--reuse");
  for (const char* integrator : {"hybrid", "whitted", "ao"})
    refused(render("out.exr", {"--light-groups", "Key", "--integrator", integrator}), 2, integrator);

  const auto relit = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"relight"});
    return run(words);
  };
  refused(relit({"in.exr", "--gain", "nobody=2", "-o", "out.exr"}), 2, "Key");
  refused(relit({"in.exr", "--gain", "Key", "-o", "out.exr"}), 2, "NAME=X");
  refused(relit({"in.exr", "--gain", "Key=-1", "-o", "out.exr"}), 2, "--gain");
  refused(relit({"in.exr", "--gain", "Key=1,nan,1", "-o", "out.exr"}), 2, "--gain");
  refused(relit({"in.exr", "--gain", "Key=1", "--gain", "Key=2", "-o", "out.exr"}), 2, "twice");
  refused(relit({"in.exr", "--gain", "Key=1"}), 2, "-o");
  refused(relit({"plain.exr", "--gain", "Key=1", "-o", "out.exr"}), 1, "no groups");
  refused(relit({"none.exr", "--gain", "Key=1", "-o", "out.exr"}), 1, "does not exist");
  EXPECT_EQ(relit({"in.exr", "--gain", "Key=1", "-o", "in.exr"}).exit_code, 2);
}

} // namespace
} // namespace wavepath::test
