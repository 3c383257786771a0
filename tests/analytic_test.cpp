// Renders scenes whose radiance has a closed form (extras.wavepath of the files in scenes/, see scenes/README.md) and
// judges them by a t-test; then what must hold for any scene: estimators agree, nothing depends on how the work is cut
// up.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "host/cli/render_flags.h"
#include "host/cli/scene_flags.h"
#include "host/film/film.h"
#include "host/render/render.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/scene/pack/pack.h"
#include "host/selftest/oracles.h"
#include "host/session/resolve.h"
#include "tests/probe.h"
#include "tests/shared_kernels.h"

namespace wavepath::test {
namespace {

namespace fs = std::filesystem;

const fs::path kScenes = fs::path(WAVEPATH_SOURCE_DIR) / "scenes";

// Student's t with the 64 degrees of freedom of an 8x8 picture: at this bound one of the 300 or so means that are
// tested would fail by chance once in a hundred choices of the seed.
constexpr double kLargestT = 4.4;
constexpr double kLargestNoise = 0.01; // standard error over expected value; more would accept wrong means
constexpr double kRounding = 2e-6;     // relative, of means of floats

struct Oracle {
  std::vector<std::string> render; // flags
  std::vector<double> expected;    // R G B
  double exact = 0.0;              // relative, every pixel; 0 = judge the mean by its noise
  double slack = 0.0;              // relative
  std::vector<std::string> estimators;
};

std::vector<fs::path> list_scenes(bool with_oracle) {
  std::vector<fs::path> paths;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(kScenes)) {
    if (entry.path().extension() != ".gltf") continue;
    const nlohmann::json scene = nlohmann::json::parse(std::ifstream(entry.path()));
    if (scene.contains("extras") == with_oracle) paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

Oracle read_oracle(const fs::path& path) {
  const nlohmann::json json = nlohmann::json::parse(std::ifstream(path)).at("extras").at("wavepath");
  return {json.at("render"), json.at("expected"), json.value("exact", 0.0), json.value("slack", 0.0),
          json.value("estimators", std::vector<std::string>{"mis", "nee", "bsdf"})};
}

// Renders as `wavepath render PATH FLAGS...` would; later flags count.
RenderResult render_scene(Device& device, const fs::path& path, std::vector<std::string> flags,
                          std::uint32_t wave_slots = 0) {
  CLI::App app;
  SceneRequest scene_request;
  RenderRequest request;
  add_scene_flags(app, scene_request, true);
  add_stop_flags(app, request);
  add_transport_flags(app, kByRender, request);
  add_picture_flags(app, kByRender, request);
  flags.insert(flags.begin(), path.string());
  std::reverse(flags.begin(), flags.end()); // as CLI11 wants it
  app.parse(flags);
  resolve_samples(request);
  request.settings.wave_slots = wave_slots;

  Scene scene = load_scene(scene_request).scene;
  const View view = resolve_view(scene, {}, request.settings.width, request.settings.height);
  const PackedScene packed =
      pack(scene, {.direct = request.settings.direct, .quality = request.bvh.value_or(bvh::Quality::fast)});
  KernelCompiler& kernels = shared_kernels(device);
  const RenderResult result = render(device, packed, view, request.settings, RenderHooks{}, kernels);
  EXPECT_EQ(result.nonfinite.samples(), 0u);
  return result;
}

std::vector<std::string> operator+(std::vector<std::string> flags, const std::vector<std::string>& more) {
  flags.insert(flags.end(), more.begin(), more.end());
  return flags;
}

std::vector<std::string> direct(const std::string& estimator) { return {"--direct", estimator}; }

struct Mean {
  double value = 0.0, standard_error = 0.0;
};

// The mean of two renders that differ in nothing but the seed. Their difference, pixel by pixel, tells the noise,
// whatever the pixels' own values are.
Mean mean_of(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum += double(a[i]) + double(b[i]);
    squares += (double(a[i]) - double(b[i])) * (double(a[i]) - double(b[i]));
  }
  const double n = double(a.size());
  return {sum / (2.0 * n), std::sqrt(squares) / (2.0 * n)};
}

std::string name_of(const ::testing::TestParamInfo<fs::path>& info) { return info.param.stem().string(); }

class Analytic : public VulkanTest, public ::testing::WithParamInterface<fs::path> {};
class AnalyticHybrid : public Analytic {};    // of all that light does in one bounce
class AnalyticOcclusion : public Analytic {}; // of white surfaces under a white sky

// The scenes with an oracle whose longest path has one bounce at most.
std::vector<fs::path> list_direct_scenes() {
  std::vector<fs::path> paths = list_scenes(true);
  std::erase_if(paths, [](const fs::path& path) {
    const std::vector<std::string> flags = read_oracle(path).render;
    return std::stoi(*(std::ranges::find(flags, "--max-depth") + 1)) > 1;
  });
  return paths;
}

std::vector<fs::path> list_occlusion_scenes() {
  std::vector<fs::path> paths = list_scenes(true);
  std::erase_if(paths, [](const fs::path& path) { return !path.stem().string().starts_with("occlusion_"); });
  return paths;
}

void expect_every_pixel(const Picture& picture, const Oracle& oracle) {
  for (std::size_t c = 0; c < 3; ++c) {
    const double expected = oracle.expected[c];
    const double tolerance = oracle.exact * (expected > 0.0 ? expected : 1.0);
    for (const float value : picture.channels[c].values) ASSERT_NEAR(value, expected, tolerance);
  }
}

// `written`: how exactly the expected values are written down.
void expect_mean(const Picture& a, const Picture& b, const Oracle& oracle, double written = 0.0,
                 double largest_noise = kLargestNoise) {
  for (std::size_t c = 0; c < 3; ++c) {
    const Mean mean = mean_of(a.channels[c].values, b.channels[c].values);
    const double expected = oracle.expected[c];
    EXPECT_NEAR(mean.value, expected, kLargestT * mean.standard_error + written + (oracle.slack + kRounding) * expected)
        << "channel " << c << ", standard error " << mean.standard_error;
    EXPECT_LT(mean.standard_error, largest_noise * expected) << "channel " << c;
  }
}

TEST_P(Analytic, EveryEstimatorFindsIt) {
  const Oracle oracle = read_oracle(GetParam());
  for (const std::string& estimator : oracle.estimators) {
    SCOPED_TRACE("--direct " + estimator);
    const std::vector<std::string> flags = oracle.render + direct(estimator);
    const Picture first = render_scene(device(), GetParam(), flags + std::vector<std::string>{"--seed", "1"}).picture;
    if (oracle.exact > 0.0) {
      expect_every_pixel(first, oracle);
      continue;
    }
    const Picture second = render_scene(device(), GetParam(), flags + std::vector<std::string>{"--seed", "2"}).picture;
    expect_mean(first, second, oracle);
  }
}

// One render is enough: the film knows its noise.
void expect_mean(const RenderResult& result, const Oracle& oracle) {
  for (int c = 0; c < 3; ++c) {
    const std::vector<float>& values = result.picture.channels[static_cast<std::size_t>(c)].values;
    double sum = 0.0, variance = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      sum += values[i];
      variance += mean_variance(*result.film, i)[c];
    }
    const double n = double(values.size()), mean = sum / n, standard_error = std::sqrt(variance) / n;
    const double expected = oracle.expected[static_cast<std::size_t>(c)];
    EXPECT_NEAR(mean, expected, kLargestT * standard_error + (oracle.slack + kRounding) * expected) << "channel " << c;
    EXPECT_LT(standard_error, kLargestNoise * expected) << "channel " << c;
  }
}

// As many samples in a larger picture: a frame costs the same for 64 pixels as for 1024.
std::vector<std::string> in_fewer_frames(const std::vector<std::string>& flags) {
  const int spp = std::stoi(*(std::ranges::find(flags, "--spp") + 1));
  return flags + std::vector<std::string>{"--size", "32x32", "--spp", std::to_string(std::max(spp / 16, 2))};
}

TEST_P(AnalyticHybrid, FindsIt) {
  Oracle oracle = read_oracle(GetParam());
  oracle.render = in_fewer_frames(oracle.render);
  const RenderResult result =
      render_scene(device(), GetParam(),
                   oracle.render + std::vector<std::string>{"--integrator", "hybrid", "--shadow-samples", "2"});
  if (oracle.exact > 0.0) return expect_every_pixel(result.picture, oracle);
  expect_mean(result, oracle);
}

TEST_P(AnalyticOcclusion, FindsIt) {
  const Oracle oracle = read_oracle(GetParam());
  expect_mean(render_scene(device(), GetParam(), oracle.render + std::vector<std::string>{"--integrator", "ao"}),
              oracle);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Analytic, ::testing::ValuesIn(list_scenes(true)), name_of);
INSTANTIATE_TEST_SUITE_P(Scenes, AnalyticHybrid, ::testing::ValuesIn(list_direct_scenes()), name_of);
INSTANTIATE_TEST_SUITE_P(Scenes, AnalyticOcclusion, ::testing::ValuesIn(list_occlusion_scenes()), name_of);

// Whitted's ray tracer finds light that one rough surface has scattered, and mirrors and glass however deep.
class AnalyticWhitted : public Analytic {};

TEST_P(AnalyticWhitted, FindsIt) {
  Oracle oracle = read_oracle(GetParam());
  // Rays that split at every face leave hardly any noise, and cost much.
  if (GetParam().stem().string().ends_with("slab"))
    oracle.render = oracle.render + std::vector<std::string>{"--spp", "32"};
  constexpr double kWritten = 5e-8; // half a unit of the last decimal of the expected values, which the noise is below
  const std::vector<std::string> flags =
      oracle.render + std::vector<std::string>{"--integrator", "whitted", "--cutoff", "0"};
  const Picture first = render_scene(device(), GetParam(), flags + std::vector<std::string>{"--seed", "1"}).picture;
  if (oracle.exact > 0.0) return expect_every_pixel(first, oracle);
  expect_mean(first, render_scene(device(), GetParam(), flags + std::vector<std::string>{"--seed", "2"}).picture,
              oracle, kWritten);
}

// Not those whose light is too noisy when sampled by area, for which the scene itself names other estimators.
std::vector<fs::path> scenes_for_whitted() {
  std::vector<fs::path> paths;
  for (const char* name : {"absorbing_glass_slab",
                           "absorbing_slab",
                           "glass_slab",
                           "mirror",
                           "facing_squares",
                           "alpha_blend",
                           "alpha_mask_cut",
                           "alpha_mask_kept",
                           "directional_light",
                           "point_light",
                           "spot_light",
                           "floor_in_fog",
                           "disc_light",
                           "half_hidden_disc_light",
                           "rectangle_light_centre",
                           "rectangle_light_corner",
                           "sphere_light",
                           "tilted_sphere_light",
                           "emitter",
                           "unlit"})
    paths.push_back(kScenes / "analytic" / (std::string(name) + ".gltf"));
  return paths;
}

INSTANTIATE_TEST_SUITE_P(Scenes, AnalyticWhitted, ::testing::ValuesIn(scenes_for_whitted()), name_of);

// Paths that neighbouring pixels share, and those that a trained field guides, find all light that bounces. Where it
// comes from all directions alike, as in closed rooms, none are guided.
class AnalyticIndirect : public Analytic {
protected:
  RenderResult expect_found(std::vector<std::string> flags) {
    const Oracle oracle = read_oracle(GetParam());
    flags = oracle.render + flags;
    RenderResult first = render_scene(device(), GetParam(), flags + std::vector<std::string>{"--seed", "1"});
    const RenderResult second = render_scene(device(), GetParam(), flags + std::vector<std::string>{"--seed", "2"});
    expect_mean(first.picture, second.picture, oracle);
    return first;
  }
};
class AnalyticGuided : public AnalyticIndirect {};
class AnalyticShared : public AnalyticIndirect {};

TEST_P(AnalyticGuided, FindsIt) { EXPECT_TRUE(expect_found({"--guide"}).guide.value().used); }

TEST_P(AnalyticShared, FindsIt) { EXPECT_TRUE(expect_found({"--reuse", "on"}).film->quads); }

INSTANTIATE_TEST_SUITE_P(Scenes, AnalyticGuided, ::testing::Values(kScenes / "analytic/lit_ceiling.gltf"), name_of);
INSTANTIATE_TEST_SUITE_P(Scenes, AnalyticShared,
                         ::testing::Values(kScenes / "analytic/lit_ceiling.gltf",
                                           kScenes / "analytic/point_light_in_sphere.gltf",
                                           kScenes / "analytic/truncated_enclosure.gltf"),
                         name_of);

// Bidirectional path tracing finds all of it, but for the sun in fog: its shadow rays stop at walls, and it refuses
// what scatters.
std::vector<fs::path> scenes_for_light_paths() {
  std::vector<fs::path> paths = list_scenes(true);
  std::erase_if(paths, [](const fs::path& path) { return path.stem().string().ends_with("_in_fog"); });
  return paths;
}

class AnalyticBidirectional : public Analytic {};

TEST_P(AnalyticBidirectional, FindsIt) {
  const Oracle oracle = read_oracle(GetParam());
  const std::vector<std::string> flags = oracle.render + std::vector<std::string>{"--integrator", "bidirectional"};
  const Picture first = render_scene(device(), GetParam(), flags + std::vector<std::string>{"--seed", "1"}).picture;
  if (oracle.expected[0] == 0.0) return expect_every_pixel(first, oracle);
  expect_mean(first, render_scene(device(), GetParam(), flags + std::vector<std::string>{"--seed", "2"}).picture,
              oracle);
}

INSTANTIATE_TEST_SUITE_P(Scenes, AnalyticBidirectional, ::testing::ValuesIn(scenes_for_light_paths()), name_of);

// Light of lamps and suns through glass, water and off mirrors, which paths from the camera cannot find: where it falls
// on a diffuse floor that the camera sees, through glass or in a mirror as well (scenes/caustics/README.md).
class Caustic : public VulkanTest, public ::testing::WithParamInterface<std::string> {};

std::vector<std::string> list_caustics(const std::vector<std::string>& seen) {
  std::vector<std::string> names;
  const nlohmann::json answers = nlohmann::json::parse(std::ifstream(kScenes / "caustics/expected.json"));
  for (const auto& [name, answer] : answers.items())
    if (std::ranges::find(seen, answer.at("seen").get<std::string>()) != seen.end()) names.push_back(name);
  return names;
}

Oracle oracle_of(const std::string& caustic) {
  const nlohmann::json answer = nlohmann::json::parse(std::ifstream(kScenes / "caustics/expected.json")).at(caustic);
  return {answer.at("render"), answer.at("expected"), 0.0, answer.value("slack", 0.0), {}};
}

TEST_P(Caustic, LightPathsFindIt) {
  const Oracle oracle = oracle_of(GetParam());
  const fs::path path = kScenes / "caustics" / (GetParam() + ".glb");
  std::vector<std::string> flags = oracle.render + std::vector<std::string>{"--integrator", "bidirectional"};
  if (GetParam() == "prism_beam")
    flags = flags + std::vector<std::string>{"--spp", "32768"}; // of its lamp, least lands
  if (GetParam() == "bulb_in_sphere") flags = flags + std::vector<std::string>{"--spp", "1024"}; // paths of 128 bounces
  const auto render = [&](const std::string& seed) {
    return render_scene(device(), path, flags + std::vector<std::string>{"--seed", seed}).picture;
  };
  constexpr double kFewLand = 0.02; // of the sun's paths, few land in the picture
  expect_mean(render("1"), render("2"), oracle, 0.0, kFewLand);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Caustic, ::testing::ValuesIn(list_caustics({"straight", "diffuse", "specular"})),
                         [](const ::testing::TestParamInfo<std::string>& caustic) { return caustic.param; });

// What panes let through unbent is found by shadow rays, too.
class StraightCaustic : public VulkanTest, public ::testing::WithParamInterface<std::string> {};

TEST_P(StraightCaustic, ShadowRaysFindIt) {
  const Oracle oracle = oracle_of(GetParam());
  const fs::path path = kScenes / "caustics" / (GetParam() + ".glb");
  for (const char* integrator : {"path", "whitted"}) {
    const auto flags = oracle.render + std::vector<std::string>{"--integrator", integrator, "--spp", "256"};
    const auto render = [&](const std::string& seed) {
      return render_scene(device(), path, flags + std::vector<std::string>{"--seed", seed}).picture;
    };
    expect_mean(render("1"), render("2"), oracle);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, StraightCaustic, ::testing::ValuesIn(list_caustics({"straight"})),
                         [](const ::testing::TestParamInfo<std::string>& caustic) { return caustic.param; });

class AnyScene : public VulkanTest {
protected:
  void expect_same_bits(const RenderResult& a, const RenderResult& b) {
    ASSERT_EQ(a.picture.channels.size(), b.picture.channels.size());
    for (std::size_t c = 0; c < a.picture.channels.size(); ++c)
      EXPECT_EQ(a.picture.channels[c].values, b.picture.channels[c].values) << a.picture.channels[c].name;
  }
  const std::vector<std::string> small_{"--size",      "24x16", "--spp", "8",
                                        "--max-depth", "6",     "--aov", "albedo,normal,depth"};
  // Between them they use every feature that this folder has.
  const std::vector<fs::path> scenes_{kScenes / "cornell_box.gltf",
                                      kScenes / "furnace_glass.gltf",
                                      kScenes / "analytic/lights_of_all_sizes.gltf",
                                      kScenes / "analytic/alpha_blend.gltf",
                                      kScenes / "showcase.glb",
                                      kScenes / "rooms/glazed_room.glb"};
};

TEST_F(AnyScene, TwoRunsGiveTheSameBits) {
  for (const fs::path& path : scenes_) {
    SCOPED_TRACE(path.stem());
    expect_same_bits(render_scene(device(), path, small_), render_scene(device(), path, small_));
  }
}

TEST_F(AnyScene, GenericKernelsGiveTheSameBits) {
  for (const fs::path& path : scenes_) {
    SCOPED_TRACE(path.stem());
    expect_same_bits(render_scene(device(), path, small_),
                     render_scene(device(), path, small_ + std::vector<std::string>{"--specialize", "off"}));
  }
}

TEST_F(AnyScene, HowTheWorkIsCutUpDoesNotMatter) {
  for (const fs::path& path : scenes_) {
    SCOPED_TRACE(path.stem());
    const RenderResult whole = render_scene(device(), path, small_);
    for (const std::uint32_t slots : {64u, 1000u, 24u * 16u * 3u})
      expect_same_bits(whole, render_scene(device(), path, small_, slots));
  }
}

TEST_F(AnyScene, TheTreeDoesNotMatter) {
  Scene showcase = load_gltf((kScenes / "showcase.glb").string(), {});
  const PackedScene best = pack(showcase, {.quality = bvh::Quality::best});
  EXPECT_GT(best.triangles.size(), best.triangles_stored) << "no triangle was split, so copies were not checked";
  for (const fs::path& path : scenes_) {
    SCOPED_TRACE(path.stem());
    const RenderResult plain = render_scene(device(), path, small_ + std::vector<std::string>{"--bvh", "fast"});
    for (const char* quality : {"balanced", "best"})
      expect_same_bits(plain, render_scene(device(), path, small_ + std::vector<std::string>{"--bvh", quality}));
  }
}

TEST_F(AnyScene, EstimatorsAndSamplersAgreeOnTheCornellBox) {
  const std::vector<std::string> flags{"--size", "16x16", "--spp", "64", "--max-depth", "4"};
  const std::vector<std::vector<std::string>> variants{direct("mis"),
                                                       direct("nee"),
                                                       direct("bsdf"),
                                                       {"--sampler", "independent"},
                                                       {"--sampler", "stratified"},
                                                       {"--hemisphere", "uniform"}};
  std::vector<Picture> first, second;
  for (const std::vector<std::string>& variant : variants) {
    first.push_back(
        render_scene(device(), kScenes / "cornell_box.gltf", flags + variant + std::vector<std::string>{"--seed", "1"})
            .picture);
    second.push_back(
        render_scene(device(), kScenes / "cornell_box.gltf", flags + variant + std::vector<std::string>{"--seed", "2"})
            .picture);
  }
  for (std::size_t i = 1; i < variants.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const Mean mis = mean_of(first[0].channels[c].values, second[0].channels[c].values);
      const Mean other = mean_of(first[i].channels[c].values, second[i].channels[c].values);
      EXPECT_NEAR(mis.value, other.value, kLargestT * std::hypot(mis.standard_error, other.standard_error))
          << variants[i][1] << ", channel " << c;
    }
  }
}

// Five metal balls that absorb nothing, under a white sky, from smooth to as rough as can be: they cannot be seen, but
// for what paths beyond the eighth bounce would bring.
TEST_F(AnyScene, RoughMetalBallsReturnAllLight) {
  constexpr int kWidth = 480, kHeight = 120;
  const Picture picture =
      render_scene(device(), kScenes / "furnace_metal.gltf",
                   {"--size", "480x120", "--spp", "128", "--env", "1,1,1", "--direct", "bsdf", "--filter", "box"})
          .picture;
  const double radius = 0.4, pixel = 2.0 * std::tan(0.4) / kHeight;
  for (int ball = 0; ball < 5; ++ball) {
    const glm::dvec3 center(0.9 * ball - 1.8, 0.0, -6.0); // seen from the camera
    double found = 0.0, count = 0.0;
    for (int i = 0; i < kWidth * kHeight; ++i) {
      const double x = (i % kWidth + 0.5 - kWidth / 2) * pixel, y = (kHeight / 2 - i / kWidth - 0.5) * pixel;
      const double sine = glm::length(glm::cross(glm::normalize(glm::dvec3(x, y, -1.0)), center)) / radius;
      if (sine > 0.9) continue; // no silhouettes
      found += picture.channels[0].values[static_cast<std::size_t>(i)];
      ++count;
    }
    EXPECT_NEAR(found / count, 1.0, 0.01) << "ball " << ball;
  }
}

} // namespace
} // namespace wavepath::test
