// Samples that are not finite: counted by the kernel that made them, the first one named, replayed bit by bit.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include <nlohmann/json.hpp>

#include "host/integrators/path/path_replay.h"
#include "host/render/loop/render_state.h"
#include "host/render/render.h"
#include "host/render/workspace/levels.h"
#include "host/scene/gltf/gltf.h"
#include "host/scene/staging/view.h"
#include "kernels/base/tile_order.h"
#include "tests/gltf_builder.h"
#include "tests/probe.h"
#include "tests/run_wavepath.h"
#include "tests/scene_builder.h"

namespace wavepath::test {
namespace {

using Json = nlohmann::json;

// Something to render, small enough to replay every path of it.
struct Shot {
  PackedScene packed;
  View view;
  RenderPlan settings;
};

// Tiles that are cut off are part of it.
Shot shoot(Scene scene, const ViewRequest& request = {}, std::uint32_t width = 9, std::uint32_t height = 10) {
  Shot shot;
  shot.settings.width = width;
  shot.settings.height = height;
  shot.settings.last_sample = 4;
  shot.settings.aovs = {"samples"};
  shot.view = resolve_view(scene, request, shot.settings.width, shot.settings.height);
  shot.packed = pack(scene);
  return shot;
}

// A wall of 2 x 2 units in the plane z = 0, lit by nothing.
Scene wall(float unit = 1.0f) {
  Scene scene;
  scene.path = "test";
  scene.materials.push_back(plain_material());
  const float a = -unit, b = unit;
  add_instance(scene, add_mesh(scene, {{a, a, 0}, {b, a, 0}, {b, b, 0}, {a, a, 0}, {b, b, 0}, {a, b, 0}}));
  return scene;
}

// A white wall that glows with 1.5e38 under a sky of 1.5e38 and beside a lamp that adds about as much: each is below
// the largest float, 3.4e38, the sum need not be. So both of the kernels that add to a path make some not finite, and
// some stay finite.
Shot glowing_wall(std::uint32_t width = 9, std::uint32_t height = 10) {
  Scene scene = wall();
  scene.materials[0].base_color = glm::vec4(1.0f);
  scene.materials[0].emission = glm::vec3(1.5e38f);
  scene.environment.radiance = glm::vec3(1.5e38f);
  PunctualLight& light = scene.lights.emplace_back();
  light.intensity = glm::vec3(3e38f);
  light.position = {0.0, 0.0, 0.5};
  return shoot(std::move(scene), {}, width, height);
}

// A light of 9e29 candela, a micrometre before a wall of that size: an irradiance of 9e41.
Shot wall_beside_a_bright_lamp() {
  Scene scene = wall(1e-6f);
  PunctualLight& light = scene.lights.emplace_back();
  light.intensity = glm::vec3(9e29f);
  light.position = {0.0, 0.0, 1e-6};
  return shoot(std::move(scene));
}

// An orthographic camera whose right border lies beyond the range of floats.
Shot view_beyond_all_floats() {
  Scene scene = wall();
  scene.environment.radiance = glm::vec3(1.0f);
  Shot shot = shoot(std::move(scene));
  shot.view.orthographic = true;
  shot.view.position = {2e38, 0.0, 3.0};
  shot.view.right = {2e38, 0.0, 0.0};
  shot.view.up = {0.0, 1.0, 0.0};
  shot.view.forward = {0.0, 0.0, -1.0};
  return shot;
}

class NonfiniteTest : public VulkanTest {
protected:
  // The render of a shot counts, leaves out and names just what its paths, one by one, say.
  Nonfinite expect_what_replays_say(const Shot& shot) {
    KernelCompiler kernels(device());
    const RenderResult result = render(device(), shot.packed, shot.view, shot.settings, {}, kernels);
    PathReplay replay(device(), shot.packed, shot.view, shot.settings, kernels);
    const auto& [width, height] = std::pair(shot.settings.width, shot.settings.height);
    const Channel& counts = result.picture.channels.back();
    EXPECT_EQ(counts.name, "samples");
    Nonfinite expected;
    for (std::uint32_t place = 0; place < width * height; ++place) {
      const glm::uvec2 pixel = gpu::pixel_in_tile_order(place, width, height);
      std::uint32_t finite = 0;
      for (std::uint32_t sample = 0; sample < shot.settings.last_sample; ++sample) {
        const PathTrace trace = replay.trace(pixel, sample);
        EXPECT_EQ(trace.maker.has_value(), trace.end == PathEnd::nonfinite);
        if (!trace.maker) {
          ++finite;
          continue;
        }
        ++expected.by_maker[*trace.maker];
        const NonfiniteSample found{sample, {place, 0}, *trace.maker};
        if (!expected.first || found < *expected.first) expected.first = found;
      }
      EXPECT_EQ(counts.values[pixel.y * width + pixel.x], static_cast<float>(finite)) << pixel.x << ", " << pixel.y;
    }
    EXPECT_EQ(result.nonfinite, expected);
    return expected;
  }
};

TEST_F(NonfiniteTest, SumsBeyondTheRangeAreShadesAndConnects) {
  const Nonfinite found = expect_what_replays_say(glowing_wall());
  EXPECT_GT(found.by_maker[gpu::kMakerShade], 0u);
  EXPECT_GT(found.by_maker[gpu::kMakerConnect], 0u);
  EXPECT_EQ(found.by_maker[gpu::kMakerGenerate], 0u);
  EXPECT_LT(found.samples(), 9u * 10u * 4u);
}

TEST_F(NonfiniteTest, LightBeyondTheRangeIsConnects) {
  const Nonfinite found = expect_what_replays_say(wall_beside_a_bright_lamp());
  EXPECT_GT(found.by_maker[gpu::kMakerConnect], 0u);
  EXPECT_EQ(found.samples(), found.by_maker[gpu::kMakerConnect]);
}

TEST_F(NonfiniteTest, RaysBeyondTheRangeAreGenerates) {
  const Nonfinite found = expect_what_replays_say(view_beyond_all_floats());
  EXPECT_GT(found.by_maker[gpu::kMakerGenerate], 0u);
  EXPECT_EQ(found.samples(), found.by_maker[gpu::kMakerGenerate]);
}

TEST_F(NonfiniteTest, NeitherWavesNorKernelsChangeWhatIsCounted) {
  Shot shot = glowing_wall();
  shot.settings.last_sample = 16;
  const Nonfinite whole = render(device(), shot.packed, shot.view, shot.settings).nonfinite;
  ASSERT_TRUE(whole.first);
  for (const std::uint32_t slots : {7u, 64u, 1000u}) {
    shot.settings.wave_slots = slots;
    for (const bool specialize : {true, false}) {
      shot.settings.specialize = specialize;
      EXPECT_EQ(render(device(), shot.packed, shot.view, shot.settings).nonfinite, whole) << slots;
    }
  }
}

// Slots of an adaptive render stand for places in its list, in which noisy runs come first.
TEST_F(NonfiniteTest, AnAdaptiveRenderNamesThePixelOfItsFirst) {
  Shot shot = glowing_wall(43, 37); // around the wall there are runs of nothing but the sky
  KernelCompiler kernels(device());
  const Nonfinite even = render(device(), shot.packed, shot.view, shot.settings, {}, kernels).nonfinite;
  ASSERT_TRUE(even.first);
  ASSERT_EQ(even.first->sample, 0u) << "a sample that every pixel of an adaptive render has";
  PathReplay replay(device(), shot.packed, shot.view, shot.settings, kernels);

  shot.settings.adaptive = kAdaptiveOn;
  std::vector<std::int8_t> levels;
  RenderHooks hooks;
  hooks.save = [&](const RenderState& state) { levels = state.levels; };
  const RenderResult result = render(device(), shot.packed, shot.view, shot.settings, hooks, kernels);
  const std::uint32_t run = even.first->at.pixel / kRunPixels;
  ASSERT_LT(run, levels.size());
  ASSERT_NE(std::ranges::count_if(levels, [&](std::int8_t level) { return level > levels[run]; }) +
                std::count(levels.begin(), levels.begin() + run, levels[run]),
            run)
      << "its place in the list is that in the picture: any answer would be right";

  ASSERT_TRUE(result.nonfinite.first);
  EXPECT_EQ(*result.nonfinite.first, *even.first);
  const glm::uvec2 pixel = gpu::pixel_in_tile_order(result.nonfinite.first->at.pixel, 43, 37);
  EXPECT_EQ(replay.trace(pixel, 0).maker, result.nonfinite.first->maker);
  double finite = 0.0, rendered = 0.0;
  for (const float count : result.picture.channels.back().values) finite += count;
  for (std::uint32_t place = 0; place < 43 * 37; ++place)
    rendered += at_level(shot.settings.last_sample, levels[place / kRunPixels]);
  EXPECT_EQ(static_cast<double>(result.nonfinite.samples()), rendered - finite) << "those of the pilot do not count";
}

// Nor where levels share waves, in which the lowest slot is of the noisiest run, not of the first sample.
TEST_F(NonfiniteTest, NorDoLevelsThatShareWaves) {
  for (std::uint32_t seed = 1; seed <= 12; ++seed) { // of most, a quieter run has the first
    Shot shot = glowing_wall(43, 37);
    shot.settings.seed = seed, shot.settings.last_sample = 16;
    const Nonfinite even = render(device(), shot.packed, shot.view, shot.settings).nonfinite;
    ASSERT_TRUE(even.first && even.first->sample == 0) << "a sample that every pixel of an adaptive render has";
    shot.settings.adaptive = kAdaptiveOn;
    for (const std::uint32_t slots : {0u, 500u}) {
      shot.settings.wave_slots = slots;
      EXPECT_EQ(render(device(), shot.packed, shot.view, shot.settings).nonfinite.first, even.first)
          << seed << " " << slots;
    }
  }
}

// The replay of a path has the bits of a picture that holds this path alone.
TEST_F(NonfiniteTest, ReplaysHaveTheBitsOfTheRender) {
  for (const char* name : {"cornell_box.gltf", "showcase.glb"})
    for (const std::uint32_t sampler : {gpu::kSamplerSobol, gpu::kSamplerStratified}) {
      Scene scene = load_gltf(std::filesystem::path(WAVEPATH_SOURCE_DIR) / "scenes" / name);
      Shot shot = shoot(std::move(scene));
      shot.settings.aovs.clear();
      shot.settings.width = shot.settings.height = 24;
      shot.settings.sample_total = 16;
      shot.settings.sampler = sampler;
      shot.settings.seed = 5;
      KernelCompiler kernels(device());
      PathReplay replay(device(), shot.packed, shot.view, shot.settings, kernels);
      std::size_t longest = 0;
      for (const std::uint32_t sample : {0u, 11u}) {
        shot.settings.first_sample = sample;
        shot.settings.last_sample = sample + 1;
        const Picture picture = render(device(), shot.packed, shot.view, shot.settings, {}, kernels).picture;
        for (std::uint32_t i = 0; i < 24; ++i) {
          const glm::uvec2 pixel(i, (7 * i + sample) % 24);
          const PathTrace trace = replay.trace(pixel, sample);
          for (int c = 0; c < 3; ++c)
            EXPECT_EQ(picture.channels[static_cast<std::size_t>(c)].values[pixel.y * 24 + pixel.x], trace.radiance[c])
                << name << " pixel " << pixel.x << ", " << pixel.y << " sample " << sample;
          longest = std::max(longest, trace.vertices.size());
        }
      }
      EXPECT_GT(longest, 3u);
    }
}

// The same from the command line, with a scene from a file.
class NonfiniteCliTest : public NonfiniteTest {
protected:
  static GltfBuilder white_triangle() {
    GltfBuilder builder = GltfBuilder::triangle();
    builder.primitive()["material"] = builder.add("materials", {{"pbrMetallicRoughness", {{"metallicFactor", 0.0}}}});
    return builder;
  }
  Outcome run(const std::vector<std::string>& extra) {
    std::vector<std::string> arguments = {WAVEPATH_BINARY, "render", scene_, "--size", "8x8", "--spp", "4"};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    return run_program(arguments);
  }

  TempFolder folder_;
  std::string scene_ = folder_.write("wall.gltf", white_triangle().json()).string();
  std::string exr_ = (folder_.path() / "a.exr").string(), stats_ = (folder_.path() / "a.json").string();
  // A light of 9e29 candela, a micrometre before a triangle of that size.
  static GltfBuilder triangle_beside_a_bright_lamp() {
    GltfBuilder builder = white_triangle();
    builder.root["nodes"][0]["scale"] = Json::array({1e-6, 1e-6, 1e-6});
    builder.root["nodes"].push_back(
        Json::parse(R"({"translation": [3e-7, 3e-7, 1e-6], "extensions": {"KHR_lights_punctual": {"light": 0}}})"));
    builder.root["extensions"] =
        Json::parse(R"({"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 9e29}]}})");
    builder.root["extensionsUsed"] = Json::array({"KHR_lights_punctual"});
    return builder;
  }
  const std::vector<std::string> bright_{"--env", "black", "--direct", "nee", "--seed", "6"};
};

TEST_F(NonfiniteCliTest, StrictNamesWhatReplaysIt) {
  scene_ = folder_.write("lamp.gltf", triangle_beside_a_bright_lamp().json()).string();
  std::vector<std::string> flags = bright_;
  flags.insert(flags.end(), {"-o", exr_, "--stats", stats_, "--strict"});
  const Outcome outcome = run(flags);
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  EXPECT_TRUE(std::filesystem::exists(exr_)); // all the same
  const Json stats = Json::parse(std::ifstream(stats_)), first = stats["nonfinite"]["first"];
  ASSERT_TRUE(first.is_object()) << stats["nonfinite"];
  std::uint64_t sum = 0;
  for (const char* kernel : {"generate", "shade", "connect"})
    sum += stats["nonfinite"]["by_kernel"][kernel].get<std::uint64_t>();
  EXPECT_EQ(stats["nonfinite"]["samples"], sum);
  EXPECT_EQ(first["seed"], 6);

  const std::string pixel = first["pixel"][0].dump() + "," + first["pixel"][1].dump(), sample = first["sample"].dump();
  const std::string how = "--pixel " + pixel + " --sample " + sample + " --seed 6";
  EXPECT_NE(outcome.err.find("wavepath: error: " + scene_), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("wavepath: warning: non-finite sample left out"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find(how), outcome.err.rfind(how)) << "in both: " << outcome.err;

  flags = bright_;
  flags.insert(flags.end(), {"--pixel", pixel, "--sample", sample, "--json"});
  const Outcome replayed = run(flags);
  ASSERT_EQ(replayed.exit_code, 0) << replayed.err;
  const Json trace = Json::parse(replayed.out);
  EXPECT_FALSE(trace["finite"].get<bool>());
  EXPECT_EQ(trace["kernel"], first["kernel"]);
  EXPECT_EQ(trace["end"], "nonfinite");
  EXPECT_TRUE(trace["radiance"][0].is_string()) << trace["radiance"]; // JSON has no number for it
  EXPECT_EQ(trace["bounces"].back()["radiance"], trace["radiance"]);
}

TEST_F(NonfiniteCliTest, ATraceIsTextOrJsonAndWritesNoFile) {
  const std::vector<std::string> flags = {"--pixel", "3,4", "--sample", "1", "-q", "-o", exr_, "--stats", stats_};
  const Outcome text = run(flags);
  ASSERT_EQ(text.exit_code, 0) << text.err;
  EXPECT_EQ(text.err, "");
  for (const char* word :
       {"pixel 3 4, sample 1, seed 0", "bounce 0", "hit ", "shadow ray", "throughput", "end ", ", finite"})
    EXPECT_NE(text.out.find(word), std::string::npos) << word << " in " << text.out;
  EXPECT_FALSE(std::filesystem::exists(exr_));
  EXPECT_FALSE(std::filesystem::exists(stats_));
}

TEST_F(NonfiniteCliTest, PathsThatTheRenderDoesNotHaveAreRefused) {
  const std::vector<std::vector<std::string>> wrong = {{"--pixel", "8,0", "--sample", "0"},
                                                       {"--pixel", "0,8", "--sample", "0"},
                                                       {"--pixel", "0,0", "--sample", "4"},
                                                       {"--adaptive", "--pixel", "0,0", "--sample", "32"},
                                                       {"--pixel", "0,0", "--sample", "0", "--samples", "1:3"},
                                                       {"--pixel", "0,0"},
                                                       {"--sample", "0"},
                                                       {"--pixel", "1", "--sample", "0"}};
  for (const auto& flags : wrong) {
    const Outcome outcome = run(flags);
    EXPECT_EQ(outcome.exit_code, 2) << Json(flags) << outcome.err;
    EXPECT_TRUE(outcome.err.find("--pixel") != std::string::npos || outcome.err.find("--sample") != std::string::npos);
    EXPECT_EQ(outcome.out, "");
  }
  const Outcome noisy = run({"--adaptive", "--pixel", "0,0", "--sample", "31"}); // of eight times four
  EXPECT_EQ(noisy.exit_code, 0) << noisy.err;
}

// A sample of an adaptive render is that of an even one.
TEST_F(NonfiniteCliTest, AnAdaptiveRenderHasTheSamePaths) {
  for (const char* sample : {"0", "3"}) {
    const Outcome even = run({"--pixel", "3,4", "--sample", sample, "--adaptive", "off"}),
                  adaptive = run({"--pixel", "3,4", "--sample", sample, "--adaptive", "on"});
    ASSERT_EQ(even.exit_code, 0) << even.err;
    EXPECT_NE(even.out.find("shadow ray"), std::string::npos) << even.out;
    EXPECT_EQ(adaptive.out, even.out);
  }
}

} // namespace
} // namespace wavepath::test
