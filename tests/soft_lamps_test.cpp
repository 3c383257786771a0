// Punctual lights with an extent: light and penumbrae against closed forms, from nothing to as large as the scene, and
// the same light by every estimator and from both ends of paths. Also the clamp of samples.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include <nlohmann/json.hpp>

#include "host/film/exact_sum.h"
#include "host/film/film.h"
#include "host/integrators/hybrid/kind.h"
#include "host/integrators/whitted/kind.h"
#include "host/picture/files/picture_io.h"
#include "host/render/lost_light.h"
#include "host/scene/pack/light_groups.h"
#include "tests/bidirectional_scene.h"
#include "tests/run_wavepath.h"
#include "tests/temporary_folder.h"

namespace wavepath::test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::uint32_t kPixels = 16;

Material white() {
  Material material = plain_material();
  material.base_color = glm::vec4(1.0f);
  return material;
}

// A white floor at y = 0, seen from above by parallel rays: a square of this half width about (x, 0).
Scene white_floor(double half, double x = 0.0, double height = 0.05) {
  Scene scene;
  scene.path = "test";
  scene.materials.push_back(white());
  constexpr float wide = 10.0f;
  add_instance(scene, add_mesh(scene, quad({-wide, 0, wide}, {wide, 0, wide}, {wide, 0, -wide}, {-wide, 0, -wide})));
  Camera camera;
  camera.orthographic = true;
  camera.xmag = camera.ymag = half;
  camera.world_from_camera =
      glm::dmat4(glm::dvec4(1, 0, 0, 0), glm::dvec4(0, 0, -1, 0), glm::dvec4(0, 1, 0, 0), glm::dvec4(x, height, 0, 1));
  scene.cameras.push_back(camera);
  return scene;
}

PunctualLight lamp_at(LightKind kind, const glm::dvec3& position, const glm::dvec3& direction, double extent) {
  PunctualLight light;
  light.kind = kind;
  light.intensity = glm::vec3(1.0f);
  light.position = position;
  light.direction = glm::normalize(direction);
  light.extent = extent;
  return light;
}

// Fraction of a sun at the zenith, of this half angle, that a point of the floor sees past a half-plane over x < 0 at
// this height: by areas in the projection of directions onto the floor, in which the sun is a disc and the edge half an
// ellipse.
double fraction_in_sight(double half_angle, double x, double height) {
  const double radius = std::sin(half_angle), k = -x / height;
  constexpr int kSteps = 4000;
  double area = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double z = radius * (2.0 * (i + 0.5) / kSteps - 1.0), half = std::sqrt(radius * radius - z * z);
    const double edge = k * std::sqrt((1.0 - z * z) / (1.0 + k * k)); // sees directions beyond it
    area += std::clamp(half - edge, 0.0, 2.0 * half) * 2.0 * radius / kSteps;
  }
  return area / (kPi * radius * radius);
}

class SoftLamps : public BidirectionalTest {
protected:
  static RenderPlan square(std::uint32_t spp, std::uint32_t direct, const IntegratorKind& kind = kPath) {
    RenderPlan plan = settings(spp, 1);
    plan.integrator = &kind;
    plan.width = plan.height = kPixels;
    plan.filter = gpu::kFilterBox;
    plan.direct = direct;
    return plan;
  }
  // Of all pixels, as radiance of a white floor times pi.
  double irradiance(const Scene& scene, const RenderPlan& plan) {
    const Picture picture = render(Subject(scene, plan), plan).picture;
    double sum = 0.0;
    for (const float value : picture.channels[0].values) sum += double{value};
    return kPi * sum / (kPixels * kPixels);
  }
};

constexpr std::uint32_t kEstimators[] = {gpu::kDirectMis, gpu::kDirectNee};

// A sphere wholly above the horizon lights as its centre would, whatever its size.
TEST_F(SoftLamps, SpheresLightAsPointsDo) {
  const glm::dvec3 to_lamp(0.6, 2.0, -0.5);
  const double distance = glm::length(to_lamp), expected = to_lamp.y / std::pow(distance, 3.0);
  for (const double radius : {1e-9, 1e-4, 0.1, 1.0, 1.99})
    for (const std::uint32_t direct : kEstimators) {
      SCOPED_TRACE(radius);
      Scene scene = white_floor(1e-5, 0.0, 1e-3);
      scene.lights = {lamp_at(LightKind::point, to_lamp, {0, -1, 0}, radius)};
      EXPECT_NEAR(irradiance(scene, square(1024, direct)), expected, 2e-3 * expected);
    }
}

// The part of a spot's sphere that shines to a point is that whose rays lie in the cone; far from the rim all of it.
TEST_F(SoftLamps, SpotsKeepTheirIntensity) {
  for (const double radius : {1e-3, 0.2}) {
    Scene scene = white_floor(1e-4, 0.0, 1e-3);
    scene.lights = {lamp_at(LightKind::spot, {0, 2, 0}, {0, -1, 0}, radius)};
    scene.lights[0].inner_cone = 0.6, scene.lights[0].outer_cone = 0.8;
    EXPECT_NEAR(irradiance(scene, square(1024, gpu::kDirectMis)), 0.25, 5e-4) << radius;
  }
}

// Inside of a sphere radiance arrives from everywhere.
TEST_F(SoftLamps, SpheresShineInside) {
  for (const IntegratorKind* kind : {&kPath, &kBidirectional}) {
    Scene scene = white_floor(1e-3, 0.0, 1e-2);
    scene.lights = {lamp_at(LightKind::point, {0.1, 0.2, 0.0}, {0, -1, 0}, 0.5)};
    EXPECT_NEAR(irradiance(scene, square(1024, gpu::kDirectMis, *kind)), 4.0, 0.02) << kind->name;
  }
}

// A sun of any size brings E to what faces it, and E times the cosine while it is above the horizon.
TEST_F(SoftLamps, SunsLightAsParallelRaysDo) {
  for (const double degrees : {1e-6, 1e-4, 0.53, 20.0, 89.0})
    for (const double tilt : {0.0, 0.7})
      for (const std::uint32_t direct : kEstimators) {
        SCOPED_TRACE(degrees);
        const double half = glm::radians(0.5 * degrees);
        if (tilt + half > 0.5 * kPi) continue;
        Scene scene = white_floor(1.0);
        scene.lights = {lamp_at(LightKind::directional, {}, {std::sin(tilt), -std::cos(tilt), 0}, half)};
        EXPECT_NEAR(irradiance(scene, square(1024, direct)), std::cos(tilt), 2e-3) << tilt;
      }
}

// By every estimator, and with light paths.
TEST_F(SoftLamps, PenumbraIsThatOfTheClosedForm) {
  const double half_angle = glm::radians(8.0), height = 2.0, reach = height * std::tan(half_angle);
  for (const double at : {-1.2, -0.6, 0.0, 0.4, 0.9, 1.2}) {
    const double x = at * reach, expected = fraction_in_sight(half_angle, x, height);
    for (const bool is_lamp : {false, true}) {
      Scene scene = white_floor(1e-4, x);
      const auto y = static_cast<float>(height);
      add_instance(scene, add_mesh(scene, quad({-500, y, 500}, {0, y, 500}, {0, y, -500}, {-500, y, -500})));
      if (is_lamp) // far away, and as wide there
        scene.lights = {lamp_at(LightKind::point, {x, 1e3, 0}, {0, -1, 0}, 1e3 * std::sin(half_angle))};
      else
        scene.lights = {lamp_at(LightKind::directional, {}, {0, -1, 0}, half_angle)};
      if (is_lamp) scene.lights[0].intensity = glm::vec3(1e6f);
      for (const std::uint32_t direct : kEstimators)
        EXPECT_NEAR(irradiance(scene, square(1024, direct)), expected, 3e-3) << at << (is_lamp ? " lamp" : " sun");
      for (const IntegratorKind* kind : {&kBidirectional, &kHybrid})
        EXPECT_NEAR(irradiance(scene, square(1024, gpu::kDirectMis, *kind)), expected, 6e-3) << at << kind->name;
    }
  }
}

Scene corner_with(std::vector<LightKind> kinds, double extent, bool smooth = false) {
  Scene scene = corner();
  if (smooth) scene.materials[1].roughness = 0.0f;
  for (const LightKind kind : kinds) {
    add_lamp(scene, kind);
    scene.lights.back().extent = kind == LightKind::directional ? 0.4 * extent : extent;
    scene.lights.back().position.x -= 0.7 * static_cast<double>(scene.lights.size() - 1);
  }
  return scene;
}

// A plate of metal reflects what mis finds by its BSDF and nee by light samples; a mirror reflects by rays alone.
TEST_F(SoftLamps, EstimatorsAgree) {
  for (const bool smooth : {false, true}) {
    const Scene scene = corner_with({LightKind::point, LightKind::spot, LightKind::directional}, 0.3, smooth);
    RenderPlan mis = path_settings(512, 3), nee = mis;
    nee.direct = gpu::kDirectNee;
    expect_same_mean(average(Subject(scene, mis), mis), average(Subject(scene, nee), nee));
    if (smooth) expect_path_light(scene, 3, {gpu::kTechniquesAll, kHit | kLight}, 64);
  }
}

TEST_F(SoftLamps, LightPathsFindTheSame) {
  const std::vector<std::uint32_t> sets = {gpu::kTechniquesAll, kHit | kLight,   kLight | kConnect,
                                           kHit | kSplat,       kLight | kSplat, kLight | kConnect | kSplat};
  for (const LightKind kind : {LightKind::point, LightKind::spot, LightKind::directional}) {
    SCOPED_TRACE(static_cast<int>(kind));
    expect_path_light(corner_with({kind}, 0.3), 3, sets, 64);
  }
  SCOPED_TRACE("mirror");
  expect_path_light(corner_with({LightKind::point, LightKind::directional}, 0.3, true), 3,
                    {gpu::kTechniquesAll, kHit | kLight}, 64);
}

// Many lamps: by the tree, and by trained probabilities. Lamps touch the floor and each other.
TEST_F(SoftLamps, ManyLampsAreChosenLikewise) {
  Scene scene = corner_with(std::vector<LightKind>(14, LightKind::point), 0.12);
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    const double at = static_cast<double>(i);
    scene.lights[i].position = {-1.6 + 0.24 * at, -0.42 + 0.1 * std::fmod(3.0 * at, 7.0), 0.3 + 0.4 * std::sin(at)};
    scene.lights[i].intensity *= 0.05f;
  }
  add_lamp(scene, LightKind::directional);
  scene.lights.back().extent = 0.1;
  RenderPlan power = path_settings(256, 3);
  power.lights = gpu::kLightsPower;
  const Average expected = average(Subject(scene, power), power);
  for (const std::uint32_t lights : {gpu::kLightsTree, gpu::kLightsLearned})
    for (const IntegratorKind* kind : {&kPath, &kBidirectional}) {
      SCOPED_TRACE(kind->name);
      RenderPlan asked = power;
      asked.lights = lights;
      asked.integrator = kind;
      expect_same_mean(average(Subject(scene, asked), asked), expected);
    }
}

// Through a pane in front of the lamp, and with generic kernels and waves of any length.
TEST_F(SoftLamps, ShineThroughPanes) {
  Scene scene = corner_with({LightKind::point}, 0.3);
  Material pane = plain_material();
  pane.transmission = 1.0f, pane.specular = 1.0f, pane.roughness = 0.0f;
  pane.base_color = {0.9f, 0.8f, 0.7f, 1.0f};
  scene.materials.push_back(pane);
  add_instance(scene, add_mesh(scene, quad({-2, 0.9f, 2}, {2, 0.9f, 2}, {2, 0.9f, -1}, {-2, 0.9f, -1}),
                               static_cast<std::uint32_t>(scene.materials.size() - 1)));
  RenderPlan mis = path_settings(512, 4), nee = mis;
  nee.direct = gpu::kDirectNee;
  expect_same_mean(average(Subject(scene, mis), mis), average(Subject(scene, nee), nee));
  RenderPlan few = path_settings(4, 4);
  const Subject subject(scene, few);
  expect_same_film_however_cut(subject, few, *render(subject, few).film);
}

// Without an extent the film is what it was; with one, reuse and light samples keep the light.
TEST_F(SoftLamps, OtherSamplingFindsTheSame) {
  const Scene scene = corner_with({LightKind::point, LightKind::directional}, 0.3);
  RenderPlan plain = path_settings(256, 3);
  plain.reuse = kReuseOff;
  const Average expected = average(Subject(scene, plain), plain);
  RenderPlan reuse = plain, samples = plain;
  reuse.reuse = kReuseOn;
  samples.light_samples = 4;
  expect_same_mean(average(Subject(scene, reuse), reuse), expected);
  expect_same_mean(average(Subject(scene, samples), samples), expected);
}

// A rasterizer finds what is seen, rays the light of it.
TEST_F(SoftLamps, HybridShowsThePenumbraeOfPath) {
  const Scene scene = corner_with({LightKind::point, LightKind::spot, LightKind::directional}, 0.3);
  RenderPlan path = path_settings(256, 1), hybrid = path;
  hybrid.integrator = &kHybrid;
  hybrid.ambient = glm::vec3(0.0f); // direct light alone, as of paths of one bounce
  expect_same_mean(average(Subject(scene, hybrid), hybrid), average(Subject(scene, path), path));
}

TEST_F(SoftLamps, WhittedRefuses) {
  Scene soft = corner_with({LightKind::point}, 0.3), hard = corner_with({LightKind::point}, 0.0);
  RenderPlan plan = path_settings(1, 1);
  EXPECT_NE(kWhitted.unsupported_reason(plan, pack(soft)), "");
  EXPECT_EQ(kWhitted.unsupported_reason(plan, pack(hard)), "");
}

// Rays behind mirrors and glass find soft lamps: nothing is lost.
TEST_F(SoftLamps, AreNotLost) {
  Scene soft = corner_with({LightKind::point}, 0.3, true), hard = corner_with({LightKind::point}, 0.0, true);
  EXPECT_FALSE(may_lose_light(pack(soft)));
  EXPECT_TRUE(may_lose_light(pack(hard)));
}

// ---- --clamp --------------------------------------------------------------------------------------------------------

// A floor of radiance 4 in red and 2 in blue under --clamp 1: dimmed to 1 and 0.5, and three quarters are told as lost.
TEST_F(SoftLamps, ClampDimsSamplesAndCountsTheLight) {
  Scene scene = white_floor(1e-3);
  scene.lights = {lamp_at(LightKind::directional, {}, {0, -1, 0}, 0.0)};
  scene.lights[0].intensity = glm::vec3(4.0 * kPi, 0.0, 2.0 * kPi);
  RenderPlan plan = square(8, gpu::kDirectMis), clamped = plan;
  clamped.clamp = 1.0;
  const RenderResult result = render(Subject(scene, clamped), clamped);
  for (const float value : result.picture.channels[0].values) ASSERT_NEAR(value, 1.0f, 1e-6f);
  for (const float value : result.picture.channels[2].values) ASSERT_NEAR(value, 0.5f, 1e-6f);
  EXPECT_NEAR(clamped_fraction(*result.film, 1.0), 0.75, 0.01);
  RenderPlan far = plan;
  far.clamp = 5.0;
  const RenderResult untouched = render(Subject(scene, far), far);
  EXPECT_EQ(clamped_fraction(*untouched.film, 5.0), 0.0);
  EXPECT_TRUE(*untouched.film == *render(Subject(scene, plan), plan).film) << "what it does not dim stays as it was";
}

TEST_F(SoftLamps, ClampedPartsJoinToTheWhole) {
  const Scene scene = corner_with({LightKind::point}, 0.05);
  RenderPlan whole = path_settings(16, 3), first = whole, second = whole;
  whole.clamp = first.clamp = second.clamp = 0.1;
  whole.adaptive = first.adaptive = second.adaptive = kAdaptiveOff;
  first.last_sample = second.first_sample = 6;
  first.sample_total = second.sample_total = 16;
  const Subject subject(scene, whole);
  const RenderResult expected = render(subject, whole);
  EXPECT_GT(clamped_fraction(*expected.film, 0.1), 0.01);
  Film joined = *render(subject, first).film;
  join(joined, *render(subject, second).film);
  EXPECT_TRUE(joined == *expected.film);
  expect_same_film_however_cut(subject, whole, *expected.film);
}

// A whole sample is dimmed, so each group of it by the same factor: their sums are those of the picture, digit by
// digit.
TEST_F(SoftLamps, ClampedGroupsAddUpToThePicture) {
  Scene scene = corner_with({LightKind::point, LightKind::directional, LightKind::point}, 0.05);
  for (const std::uint32_t probes_from : {1u << 15, 1u}) {
    RenderPlan plain = path_settings(16, 3);
    plain.clamp = 0.4;
    plain.adaptive = kAdaptiveOff;
    plain.reuse = kReuseOff;
    plain.probes_from = probes_from;
    RenderPlan grouped = plain;
    grouped.light_groups = {"each"};
    grouped.group_names = find_group_names(scene, grouped.light_groups);
    Subject subject(scene, grouped);
    subject.packed = pack(scene, {.direct = grouped.direct, .light_groups = grouped.light_groups});
    const RenderResult result = render(subject, grouped), expected = render(Subject(scene, plain), plain);
    const Film& film = *result.film;
    ASSERT_GE(film.group_count, 3u);
    ASSERT_EQ(film.has_probes, probes_from == 1u);
    const std::size_t replicates = film.has_probes ? 1 : gpu::kReplicates;
    const auto add_up = [](gpu::ExactSum& sum, std::uint32_t& top, const gpu::FilmPixel& pixel) {
      add(sum, top, pixel.green, pixel.tops >> 8 & 0xffu);
    };
    for (std::size_t entry = 0; entry < film.shape().entries(); ++entry) {
      gpu::ExactSum picture{}, groups{};
      std::uint32_t picture_top = 0, groups_top = 0;
      for (std::size_t r = 0; r < replicates; ++r) add_up(picture, picture_top, film.pixels[replicates * entry + r]);
      for (std::uint32_t g = 0; g < film.group_count; ++g)
        add_up(groups, groups_top, film.groups[entry * film.group_count + g]);
      ASSERT_EQ(groups_top, picture_top);
      ASSERT_EQ(digit_sum(groups.high), digit_sum(picture.high)) << entry;
      ASSERT_EQ(digit_sum(groups.low), digit_sum(picture.low)) << entry;
    }
    for (std::size_t i = 0; i < expected.picture.channels[1].values.size(); ++i)
      ASSERT_NEAR(result.picture.channels[1].values[i], expected.picture.channels[1].values[i], 1e-6f);
    EXPECT_GT(clamped_fraction(film, 0.4), 0.01);
    EXPECT_NEAR(clamped_fraction(film, 0.4), clamped_fraction(*expected.film, 0.4), 1e-6);
  }
}

// ---- the program ----------------------------------------------------------------------------------------------------

using Json = nlohmann::json;

class SoftLampProgram : public ProgramTest {
protected:
  Outcome run(std::vector<std::string> words) const {
    words.insert(words.begin(), WAVEPATH_BINARY);
    return run_program(words);
  }
  Outcome render(const std::string& output, const std::vector<std::string>& more) const {
    std::vector<std::string> words{
        "render",         kScene, "--sun",   "60,40", "--sun-angle", "5",     "--lamp-radius", "0.05",
        "--integrator",   "path", "--clamp", "0.3",   "--size",      "48x32", "--max-depth",   "3",
        "--light-groups", "each", "--spp",   "12",    "-q",          "-o",    output};
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  }
  void expect_same_bits(const std::string& a, const std::string& b) const {
    const Picture first = read_picture(a), second = read_picture(b);
    ASSERT_EQ(first.channels.size(), second.channels.size());
    for (const Channel& channel : first.channels)
      EXPECT_EQ(channel.values, find_channel(second, channel.name)->values) << channel.name;
    EXPECT_EQ(read_attribute(a, "wavepath.bias"), read_attribute(b, "wavepath.bias"));
  }

  static constexpr const char* kScene = WAVEPATH_SOURCE_DIR "/scenes/analytic/point_light.gltf";
  TemporaryFolder folder_;
};

// The clamp's share in `bias` is that of all samples, too.
TEST_F(SoftLampProgram, PartsStatesAndDevicesGiveTheBitsOfTheWhole) {
  const std::string whole = folder_.file("whole.exr"), first = folder_.file("a.exr"), second = folder_.file("b.exr"),
                    again = folder_.file("again.exr"), state = folder_.file("state");
  const Outcome outcome = render(whole, {"--mergeable"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string bias = read_attribute(whole, "wavepath.bias");
  EXPECT_NE(bias.find("(--clamp), which took "), std::string::npos) << bias;
  EXPECT_NE(bias.find("under 5 degrees (--sun-angle)"), std::string::npos) << bias;
  EXPECT_NE(bias.find("of radius 0.05 m (--lamp-radius)"), std::string::npos) << bias;

  ASSERT_EQ(render(first, {"--samples", "0:1"}).exit_code, 0);
  ASSERT_EQ(render(second, {"--samples", "1:12"}).exit_code, 0);
  EXPECT_NE(read_attribute(first, "wavepath.bias"), bias) << "a part that tells the share of the whole by chance";
  const Outcome merged = run({"merge", first, second, "-q", "-o", again});
  ASSERT_EQ(merged.exit_code, 0) << merged.err;
  expect_same_bits(again, whole);

  ASSERT_EQ(render(first, {"--mergeable", "--spp", "4", "--checkpoint", state}).exit_code, 0);
  ASSERT_EQ(render(again, {"--mergeable", "--checkpoint", state, "--resume"}).exit_code, 0);
  expect_same_bits(again, whole);
  const Outcome shared = render(again, {"--mergeable", "--devices", "0,0"});
  ASSERT_EQ(shared.exit_code, 0) << shared.err;
  expect_same_bits(again, whole);

  const Outcome other = render(second, {"--samples", "1:12", "--sun-angle", "6"});
  ASSERT_EQ(other.exit_code, 0) << other.err;
  ASSERT_EQ(render(first, {"--samples", "0:1"}).exit_code, 0);
  EXPECT_EQ(run({"merge", first, second, "-q", "-o", folder_.file("no.exr")}).exit_code, 1);
  EXPECT_FALSE(std::filesystem::exists(folder_.file("no.exr")));
}

TEST_F(SoftLampProgram, InfoAndStatsTellTheExtents) {
  const Outcome told = run({"info", kScene, "--sun", "60,40", "--sun-angle", "5", "--json"});
  ASSERT_EQ(told.exit_code, 0) << told.err;
  const Json soft = Json::parse(told.out)["lights"]["soft"];
  EXPECT_NEAR(soft["sun_angle"].get<double>(), 5.0, 1e-5);
  EXPECT_TRUE(soft["lamp_radius"].is_null());
  EXPECT_NE(run({"info", kScene, "--sun", "60,40", "--sun-angle", "5"}).out.find("directional lights 5 degrees across"),
            std::string::npos);
  EXPECT_TRUE(Json::parse(run({"info", kScene, "--json"}).out)["lights"]["soft"].is_null());
  const std::string stats = folder_.file("stats.json");
  ASSERT_EQ(render(folder_.file("a.exr"), {"--stats", stats}).exit_code, 0);
  const Json extents = Json::parse(std::ifstream(stats))["soft_lamps"];
  EXPECT_NEAR(extents["sun_angle"].get<double>(), 5.0, 1e-5);
  EXPECT_NEAR(extents["lamp_radius"].get<double>(), 0.05, 1e-8);
}

} // namespace
} // namespace wavepath::test
