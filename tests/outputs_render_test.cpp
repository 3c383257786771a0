// Nothing that a render has made is lost: not to what is measured after it, to an output that fails, to a terminal or a
// reader that goes away, or to a viewer that hangs.
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <future>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <gtest/gtest.h>

#include "host/base/clock.h"
#include "tests/fake_tev.h"
#include "tests/scene_folder.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {
namespace {

using Json = nlohmann::json;

const std::string kBox = std::string(WAVEPATH_SOURCE_DIR) + "/scenes/cornell_box.gltf";

class OutputsRender : public SceneFolder {
protected:
  void SetUp() override { end_test_without_device(list_devices().empty() ? "no driver offers one" : ""); }

  Outcome render(const std::string& scene, const std::vector<std::string>& flags,
                 const RunOptions& options = {}) const {
    std::vector<std::string> words = {"render", scene, "--size", "16x12", "--spp", "2"};
    words.insert(words.end(), flags.begin(), flags.end());
    return run(words, options);
  }
  bool whole(const std::string& name) const { return read_picture(file(name)).width == 16; }

  // A slab of glass under a lamp, whose glass disperses light, or whose body scatters it.
  std::string slab(const std::string& extension, const Json& values) const {
    Json root =
        Json::parse(std::ifstream(std::string(WAVEPATH_SOURCE_DIR) + "/scenes/analytic/absorbing_glass_slab.gltf"));
    root["materials"][1]["extensions"][extension] = values;
    root["extensionsUsed"].push_back(extension);
    root["extensionsUsed"].push_back("KHR_lights_punctual");
    root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 3.0}}};
    root["nodes"].push_back({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}, {"translation", {0, 2, 0}}});
    root["scenes"][0]["nodes"].push_back(root["nodes"].size() - 1);
    const std::string path = file(extension + ".gltf");
    std::ofstream(path) << root;
    return path;
  }
  std::string dispersing() const { return slab("KHR_materials_dispersion", {{"dispersion", 0.3}}); }
};

// Textures and buffers are known once the scene is read.
TEST_F(OutputsRender, ReplaceNoFileOfTheScene) {
  for (const char* line : {"render scene.gltf -o skin.png", "render scene.gltf -o hard.png",
                           "render scene.gltf -o a.exr -o sub/../unused.png",
                           "render scene.gltf -o a.exr --stats shape.bin", "bench scene.gltf --json shape.bin"})
    expect_refused(line, "would overwrite an input");
  std::filesystem::create_directories(file("sub/pictures"));
  std::filesystem::create_hard_link(file("skin.png"), file("sub/pictures/reference.png"));
  expect_refused("study scene.gltf -o sub --vary sampler --budget 1", "would overwrite an input");
}

// How much light paths from the camera cannot find is measured by an integrator that cannot render every scene.
TEST_F(OutputsRender, WhatCannotBeMeasuredIsTold) {
  const std::string scatter = "KHR_materials_volume_scatter";
  for (const auto& [scene, problem] : {std::pair{dispersing(), "cannot render glass that disperses light"},
                                       std::pair{slab(scatter, {{"multiscatterColor", {0.5, 0.5, 0.5}}}),
                                                 "cannot render volumes that scatter light"}}) {
    SCOPED_TRACE(problem);
    const Outcome outcome = render(scene, {"-o", "a.exr", "--stats", "s.json", "--json", "-v"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(whole("a.exr"));
    const Json stats = Json::parse(contents(file("s.json")));
    EXPECT_EQ(stats, Json::parse(outcome.out));
    EXPECT_NE(
        stats["bias"].dump().find("how much was not measured (--integrator bidirectional: " + std::string(problem)),
        std::string::npos)
        << stats["bias"];
    const std::string warning =
        "wavepath: warning: how much light is missing was not measured: --integrator bidirectional";
    EXPECT_NE(outcome.err.find(warning), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.err.find(warning), outcome.err.rfind(warning)) << outcome.err;
    const Outcome quiet = render(scene, {"-o", "b.png", "-q"});
    EXPECT_EQ(quiet.exit_code, 0);
    EXPECT_EQ(quiet.err.find("not measured"), std::string::npos) << "nobody asked: " << quiet.err;
    // What stays dark is told without being asked, by the scene alone.
    EXPECT_EQ(quiet.err.find("do not shine into bodies that scatter") != std::string::npos,
              std::string_view(problem).find("scatter") != std::string_view::npos)
        << quiet.err;
  }
}

// Of a grid, what can be rendered is, and the rest is named.
TEST_F(OutputsRender, AStudyLeavesOutWhatCannotBeRendered) {
  const Outcome outcome = run({"study", dispersing(), "-o", "study", "--vary", "integrator", "--size", "8x8",
                               "--budget", "0.5", "--reference-spp", "2"});
  const Json study = Json::parse(contents(file("study/study.json")));
  std::string left_out;
  for (const Json& one : study["unfit"]) left_out += one["configuration"].get<std::string>() + " ";
  EXPECT_EQ(left_out, "bidirectional whitted radiosity ");
  EXPECT_GT(study["configurations"].size(), 1u);
  EXPECT_NE(outcome.err.find("wavepath: left out bidirectional, whitted: cannot render glass that disperses light"),
            std::string::npos)
      << outcome.err;
}

// The device goes while the report is measured: the picture and the stats are there.
TEST_F(OutputsRender, ADeviceThatIsLostInTheReportCostsNoPicture) {
  bool lost = false;
  for (int submissions = 4; submissions < 200 && !lost; submissions = submissions * 5 / 4) {
    RunOptions options;
    options.in_child = [&] { setenv("WAVEPATH_LOSE_DEVICE", std::to_string(submissions).c_str(), 1); };
    const Outcome outcome = render(kBox, {"--integrator", "path", "-o", "a.exr", "--stats", "s.json"}, options);
    if (outcome.err.find("not measured: the device was lost") == std::string::npos) continue;
    lost = true;
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(whole("a.exr"));
    EXPECT_NE(Json::parse(contents(file("s.json")))["bias"].dump().find("was not measured (the device was lost"),
              std::string::npos);
  }
  EXPECT_TRUE(lost) << "no number of submissions ended within the report";
}

TEST_F(OutputsRender, OneThatFailsDoesNotCostTheOthers) {
  // What is a folder, or leads into nothing, by the time it is written: the folder of `gone` is removed meanwhile.
  RunOptions full;
  full.in_child = [] { // files of at most 1 KiB
    const rlimit limit{1024, 1024};
    setrlimit(RLIMIT_FSIZE, &limit);
    setenv("MESA_SHADER_CACHE_DISABLE", "1", 1);
    setenv("WAVEPATH_CACHE", "off", 1);
  };
  const Outcome outcome =
      render(kBox, {"--integrator", "path", "-o", "a.exr", "-o", "small.png", "--stats", "s.json", "--json"}, full);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("wavepath: error: "), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("a.exr: cannot write"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("wavepath: warning: "), std::string::npos) << "of the stats file: " << outcome.err;
  EXPECT_NE(outcome.err.find("wavepath: small.png (exposure"), std::string::npos) << outcome.err;
  EXPECT_TRUE(whole("small.png"));
  EXPECT_FALSE(std::filesystem::exists(file("a.exr")));
  EXPECT_EQ(Json::parse(outcome.out)["spp"], 2);

  RunOptions no_reader;
  no_reader.in_child = [] { dup2(open("/dev/full", O_WRONLY), STDOUT_FILENO); };
  const Outcome told = render(kBox, {"--integrator", "path", "-o", "b.exr", "--stats", "t.json", "--json"}, no_reader);
  EXPECT_EQ(told.exit_code, 1);
  EXPECT_NE(told.err.find("wavepath: error: stdout: cannot be written (No space left on device)"), std::string::npos);
  EXPECT_TRUE(whole("b.exr"));
  EXPECT_EQ(Json::parse(contents(file("t.json")))["spp"], 2);
}

// Killed without a warning, a render has left what it had every --save-every seconds: whole, even, and repeatable.
TEST_F(OutputsRender, PicturesAreSavedOnTheWay) {
  const std::string picture = file("a.exr"), stats = file("s.json"), pid_file = file("pid");
  RunOptions watched;
  watched.in_child = [&] {
    const pid_t self = getpid();
    const int written = open(pid_file.c_str(), O_CREAT | O_WRONLY, 0600);
    if (write(written, &self, sizeof self) != sizeof self) _exit(99);
    close(written);
  };
  std::future<bool> killed = std::async(std::launch::async, [&] {
    const auto begun = Clock::now();
    while (seconds_since(begun) < 300.0 && !(std::filesystem::exists(picture) && std::filesystem::exists(stats)))
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    pid_t child = 0;
    std::ifstream(pid_file, std::ios::binary).read(reinterpret_cast<char*>(&child), sizeof child);
    return child > 0 && kill(child, SIGKILL) == 0;
  });
  const Outcome outcome = render(kBox,
                                 {"--spp", "100000000", "--integrator", "path", "--mergeable", "--save-every", "0.001",
                                  "-o", "a.exr", "-o", "a.png", "--stats", "s.json", "-q"},
                                 watched);
  EXPECT_TRUE(killed.get());
  EXPECT_EQ(outcome.exit_code, 128 + SIGKILL) << outcome.err;
  EXPECT_TRUE(whole("a.exr") && whole("a.png"));
  const Json document = Json::parse(contents(stats));
  EXPECT_EQ(document["under_way"], true);
  EXPECT_GT(document["spp"], 0);

  // The file may be one step further than the stats.
  std::string repeat = read_attribute(picture, "wavepath.repeat");
  ASSERT_TRUE(repeat.starts_with("wavepath ")) << repeat;
  repeat = std::string(WAVEPATH_BINARY) + repeat.substr(8) + " -q -o '" + file("again.exr") + "'";
  ASSERT_EQ(std::system(repeat.c_str()), 0) << repeat;
  EXPECT_TRUE(*read_film(picture) == *read_film(file("again.exr"))) << repeat;
}

TEST_F(OutputsRender, SavingOnTheWayChangesNoBit) {
  for (const char* integrator : {"path", "bidirectional", "hybrid"}) {
    EXPECT_EQ(render(kBox, {"--spp", "9", "--integrator", integrator, "-o", "a.exr", "-q"}).exit_code, 0);
    const Outcome saving = render(kBox, {"--spp", "9", "--integrator", integrator, "-o", "b.exr", "--stats", "s.json",
                                         "--save-every", "1e-9", "-q"});
    EXPECT_EQ(saving.exit_code, 0) << saving.err;
    const Picture a = read_picture(file("a.exr")), b = read_picture(file("b.exr"));
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(a.channels[i].values, b.channels[i].values) << integrator;
    EXPECT_FALSE(Json::parse(contents(file("s.json"))).contains("under_way"));
  }
}

// Streams that nobody reads, or that are not there at all, and a disk under stderr that is full.
// Parts of other layouts, a lossy one among them, join to the bits of the whole; so does what the merge writes.
TEST_F(OutputsRender, PartsOfEveryLayoutJoin) {
  const std::vector<std::string> channels = {"--aov", "albedo,normal,position,samples", "-q"};
  const auto part = [&](const std::string& name, std::vector<std::string> flags) {
    flags.insert(flags.end(), channels.begin(), channels.end());
    flags.insert(flags.end(), {"--integrator", "path", "-o", name});
    const Outcome outcome = render(kBox, flags);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  };
  part("whole.exr", {"--mergeable"});
  part("a.exr", {"--samples", "0:1", "--layers", "blender", "--compression", "dwaa"});
  part("b.exr", {"--samples", "1:2", "--multi-part", "--compression", "piz"});
  const Outcome merged = run({"merge", "a.exr", "b.exr", "-o", "merged.exr", "--layers", "blender", "--multi-part"});
  EXPECT_EQ(merged.exit_code, 0) << merged.err;
  const Picture whole = read_picture(file("whole.exr")), joined = read_picture(file("merged.exr"));
  ASSERT_EQ(joined.channels.size(), whole.channels.size());
  for (const char* name : {"R", "G", "B", "A", "samples"})
    EXPECT_EQ(find_channel(joined, name)->values, find_channel(whole, name)->values) << name;

  const Outcome compared = run({"compare", "merged.exr", "whole.exr", "--max", "mse=0"});
  EXPECT_EQ(compared.exit_code, 0) << compared.err;
  const Outcome again = render(kBox, {"--reference", "a.exr", "--plan", "b.exr", "-o", "again.exr"});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_NE(again.err.find("a.exr: was compressed with a loss"), std::string::npos) << again.err;
}

TEST_F(OutputsRender, BrokenStreamsCostNoPicture) {
  const auto broken = [](int descriptor) {
    int ends[2];
    if (pipe(ends) != 0) _exit(98);
    dup2(ends[1], descriptor);
    close(ends[0]), close(ends[1]);
  };
  const std::vector<std::pair<const char*, std::function<void()>>> ways = {
      {"stderr: broken pipe", [&] { broken(STDERR_FILENO); }},
      {"stderr: closed", [] { close(STDERR_FILENO); }},
      {"stderr: full", [] { dup2(open("/dev/full", O_WRONLY), STDERR_FILENO); }},
      {"stdout: broken pipe", [&] { broken(STDOUT_FILENO); }},
      {"stdout: closed", [] { close(STDOUT_FILENO); }},
      {"all closed", [] { close(STDIN_FILENO), close(STDOUT_FILENO), close(STDERR_FILENO); }},
      {"both: broken pipes", [&] { broken(STDOUT_FILENO), broken(STDERR_FILENO); }}};
  for (const auto& [name, in_child] : ways) {
    SCOPED_TRACE(name);
    RunOptions options;
    options.in_child = in_child;
    const bool out = std::string(name).find("stderr") != 0;
    std::vector<std::string> flags = {"--integrator", "path",   "-o",           "a.exr",
                                      "--stats",      "s.json", "--checkpoint", "state"};
    if (out) flags.emplace_back("--json");
    const Outcome outcome = render(kBox, flags, options);
    const bool reader_gone = std::string(name).find("stdout: broken") == 0 || std::string(name).find("both") == 0;
    EXPECT_EQ(outcome.exit_code, reader_gone ? 141 : out ? 1 : 0) << outcome.err;
    EXPECT_TRUE(whole("a.exr"));
    EXPECT_EQ(Json::parse(contents(file("s.json")))["spp"], 2);
    for (const char* made : {"a.exr", "s.json", "state"}) EXPECT_TRUE(std::filesystem::remove(file(made))) << made;
  }
}

// A terminal that closes sends SIGHUP, often more than once, and takes stderr with it.
TEST_F(OutputsRender, AHangUpSavesAndExits130) {
  for (const int times : {1, 3}) {
    RunOptions options;
    options.in_child = [=] { // this process sends them, from a child of its own, once the state is there
      const pid_t parent = getpid();
      if (fork() != 0) return;
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      for (int i = 0; i < 3000 && access("state", F_OK) != 0; ++i) usleep(10000);
      for (int i = 0; i < times; ++i) kill(parent, SIGHUP), usleep(2000);
      _exit(0);
    };
    const Outcome outcome = render(kBox,
                                   {"--integrator", "path", "--spp", "100000000", "-o", "a.exr", "--checkpoint",
                                    "state", "--checkpoint-interval", "0"},
                                   options);
    EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
    EXPECT_TRUE(whole("a.exr"));
    EXPECT_TRUE(std::filesystem::remove(file("state")));
    EXPECT_TRUE(std::filesystem::remove(file("a.exr")));
  }
}

// It takes the connection and reads nothing.
TEST_F(OutputsRender, AViewerThatHangsStallsNothing) {
  const SilentTev tev;
  const std::vector<std::string> flags = {"--integrator", "path",
                                          "--size",       "640x480",
                                          "--max-depth",  "1",
                                          "-o",           "a.exr",
                                          "--aov",        "albedo,normal,position,direct,indirect"};
  const auto seconds = [&](std::vector<std::string> more) {
    more.insert(more.begin(), flags.begin(), flags.end());
    const Clock::time_point start = Clock::now();
    const Outcome outcome = render(kBox, more);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const bool told = outcome.err.find("--tev: the viewer did not take the whole picture") != std::string::npos;
    EXPECT_EQ(told, more.size() > flags.size()) << outcome.err;
    return seconds_since(start);
  };
  seconds({}); // the kernels are in the cache
  const double without = seconds({}), with = seconds({"--tev", tev.address()});
  EXPECT_LT(with, without + 3.0) << "a second, and what a busy machine adds; before, ten";
}

} // namespace
} // namespace wavepath::test
