// `wavepath render` from the command line, on the device that there is.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include <dlfcn.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/gpu/device.h"
#include "host/picture/files/picture_io.h"
#include "host/picture/tonemap.h"
#include "tests/fake_tev.h"
#include "tests/plan_in_stats.h"
#include "tests/run_wavepath.h"
#include "tests/small_disk.h"
#include "tests/temporary_folder.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {
namespace {

std::string scene_file(const std::string& name) { return std::string(WAVEPATH_SOURCE_DIR "/scenes/") + name; }

Outcome run_wavepath(std::vector<std::string> arguments, const RunOptions& options = {}) {
  arguments.insert(arguments.begin(), WAVEPATH_BINARY);
  return run_program(std::move(arguments), options);
}

using Json = nlohmann::json;

class CliRenderTest : public ProgramTest {
protected:
  // Renders the Cornell box at 48x32 with `extra` flags.
  Outcome render(const std::vector<std::string>& extra, const RunOptions& options = {}) {
    std::vector<std::string> arguments = {"render", scene_file("cornell_box.gltf"), "--size", "48x32"};
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    return run_wavepath(arguments, options);
  }
  std::size_t file_count() const {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(folder_.path()), std::filesystem::directory_iterator()));
  }

  TemporaryFolder folder_;
  std::string exr_ = folder_.file("a.exr"), stats_ = folder_.file("a.json");
};

TEST_F(CliRenderTest, WritesEveryOutput) {
  const std::string hdr = folder_.file("a.hdr"), png = folder_.file("a.png"), jpg = folder_.file("a.jpg");
  const Outcome outcome = render({"-o", exr_, "-o", hdr, "-o", png, "-o", jpg, "--spp", "4"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  for (const std::string& path : {exr_, hdr, png, jpg}) EXPECT_EQ(read_picture(path).width, 48u) << path;
  EXPECT_EQ(read_attribute(exr_, "wavepath.samples"), "0:4");
  EXPECT_EQ(file_count(), 4u);
}

double total(const Picture& picture, const std::string& prefix) {
  double sum = 0.0;
  for (const char* channel : {"R", "G", "B"})
    for (const float value : find_channel(picture, prefix + channel)->values) sum += value;
  return sum;
}

// The rendered picture stays what it is without the filter; the filtered one is beside it, and is what a PNG shows.
TEST_F(CliRenderTest, TheDenoisedPictureIsALayer) {
  const std::string plain = folder_.file("plain.exr"), png = folder_.file("a.png"), hdr = folder_.file("a.hdr");
  ASSERT_EQ(render({"-o", plain, "--spp", "8", "-q"}).exit_code, 0);
  for (const char* integrator : {"path", "bidirectional", "whitted"}) {
    SCOPED_TRACE(integrator);
    const Outcome outcome = render({"--denoise", "-o", exr_, "-o", png, "-o", hdr, "--spp", "8", "--stats", stats_,
                                    "--integrator", integrator, "--reference", plain});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const Picture picture = read_picture(exr_);
    EXPECT_EQ(picture.channels.size(), 7u); // R G B A, and the layer
    EXPECT_NEAR(total(picture, "denoised.") / total(picture, ""), 1.0, 0.01);
    EXPECT_NE(find_channel(picture, "denoised.R")->values, find_channel(picture, "R")->values);
    for (std::size_t c = 0; c < (integrator == std::string("path") ? 3 : 0); ++c) {
      EXPECT_EQ(picture.channels[c].values, read_picture(plain).channels[c].values) << c;
    }
    const Picture shown = read_picture(hdr);
    for (std::size_t i = 0; i < shown.channels[1].values.size(); ++i)
      EXPECT_NEAR(shown.channels[1].values[i], find_channel(picture, "denoised.G")->values[i],
                  0.01 + 0.01 * shown.channels[1].values[i]);
    const Json json = Json::parse(std::ifstream(stats_));
    EXPECT_EQ(json["denoise"]["filter"], "own");
    EXPECT_NEAR(json["denoise"]["light_ratio"].get<double>(), 1.0, 0.01);
    EXPECT_GT(json["denoise"]["relmse"].get<double>(), 0.0);
    EXPECT_NE(json["bias"].dump().find("--denoise"), std::string::npos);
    EXPECT_NE(read_attribute(exr_, "wavepath.bias").find("--denoise"), std::string::npos);
  }
  EXPECT_EQ(read_picture(png).width, 48u);
}

TEST_F(CliRenderTest, DenoisingLowersTheError) {
  const std::string reference = folder_.file("reference.exr");
  ASSERT_EQ(render({"-o", reference, "--spp", "1024", "--seed", "7", "-q"}).exit_code, 0);
  ASSERT_EQ(
      render({"--denoise", "-o", exr_, "--spp", "4", "-q", "--stats", stats_, "--reference", reference}).exit_code, 0);
  const Json json = Json::parse(std::ifstream(stats_));
  const Json &noisy = json["checkpoints"].back(), &clean = json["denoise"];
  EXPECT_LT(clean["relmse"].get<double>(), 0.85 * noisy["relmse"].get<double>()); // the rest: borders of the lamp
  EXPECT_LT(clean["flip"].get<double>(), 0.85 * noisy["flip"].get<double>());
}

// A word behind the flag that is no value of it is the next argument.
TEST_F(CliRenderTest, TheFlagOfTheFilterNeedsNoValue) {
  const Outcome outcome = run_wavepath(
      {"render", "--denoise", scene_file("cornell_box.gltf"), "--size", "16x16", "--spp", "2", "-o", exr_, "-q"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(find_channel(read_picture(exr_), "denoised.R"));
}

// Renders look for noise by themselves, in the scene's own integrator; parts, even and very short ones do not.
TEST_F(CliRenderTest, RendersLookForNoise) {
  const auto pilot_of = [&](std::vector<std::string> flags) {
    flags.insert(flags.end(), {"-o", exr_, "--size", "256x128", "--max-depth", "1", "-q", "--stats", stats_});
    const Outcome outcome = render(flags);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const Json stats = Json::parse(std::ifstream(stats_));
    EXPECT_EQ(stats["integrator"], "path");
    return decision_in(stats, "adaptive");
  };
  const Json pilot = pilot_of({"--spp", "64"});
  EXPECT_EQ(pilot["taken"], "on") << pilot; // the box's surroundings are black
  EXPECT_LT(pilot["cost"].get<double>(), 0.9);
  EXPECT_EQ(pilot["pilot"], Json({{"size", {64, 32}}, {"spp", 32}}));
  EXPECT_EQ(pilot_of({"--spp", "32"})["pilot"]["spp"], 16);
  EXPECT_TRUE(pilot_of({"--spp", "28"})["pilot"].is_null()) << "less than a second is foreseen";
  EXPECT_TRUE(pilot_of({"--spp", "64", "--adaptive", "off"})["pilot"].is_null());
  EXPECT_TRUE(pilot_of({"--spp", "64", "--samples", "0:64"})["pilot"].is_null()) << "parts are even";
  EXPECT_TRUE(pilot_of({"--spp", "64", "--mergeable"})["pilot"].is_null()) << "parts are even";
  EXPECT_TRUE(pilot_of({"--spp", "8", "--adaptive"})["pilot"].is_object());
}

// A scene with a sun counts as lit: it gets no other light.
TEST_F(CliRenderTest, ASunIsPutIn) {
  const std::vector<std::string> common = {
      "render", scene_file("furnace_lambert.gltf"), "--size", "8x8", "--spp", "4", "-o", exr_, "--json"};
  std::vector<std::string> lit = common, odd = common;
  lit.insert(lit.end(), {"--sun", "60,40"});
  odd.insert(odd.end(), {"--sun", "60"});
  const Outcome outcome = run_wavepath(lit);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("a sun (--sun 60,40)"), std::string::npos) << outcome.err;
  EXPECT_EQ(Json::parse(outcome.out)["lights"], 1);
  EXPECT_EQ(run_wavepath(odd).exit_code, 2);
}

// Intel's library, or what stands for it in tests: a filter that turns light into albedo plus normal.
TEST_F(CliRenderTest, OpenImageDenoiseIsOpenedAtRunTime) {
  RunOptions options;
  options.in_child = [] { setenv("LD_LIBRARY_PATH", WAVEPATH_OIDN_FOLDER, 1); };
  const Outcome outcome = render(
      {"--denoise", "oidn", "--aov", "albedo,normal", "-o", exr_, "--spp", "2", "-q", "--stats", stats_}, options);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Picture picture = read_picture(exr_);
  const auto value = [&](const char* name, std::size_t i) { return find_channel(picture, name)->values[i]; };
  for (std::size_t i = 0; i < 48 * 32; ++i)
    EXPECT_EQ(value("denoised.G", i), value("albedo.G", i) + value("N.Y", i) + value("G", i)) << i;
  EXPECT_EQ(Json::parse(std::ifstream(stats_))["denoise"]["filter"], "oidn");
  options.in_child = [] {
    setenv("LD_LIBRARY_PATH", WAVEPATH_OIDN_FOLDER, 1);
    setenv("OIDN_STUB_FAILS", "1", 1);
  };
  const Outcome failure = render({"--denoise", "oidn", "-o", exr_, "--spp", "2", "-q"}, options);
  EXPECT_EQ(failure.exit_code, 1);
  EXPECT_NE(failure.err.find("Open Image Denoise failed (as the test wants it)"), std::string::npos) << failure.err;
}

TEST_F(CliRenderTest, WithoutOpenImageDenoiseAnErrorSaysWhatToDo) {
  for (const char* name : {"libOpenImageDenoise.so.2", "libOpenImageDenoise.so.1", "libOpenImageDenoise.so"})
    if (dlopen(name, RTLD_LAZY)) GTEST_SKIP() << "it is installed here";
  const Outcome outcome = render({"--denoise", "oidn", "-o", exr_, "-q"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("--denoise oidn: Open Image Denoise is not installed"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("or use --denoise alone"), std::string::npos) << outcome.err;
  EXPECT_EQ(file_count(), 0u);
}

TEST_F(CliRenderTest, TheDefaultOutputIsNamedAfterTheScene) {
  RunOptions options;
  options.folder = folder_.path().string();
  ASSERT_EQ(render({"--spp", "1", "-q"}, options).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder_.file("cornell_box.exr")));
}

TEST_F(CliRenderTest, QuietIsSilentAndJsonIsAllThatStdoutCarries) {
  const Outcome outcome = render({"-o", exr_, "--spp", "2", "-q", "--json"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.err, "");
  EXPECT_EQ(Json::parse(outcome.out)["spp"], 2);
}

TEST_F(CliRenderTest, StatsNameTheBiasOfEveryIntegrator) {
  const auto bias = [&](const std::vector<std::string>& flags) {
    std::vector<std::string> all = {"-o", exr_, "--spp", "2", "-q", "--json"};
    all.insert(all.end(), flags.begin(), flags.end());
    const Outcome outcome = render(all);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return Json::parse(outcome.out)["bias"].dump();
  };
  EXPECT_NE(bias({}).find("of the light is missing"), std::string::npos);
  EXPECT_EQ(bias({"--integrator", "ao"}), "[]");
  EXPECT_EQ(bias({"--integrator", "hybrid", "--max-depth", "0"}),
            R"x(["light paths end after 0 bounces (--max-depth)"])x");
  const std::string hybrid = bias({"--integrator", "hybrid", "--ambient", "1,2,3"});
  EXPECT_NE(hybrid.find("ambient term of radiance 1,2,3"), std::string::npos) << hybrid;
  EXPECT_EQ(hybrid.find("missing"), std::string::npos) << hybrid;
}

// The two meshes of a bulb of glass lie in each other: integrators that do not count bodies say that they see each
// surface by itself.
TEST_F(CliRenderTest, BiasTellsWhoSeesOverlappingBodiesSurfaceBySurface) {
  const auto tells = [&](const std::string& scene, const std::string& integrator) {
    const Outcome outcome = run_wavepath({"render", scene_file(scene), "--size", "8x8", "--spp", "1", "--max-depth",
                                          "2", "--integrator", integrator, "-o", exr_, "-q", "--json"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return Json::parse(outcome.out)["bias"].dump().find("bodies whose boxes meet") != std::string::npos;
  };
  for (const std::string integrator : {"whitted", "hybrid"})
    EXPECT_TRUE(tells("caustics/bulb_in_sphere.glb", integrator)) << integrator;
  for (const std::string integrator : {"path", "bidirectional", "ao"})
    EXPECT_FALSE(tells("caustics/bulb_in_sphere.glb", integrator)) << integrator;
  EXPECT_FALSE(tells("caustics/bulb_point.glb", "whitted")) << "one mesh";
}

// Nearly all light of a lamp in thick glass is lost to paths from the camera, and none of one above thin panes, which
// shadow rays pass.
TEST_F(CliRenderTest, BiasTellsHowMuchLightIsLost) {
  const auto lost = [&](const std::string& scene) { // per cent, and the error of that
    const Outcome outcome = run_wavepath({"render", scene_file(scene), "--size", "64x64", "--spp", "1", "--max-depth",
                                          "4", "--integrator", "path", "-o", exr_, "-q", "--json"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const std::string bias = Json::parse(outcome.out)["bias"].dump();
    const std::size_t at = std::min(bias.find("off mirrors"), bias.size());
    double fraction = -1.0, error = -1.0;
    EXPECT_EQ(std::sscanf(bias.c_str() + at, "off mirrors is missing: %lf %% +- %lf %%", &fraction, &error), 2) << bias;
    return std::pair{fraction, error};
  };
  const auto [of_bulb, bulb_error] = lost("caustics/bulb_point.glb");
  EXPECT_GT(of_bulb, 90.0);
  EXPECT_LT(bulb_error, 5.0);
  const auto [of_panes, panes_error] = lost("caustics/panes.glb");
  EXPECT_LT(of_panes, 3.0 * panes_error);
  EXPECT_LT(panes_error, 10.0);
}

TEST_F(CliRenderTest, StatsHaveTheDocumentedKeys) {
  ASSERT_EQ(render({"-o", exr_, "--spp", "4", "--stats", stats_, "--seed", "3"}).exit_code, 0);
  const Json stats = Json::parse(std::ifstream(stats_));
  for (const char* key : {"wavepath", "scene", "command", "sampler", "integrator"})
    EXPECT_TRUE(stats[key].is_string()) << key;
  for (const char* key : {"seed", "max_depth", "spp", "triangles", "lights"})
    EXPECT_TRUE(stats[key].is_number_unsigned()) << key;
  for (const char* key : {"name", "driver", "type", "api"}) EXPECT_TRUE(stats["device"][key].is_string()) << key;
  EXPECT_EQ(stats["size"], Json({48, 32}));
  EXPECT_EQ(stats["seed"], 3);
  EXPECT_EQ(stats["sampler"], "sobol");
  EXPECT_EQ(stats["triangles"], 36);
  for (const char* key : {"load", "bvh", "upload", "compile", "render", "write", "total"})
    EXPECT_GE(stats["seconds"][key].get<double>(), 0.0) << key;
  EXPECT_GT(stats["seconds"]["render"].get<double>(), 0.0);
  EXPECT_GT(stats["seconds"]["first_pixel"].get<double>(), 0.0);
  EXPECT_LE(stats["seconds"]["first_pixel"].get<double>(), stats["seconds"]["total"].get<double>());
  EXPECT_EQ(stats["bvh"]["quality"], "best"); // the tree is small, the render not so
  for (const char* key : {"build_seconds", "sah", "nodes", "copies", "bytes", "bytes_per_triangle"})
    EXPECT_TRUE(stats["bvh"][key].is_number()) << key;
  EXPECT_EQ(stats["rays"]["camera"], 48 * 32 * 4);
  EXPECT_GT(stats["rays"]["bounce"].get<int>(), 0);
  EXPECT_GT(stats["rays"]["shadow"].get<int>(), 0);
  EXPECT_GT(stats["mrays_per_second"].get<double>(), 0.0);
  EXPECT_GT(stats["error"]["relative_rms"].get<double>(), 0.0);
  EXPECT_LE(stats["error"]["ci95"][0].get<double>(), stats["error"]["ci95"][1].get<double>());
  EXPECT_TRUE(stats["error"]["method"].is_string() && stats["error"]["slope"].is_number());
  EXPECT_EQ(stats["nonfinite"]["samples"], 0);
  EXPECT_TRUE(stats["nonfinite"]["first"].is_null());
  EXPECT_EQ(stats["bias"].size(), 1u);
  for (const Json& entry : stats["left_out"])
    EXPECT_TRUE(entry["what"].is_string() && entry["why"].is_string() && entry["bytes"].is_number_unsigned()) << entry;
  for (const char* key : {"scene", "bvh", "paths", "film"}) EXPECT_GT(stats["memory"][key].get<int>(), 0) << key;
  EXPECT_GE(stats["memory"]["peak"].get<int>(), stats["memory"]["film"].get<int>());

  ASSERT_EQ(stats["checkpoints"].size(), 3u); // 1, 2 and 4 samples
  for (const Json& point : stats["checkpoints"]) {
    for (const char* key : {"spp", "seconds", "gpu_seconds", "rays"}) EXPECT_TRUE(point[key].is_number()) << key;
    for (const char* key : {"mse", "relmse", "mrse", "flip"})
      EXPECT_TRUE(point.contains(key) && point[key].is_null()) << key;
  }
  EXPECT_TRUE(stats["checkpoints"][0]["estimated_relative_rms"].is_null()); // one sample has no spread
  EXPECT_GT(stats["checkpoints"][2]["estimated_relative_rms"].get<double>(), 0.0);
}

TEST_F(CliRenderTest, TwoRunsAreBitIdentical) {
  ASSERT_EQ(render({"-o", exr_, "--spp", "4"}).exit_code, 0);
  ASSERT_EQ(render({"-o", folder_.file("b.exr"), "--spp", "4"}).exit_code, 0);
  ASSERT_EQ(render({"-o", folder_.file("c.exr"), "--spp", "4", "--seed", "1"}).exit_code, 0);
  const Picture a = read_picture(exr_), b = read_picture(folder_.file("b.exr")),
                c = read_picture(folder_.file("c.exr"));
  for (std::size_t i = 0; i < a.channels.size(); ++i) EXPECT_EQ(a.channels[i].values, b.channels[i].values);
  EXPECT_NE(a.channels[0].values, c.channels[0].values);
}

TEST_F(CliRenderTest, PartsAverageToTheWhole) {
  for (const std::string sampler : {"independent", "stratified", "sobol"}) {
    const auto part = [&](const char* range) {
      EXPECT_EQ(render({"-o", exr_, "--spp", "8", "--sampler", sampler, "--samples", range}).exit_code, 0);
      EXPECT_EQ(read_attribute(exr_, "wavepath.samples"), range);
      return read_picture(exr_);
    };
    const Picture first = part("0:4"), second = part("4:8"), whole = part("0:8");
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t i = 0; i < whole.channels[c].values.size(); ++i) {
        const float value = whole.channels[c].values[i];
        ASSERT_NEAR(0.5f * (first.channels[c].values[i] + second.channels[c].values[i]), value, 1e-5f * (1.0f + value))
            << sampler << " pixel " << i;
      }
  }
}

// Before the first wave nothing is known of the device's speed. CPUs, which no watchdog looks at, take as many paths as
// are still quick to stop, but few where a clock ends the render; GPUs always take few.
TEST_F(CliRenderTest, TheFirstWaveIsLongWhereNoClockEndsIt) {
  bool is_cpu = false;
  const auto waves = [&](std::vector<std::string> flags) {
    flags.insert(flags.end(), {"-o", exr_, "--size", "256x192", "--spp", "1", "-q", "--stats", stats_});
    EXPECT_EQ(render(flags).exit_code, 0);
    const Json stats = Json::parse(std::ifstream(stats_));
    is_cpu = stats["device"]["type"] == "cpu";
    for (const Json& stage : stats["stages"])
      if (stage["name"] == "generate") return stage["dispatches"].get<int>();
    return 0;
  };
  const int whole = waves({});
  EXPECT_EQ(whole == 1, is_cpu) << whole;
  EXPECT_GT(waves({"--time", "600"}), 1);
}

TEST_F(CliRenderTest, TheTargetDecidesTheExitCode) {
  EXPECT_EQ(render({"-o", exr_, "--target-error", "0.000001", "--spp", "4"}).exit_code, 3);
  EXPECT_TRUE(std::filesystem::exists(exr_));
  EXPECT_EQ(render({"-o", exr_, "--target-error", "10"}).exit_code, 0);
}

TEST_F(CliRenderTest, TimeEndsTheRender) {
  ASSERT_EQ(render({"-o", exr_, "--time", "0.3", "--stats", stats_, "-q"}).exit_code, 0);
  const Json stats = Json::parse(std::ifstream(stats_));
  EXPECT_GT(stats["spp"].get<int>(), 0);
  EXPECT_LT(stats["spp"].get<int>(), 65536);
  EXPECT_EQ(stats["checkpoints"].back()["spp"], stats["spp"]);
}

TEST_F(CliRenderTest, ReferenceGivesTheTrueErrorAndItsFilter) {
  const std::string reference = folder_.file("reference.exr");
  ASSERT_EQ(render({"-o", reference, "--spp", "64", "--filter", "box", "--seed", "5"}).exit_code, 0);
  ASSERT_EQ(render({"-o", exr_, "--spp", "4", "--reference", reference, "--stats", stats_}).exit_code, 0);
  EXPECT_EQ(read_attribute(exr_, "wavepath.filter"), "box");
  const Json last = Json::parse(std::ifstream(stats_))["checkpoints"].back();
  EXPECT_GT(last["relmse"].get<double>(), 0.0);
  EXPECT_GT(last["flip"].get<double>(), 0.0);
  const Json compared = Json::parse(run_wavepath({"compare", exr_, reference, "--json"}).out);
  EXPECT_EQ(last["relmse"], compared["relmse"]);
  EXPECT_EQ(last["mse"], compared["mse"]);
  EXPECT_EQ(
      run_wavepath({"render", scene_file("cornell_box.gltf"), "--size", "8x8", "-o", exr_, "--reference", reference})
          .exit_code,
      2);
}

TEST_F(CliRenderTest, AnInterruptSavesAndExits130) {
  if (!has_terminals()) GTEST_SKIP() << "needs a pseudo-terminal: mount /dev/pts";
  for (const int signal : {SIGINT, SIGTERM}) {
    RunOptions options;
    options.terminal = true; // the bar on a terminal is also what tells that rendering has begun
    options.signal_after = "elapsed";
    options.signal = signal;
    const Outcome outcome = render({"-o", exr_, "--spp", "100000000"}, options);
    EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
    EXPECT_NE(outcome.err.find(" spp "), std::string::npos);
    EXPECT_NE(outcome.err.find("Mrays/s"), std::string::npos);
    EXPECT_EQ(read_picture(exr_).width, 48u);
    std::filesystem::remove(exr_);
  }
}

TEST_F(CliRenderTest, AFullDiskFailsAndLeavesNothing) {
  SmallDisk disk(folder_.path());
  std::ofstream(exr_) << "old";
  disk.leave(2000);
  const Outcome outcome = render({"-o", exr_, "--spp", "1", "-q"}, disk.options());
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  EXPECT_NE(outcome.err.find("a.exr: cannot write"), std::string::npos) << outcome.err;
  EXPECT_EQ(std::filesystem::file_size(exr_), 3u);
  EXPECT_EQ(file_count(), 1u);
}

TEST_F(CliRenderTest, WhatDoesNotFitIsRefusedInNumbers) {
  const Outcome outcome = run_wavepath({"render", scene_file("cornell_box.gltf"), "--size", "65536x65536", "-o", exr_});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("GiB is available; use a smaller --size"), std::string::npos) << outcome.err;
}

// What tev has at the end is what the file has; a picture comes early, and more on the way.
TEST_F(CliRenderTest, TevIsShownThePicture) {
  for (const std::vector<std::string>& extra :
       {std::vector<std::string>{"--integrator", "path", "--time", "3.5", "--aov", "albedo"},
        {"--integrator", "hybrid", "--spp", "4"},
        {"--devices", "0", "--spp", "8"}}) {
    FakeTev tev;
    std::vector<std::string> flags = {"-o", exr_, "--tev", tev.address()};
    flags.insert(flags.end(), extra.begin(), extra.end());
    const Outcome outcome = render(flags);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    tev.wait();
    ASSERT_EQ(tev.images.size(), 1u);
    const Picture &shown = tev.images.begin()->second, written = read_picture(exr_);
    EXPECT_EQ(tev.images.begin()->first, exr_);
    EXPECT_GE(tev.pictures, extra[2] == "--time" ? 3 : 2) << extra[1];
    for (const Channel& channel : shown.channels) {
      const auto same = std::find_if(written.channels.begin(), written.channels.end(),
                                     [&](const Channel& other) { return other.name == channel.name; });
      ASSERT_NE(same, written.channels.end()) << channel.name;
      EXPECT_EQ(same->values, channel.values) << extra[1] << " " << channel.name;
    }
  }
}

TEST_F(CliRenderTest, ATevThatGoesAwayEndsNothing) {
  FakeTev tev(1);
  const Outcome gone = render({"-o", exr_, "--tev", tev.address(), "--integrator", "path", "--time", "3"});
  EXPECT_EQ(gone.exit_code, 0) << gone.err;
  EXPECT_NE(gone.err.find("wavepath: warning: --tev: the viewer is gone; the render went on without it"),
            std::string::npos)
      << gone.err;
  EXPECT_EQ(read_picture(exr_).width, 48u);
  std::filesystem::remove(exr_);
  tev.wait();
  const Outcome none = render({"-o", exr_, "--tev", tev.address()});
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_NE(none.err.find("wavepath: error: --tev: no tev answers at "), std::string::npos) << none.err;
  EXPECT_FALSE(std::filesystem::exists(exr_));
}

TEST_F(CliRenderTest, UnknownDevicesAreNamed) {
  const Outcome outcome = render({"-o", exr_, "--device", "no such device"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("no such device"), std::string::npos);
  const Outcome info = run_wavepath({"info", "--json"});
  EXPECT_EQ(info.exit_code, 0);
  EXPECT_EQ(Json::parse(info.out)["devices"].size(), list_devices().size());
}

TEST_F(CliRenderTest, VerboseNamesWhatIsLeftOut) {
  const Outcome outcome = render({"-o", exr_, "--spp", "1", "-v"});
  for (const char* word : {"device", "memory", "seconds", "left out", "extend"})
    EXPECT_NE(outcome.err.find(word), std::string::npos) << word;
}

TEST_F(CliRenderTest, TellsTheLightAndTheExposureItChose) {
  const std::string png = folder_.file("a.png"), again = folder_.file("b.png");
  const Outcome outcome = render({"-o", png, "--spp", "4"});
  EXPECT_NE(outcome.err.find("wavepath: light: as authored"), std::string::npos) << outcome.err;
  const std::string before = png + " (exposure ";
  const std::size_t at = outcome.err.find(before);
  ASSERT_NE(at, std::string::npos) << outcome.err;
  const std::string value = outcome.err.substr(at + before.size(), outcome.err.find(')', at) - at - before.size());
  const Outcome repeated = render({"-o", again, "--spp", "4", "--exposure", value, "--env", "black"});
  EXPECT_EQ(repeated.err.find("wavepath: light:"), std::string::npos) << "the user said it";
  EXPECT_EQ(read_picture(png).channels[1].values, read_picture(again).channels[1].values);
  // Not dark: the mean of the Cornell box is near the middle of the scale.
  const std::vector<float> green = read_picture(png).channels[1].values;
  const double mean = std::accumulate(green.begin(), green.end(), 0.0) / static_cast<double>(green.size());
  EXPECT_GT(to_srgb(static_cast<float>(mean)), 0.4);
  const Outcome linear = render({"-o", exr_, "--spp", "4"});
  EXPECT_EQ(linear.err.find("exposure"), std::string::npos) << "of no linear output";
}

} // namespace
} // namespace wavepath::test
