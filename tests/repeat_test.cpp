// The plan of a render as users meet it: `repeat` of stats and pictures renders the same bits, --plan takes it over
// from any file that holds it, info tells it before there is a picture.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/picture/files/exr.h"
#include "host/picture/files/picture_io.h"
#include "tests/gltf_builder.h"
#include "tests/moving_lamps.h"
#include "tests/plan_in_stats.h"
#include "tests/run_wavepath.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {
namespace {

using Json = nlohmann::json;

const std::string kScenes = std::string(WAVEPATH_SOURCE_DIR) + "/scenes/";

struct Case {
  std::string name;
  std::vector<std::string> flags; // LAMPS stands for the generated scene
};

class Repeat : public ProgramTest, public testing::WithParamInterface<Case> {
protected:
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  Outcome run(std::vector<std::string> words) const {
    words.insert(words.begin(), WAVEPATH_BINARY);
    return run_program(words, {.folder = folder_.path().string()});
  }
  // Renders what a command says, into again.exr.
  Picture again(const std::string& command) const {
    const std::string program = "wavepath";
    EXPECT_EQ(command.substr(0, program.size()), program);
    const std::string line = WAVEPATH_BINARY + command.substr(program.size()) + " -q -o again.exr";
    const Outcome outcome = run_program({"/bin/sh", "-c", line}, {.folder = folder_.path().string()});
    EXPECT_EQ(outcome.exit_code, 0) << line << "\n" << outcome.err;
    return read_picture(path("again.exr"));
  }
  Json stats() const { return Json::parse(std::ifstream(path("stats.json"))); }
  static void expect_same_bits(const Picture& a, const Picture& b) {
    for (const char* name : {"R", "G", "B", "A"}) {
      const Channel *of_a = find_channel(a, name), *of_b = find_channel(b, name);
      ASSERT_EQ(of_a != nullptr, of_b != nullptr) << name; // a PNG without transparency has no A
      if (!of_a) continue;
      EXPECT_EQ(of_a->values, of_b->values) << name;
    }
  }

  TempFolder folder_;
};

TEST_P(Repeat, StatsAndPictureGiveACommandThatRendersTheSameBits) {
  std::vector<std::string> words = {"render"};
  for (const std::string& flag : GetParam().flags)
    words.push_back(flag == "LAMPS" ? moving_box_under_lamps(folder_, 40) : flag);
  words.insert(words.end(), {"-q", "-o", "whole.exr", "--stats", "stats.json"});
  const Outcome outcome = run(words);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json measured = stats();
  ASSERT_TRUE(measured["repeat"].is_string());
  const std::string command = measured["repeat"];
  EXPECT_EQ(measured["camera"]["projection"] == "fisheye", std::ranges::count(words, "fisheye") > 0);
  EXPECT_EQ(measured["camera"]["stereo"], std::ranges::count(words, "--stereo") > 0 ? 0.065 : 0.0);
  EXPECT_EQ(command.find("auto"), std::string::npos) << command;
  EXPECT_EQ(read_attribute(path("whole.exr"), "wavepath.repeat"), command);
  const Picture whole = read_picture(path("whole.exr"));
  expect_same_bits(again(command), whole);
  // As the plan that a file holds decides, without pilots.
  if (std::ranges::count(words, "--time") > 0) return; // ends by the clock again
  std::filesystem::rename(path("whole.exr"), path("first.exr"));
  words.insert(words.end(), {"--plan", "first.exr"});
  const Outcome second = run(words);
  ASSERT_EQ(second.exit_code, 0) << second.err;
  expect_same_bits(read_picture(path("whole.exr")), whole);
}

INSTANTIATE_TEST_SUITE_P(
    OfEveryKind, Repeat,
    testing::Values(
        Case{"box", {kScenes + "cornell_box.gltf", "--size", "256x128", "--spp", "32", "--max-depth", "4"}},
        Case{"white_sky",
             {kScenes + "showcase.glb", "--size", "128x96", "--spp", "16", "--max-depth", "3", "--env", "0.5,0.6,0.7",
              "--eye", "1.5,1.2,3"}},
        Case{"map",
             {kScenes + "showcase.glb", "--size", "96x72", "--spp", "8", "--max-depth", "3", "--env", "studio",
              "--env-rotation", "40"}},
        Case{"bulb", {kScenes + "caustics/bulb_point.glb", "--size", "16x12", "--spp", "64", "--max-depth", "5"}},
        Case{"variance",
             {kScenes + "cornell_box.gltf", "--size", "256x128", "--spp", "4", "--max-depth", "3", "--aov",
              "variance,albedo"}},
        Case{"lamps", {"LAMPS", "--size", "96x72", "--spp", "16", "--max-depth", "3"}},
        Case{"animation",
             {"LAMPS", "--size", "96x72", "--spp", "8", "--max-depth", "2", "--animation", "slide", "--at", "0.5"}},
        Case{"shutter",
             {"LAMPS", "--size", "96x72", "--spp", "8", "--max-depth", "2", "--animation", "slide", "--shutter",
              "0.2,0.8"}},
        Case{"catcher",
             {kScenes + "showcase.glb", "--size", "64x48", "--spp", "4", "--max-depth", "3", "--catcher", "ground",
              "--env", "0.5,0.6,0.7"}},
        Case{"fisheye",
             {kScenes + "cornell_box.gltf", "--size", "64x48", "--spp", "4", "--max-depth", "3", "--projection",
              "fisheye", "--fov", "171.3", "--shift", "0.1,0.2", "--clip", "0.1,inf"}},
        Case{"stereo",
             {kScenes + "cornell_box.gltf", "--size", "64x48", "--spp", "4", "--max-depth", "3", "--intrinsics",
              "30.1,31.3,16,24", "--stereo", "0.065", "--clip", "file"}},
        Case{"fast",
             {kScenes + "cornell_box.gltf", "--size", "64x48", "--spp", "4", "--max-depth", "3", "--velocity",
              "0.1,0.2,-0.7"}},
        Case{"guided", {kScenes + "cornell_box.gltf", "--size", "64x48", "--spp", "8", "--max-depth", "4", "--guide"}},
        Case{"mirrors",
             {kScenes + "analytic/mirror.gltf", "--size", "64x48", "--spp", "4", "--integrator", "hybrid",
              "--reflections", "ssr", "--reflection-threshold", "0.03", "--aperture", "0.05"}},
        Case{"patches",
             {kScenes + "cornell_box.gltf", "--size", "64x48", "--spp", "4", "--integrator", "radiosity", "--patches",
              "300", "--subdivision", "adaptive", "--patch-rays", "7", "--gather"}},
        Case{"layout_of_files",
             {kScenes + "cornell_box.gltf", "--size", "64x48", "--spp", "4", "--max-depth", "2", "--half", "--layers",
              "blender", "--compression", "dwaa", "--multi-part"}},
        Case{"by_the_clock",
             {kScenes + "showcase.glb", "--size", "48x32", "--time", "0.3", "--max-depth", "3", "--env", "studio"}}),
    [](const auto& of) { return of.param.name; });

class RepeatedFile : public Repeat {};

TEST_F(RepeatedFile, BitsOfPngAreThoseOfTheCommand) {
  ASSERT_EQ(run({"render", kScenes + "cornell_box.gltf", "--size", "32x24", "--spp", "2", "--max-depth", "2", "-q",
                 "--bits", "16", "-o", "deep.png", "--stats", "stats.json"})
                .exit_code,
            0);
  const std::string command = stats()["repeat"],
                    line = WAVEPATH_BINARY + command.substr(std::string("wavepath").size());
  EXPECT_NE(command.find("--bits 16"), std::string::npos) << command;
  const Outcome outcome =
      run_program({"/bin/sh", "-c", line + " -q -o again.png"}, {.folder = folder_.path().string()});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  expect_same_bits(read_picture(path("again.png")), read_picture(path("deep.png")));
}

class PlanFile : public Repeat {};

TEST_F(PlanFile, OfPictureStateAndStatsIsTheSame) {
  const std::vector<std::string> common = {
      "render", kScenes + "caustics/prism_spot.glb", "--size", "16x12", "--max-depth", "5", "-q"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), common.begin(), common.end());
    return more;
  };
  ASSERT_EQ(run(with({"--spp", "6144", "-o", "a.exr", "--checkpoint", "state", "--stats", "stats.json"})).exit_code, 0);
  EXPECT_EQ(decision_in(stats(), "integrator")["taken"], "bidirectional");
  EXPECT_EQ(decision_in(stats(), "integrator")["trials"].size(), 3u);
  EXPECT_GT(decision_in(stats(), "integrator")["fraction"].get<double>(), 0.0);
  std::filesystem::rename(path("stats.json"), path("first.json"));
  for (const std::string file : {"a.exr", "first.json", "state"}) { // short enough for no pilot
    SCOPED_TRACE(file);
    ASSERT_EQ(run(with({"--spp", "2", "-o", "b.exr", "--plan", file, "--stats", "stats.json"})).exit_code, 0);
    EXPECT_EQ(stats()["integrator"], "bidirectional");
    EXPECT_EQ(decision_in(stats(), "integrator")["why"], "recorded");
    EXPECT_EQ(decision_in(stats(), "techniques")["taken"], "hit,light,connect,splat");
  }
}

TEST_F(PlanFile, SaysWhatIsWrongWithOthers) {
  folder_.write("none.json", "{}");
  folder_.write("text.json", "no JSON");
  folder_.write("state", "nothing");
  for (const std::string file : {"none.json", "text.json", "state", "missing.json", "missing.exr"}) {
    const Outcome outcome = run({"render", kScenes + "cornell_box.gltf", "--size", "16x16", "--plan", file});
    EXPECT_EQ(outcome.exit_code, 1) << file;
    EXPECT_EQ(outcome.err.find("wavepath: error: " + file), 0u) << outcome.err;
  }
  const Outcome part = run({"render", kScenes + "cornell_box.gltf", "--samples", "0:2", "--training-paths", "9"});
  EXPECT_EQ(part.exit_code, 2);
  EXPECT_NE(part.err.find("--training-paths: parts of a render train alike"), std::string::npos) << part.err;
}

TEST_F(PlanFile, MergedPicturesKeepIt) {
  for (const std::string range : {"0:2", "2:4"})
    ASSERT_EQ(run({"render", kScenes + "cornell_box.gltf", "--size", "32x24", "--spp", "4", "--samples", range, "-q",
                   "-o", fmt::format("{}.exr", range[0])})
                  .exit_code,
              0);
  ASSERT_EQ(run({"merge", "0.exr", "2.exr", "-q", "-o", "all.exr"}).exit_code, 0);
  const Json plan = Json::parse(read_attribute(path("all.exr"), "wavepath.plan"));
  EXPECT_EQ(decision_in(Json{{"plan", plan}}, "adaptive")["taken"], "off");
}

TEST_F(PlanFile, InfoTellsItBeforeThereIsAPicture) {
  const std::string scene = kScenes + "cornell_box.gltf";
  const auto plan_of = [&](std::vector<std::string> flags) {
    std::vector<std::string> words = {"info", scene, "--plan", "--json", "--size", "256x192"};
    words.insert(words.end(), flags.begin(), flags.end());
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return Json::parse(outcome.out);
  };
  const Json longer = plan_of({"--spp", "64"});
  EXPECT_EQ(decision_in(longer, "reuse")["taken"], "auto");
  EXPECT_GT(decision_in(longer, "reuse")["fraction"].get<double>(), 0.0);
  EXPECT_EQ(decision_in(longer, "adaptive")["taken"], "auto");
  const Json brief = plan_of({"--spp", "1"});
  EXPECT_EQ(decision_in(brief, "reuse")["taken"], "off");
  EXPECT_EQ(decision_in(brief, "adaptive")["taken"], "off");
  EXPECT_EQ(decision_in(plan_of({"--spp", "64", "--reuse", "on"}), "reuse")["taken"], "on");
  const Outcome words = run({"info", scene, "--plan", "--size", "256x192", "--spp", "64"});
  EXPECT_NE(words.out.find("plan of a render at 256x192, 64 spp"), std::string::npos);
}

} // namespace
} // namespace wavepath::test
