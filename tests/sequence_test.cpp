// Frames of a film: names, skipped and repeated frames, what moves and what is kept, bad input.
#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/cli/progress.h"
#include "host/cli/sequence_request.h"
#include "host/picture/files/picture_io.h"
#include "tests/gltf_builder.h"
#include "tests/moving_lamps.h"
#include "tests/run_wavepath.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {
namespace {

using Json = nlohmann::json;

const std::string kBox = std::string(WAVEPATH_SOURCE_DIR) + "/scenes/cornell_box.gltf";

TEST(SequenceNames, HoldThePlaceOfTheNumber) {
  EXPECT_EQ(numbered("film.%04d.exr", 7), "film.0007.exr");
  EXPECT_EQ(numbered("film.####.exr", 12345), "film.12345.exr");
  EXPECT_EQ(numbered("%d/##.exr", 3), "3/03.exr");
  EXPECT_EQ(numbered("100%.exr", 3), "100%.exr");
  EXPECT_TRUE(has_number("a#.png"));
  EXPECT_FALSE(has_number("a%s.png"));
  EXPECT_FALSE(has_number("a%4d.png")); // would be filled with spaces
}

TEST(SequenceSeeds, DifferByFrameAndAreHeldWhereAsked) {
  SequenceRequest request;
  std::vector<std::uint32_t> seeds;
  for (std::uint32_t frame = 0; frame < 1000; ++frame) seeds.push_back(seed_of(request, 5, frame));
  std::ranges::sort(seeds);
  EXPECT_LE(seeds.back(), 0x7fffffffu) << "--seed takes it";
  EXPECT_EQ(std::ranges::adjacent_find(seeds), seeds.end());
  EXPECT_NE(seed_of(request, 5, 1), seed_of(request, 6, 1));
  request.seed_per_frame = false;
  EXPECT_EQ(seed_of(request, 5, 3), 5u);
}

TEST(SequenceProgress, IsOfAllFrames) {
  Progress progress;
  progress.fraction = 0.5;
  progress.seconds = 1.0;
  const std::string text = progress_text(progress, {.number = 8, .before = 1, .count = 3}, 6.0, 0.0, 0.0, 10);
  EXPECT_EQ(text.find("[#####.....]  50 %  frame 8 (2 of 3)"), 0u) << text;
  EXPECT_NE(text.find("6.0 s elapsed, 6.0 s left"), std::string::npos) << text;
}

class Sequence : public ProgramTest {
protected:
  Sequence() : lamps_(moving_box_under_lamps(folder_, 3)) {}

  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  bool exists(const std::string& name) const { return std::filesystem::exists(path(name)); }
  Outcome run(const std::string& line, RunOptions options = {}) const {
    options.folder = folder_.path().string();
    return run_program({"/bin/sh", "-c", "exec " WAVEPATH_BINARY " " + line}, options);
  }
  // Of a box that slides under lamps.
  std::string sliding(const std::string& more) const {
    return fmt::format("render {} --size 32x24 --spp 2 --max-depth 2 --animation slide --fps 4 {}", lamps_, more);
  }
  Json stats(const std::string& name) const { return Json::parse(std::ifstream(path(name))); }
  std::vector<float> red(const std::string& name) const {
    const Picture picture = read_picture(path(name));
    return find_channel(picture, "R")->values;
  }
  // The frame by the command that its stats tell.
  std::vector<float> again(const std::string& stats_file) const {
    const std::string command = stats(stats_file)["repeat"], program = "wavepath ";
    EXPECT_EQ(command.find(program), 0u);
    const Outcome outcome = run(command.substr(program.size()) + " -q -o again.exr");
    EXPECT_EQ(outcome.exit_code, 0) << command << outcome.err;
    return red("again.exr");
  }
  void expect_refused(const std::string& line, const std::string& words) const {
    const Outcome outcome = run(line);
    EXPECT_EQ(outcome.exit_code, 2) << line << outcome.err;
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
  }

  TempFolder folder_;
  std::string lamps_;
};

TEST_F(Sequence, AFrameHasTheBitsOfItsOwnCommandAndOfAnyRange) {
  const Outcome film = run(sliding("--frames 0:4 -o film.%02d.exr --stats film.%02d.json"));
  ASSERT_EQ(film.exit_code, 0) << film.err;
  EXPECT_EQ(again("film.00.json"), red("film.00.exr"));
  EXPECT_EQ(again("film.03.json"), red("film.03.exr"));
  const Outcome alone = run(sliding("--frames 3:4 -o alone.exr"));
  ASSERT_EQ(alone.exit_code, 0) << alone.err;
  EXPECT_EQ(red("alone.exr"), red("film.03.exr"));
  EXPECT_NE(red("film.00.exr"), red("film.03.exr"));
  const Json frame = stats("film.03.json")["frame"];
  EXPECT_EQ(frame["number"], 3);
  EXPECT_EQ(frame["at"], 0.75);
  EXPECT_EQ(frame["kept"], Json({"surfaces"}));
  // Of four triangles the lid's two have moved: the floor's tree is kept.
  EXPECT_EQ(frame["built_triangles"], 2);
  EXPECT_NE(stats("film.02.json")["seed"], stats("film.03.json")["seed"]);
}

TEST_F(Sequence, LeavesFramesAloneThatAreThere) {
  ASSERT_EQ(run(sliding("--frames 0:3 -o film.#.exr --stats film.#.json")).exit_code, 0);
  const std::vector<float> second = red("film.1.exr");
  folder_.write("film.0.exr", "mine");
  std::filesystem::remove(path("film.1.exr"));
  std::filesystem::remove(path("film.2.json")); // it was killed before this
  const Outcome more = run(sliding("--frames 0:3 -o film.#.exr --stats film.#.json"));
  ASSERT_EQ(more.exit_code, 0) << more.err;
  EXPECT_NE(more.err.find("2 frames in"), std::string::npos) << more.err;
  EXPECT_EQ(red("film.1.exr"), second);
  EXPECT_EQ(std::filesystem::file_size(path("film.0.exr")), 4u);
  EXPECT_TRUE(exists("film.2.json"));
  ASSERT_EQ(run(sliding("--frames 0:3:2 --overwrite -o film.#.exr")).exit_code, 0);
  EXPECT_GT(std::filesystem::file_size(path("film.0.exr")), 4u);
  EXPECT_NE(run(sliding("--frames 0:3 -o film.#.exr")).err.find("all 3 frames are there"), std::string::npos);
}

TEST_F(Sequence, HoldsTheSeedWhereAsked) {
  ASSERT_EQ(run(sliding("--frames 0:2 --seed 9 --seed-per-frame off -o f#.exr --stats f#.json -q")).exit_code, 0);
  EXPECT_EQ(stats("f0.json")["seed"], 9);
  EXPECT_EQ(stats("f1.json")["seed"], 9);
}

TEST_F(Sequence, ATurntableMovesTheCameraAndKeepsTheGeometry) {
  const std::string turn = fmt::format(
      "render {} --size 32x24 --spp 2 --max-depth 2 --turntable 360 --frames 0:4 -o t#.exr --stats t#.json", kBox);
  const Outcome outcome = run(turn);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(red("t0.exr"), red("t1.exr"));
  EXPECT_EQ(again("t1.json"), red("t1.exr"));
  EXPECT_GT(stats("t0.json")["frame"]["built_triangles"], 0);
  for (const char* name : {"t1.json", "t2.json", "t3.json"}) {
    const Json frame = stats(name)["frame"];
    EXPECT_EQ(frame["built_triangles"], 0) << name;
    EXPECT_EQ(frame["kept"], Json({"surfaces", "geometry"})) << name;
  }
  EXPECT_EQ(stats("t3.json")["frame"]["turned"], 270.0);
  const Outcome half = run(fmt::format( // the second half of the same film
      "render {} --size 32x24 --spp 2 --max-depth 2 --turntable 360 --frames 3:4 -o half.exr", kBox));
  ASSERT_EQ(half.exit_code, 0) << half.err;
  EXPECT_EQ(red("half.exr"), red("t3.exr"));
}

TEST_F(Sequence, CamerasOfTheFileMove) {
  GltfBuilder b;
  const int positions = b.floats("VEC3", {-1, 0, 0, 1, 0, 0, 0, 1, 0});
  const int mesh = b.mesh_node({{"POSITION", positions}});
  b.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"znear", 0.1}}}}};
  const int camera = b.add("nodes", {{"camera", 0}, {"translation", {0, 0, 3}}});
  const int times = b.floats("SCALAR", {0.0f, 1.0f}), places = b.floats("VEC3", {0, 0, 3, 2, 0, 3});
  b.add("animations", {{"samplers", {{{"input", times}, {"output", places}}}},
                       {"channels", {{{"sampler", 0}, {"target", {{"node", camera}, {"path", "translation"}}}}}}});
  b.root["scenes"] = {{{"nodes", {mesh, camera}}}};
  b.root["scene"] = 0;
  const std::string scene = folder_.write("camera.glb", b.glb()).string();
  const Outcome outcome =
      run(fmt::format("render {} --env white --size 32x24 --spp 1 --animation 0 --fps 2 "
                      "--frames 0:3 --seed-per-frame off -o c#.exr --stats c#.json",
                      scene));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(red("c0.exr"), red("c1.exr"));
  EXPECT_EQ(again("c2.json"), red("c2.exr"));
  EXPECT_EQ(stats("c2.json")["frame"]["built_triangles"], 0);
}

TEST_F(Sequence, RefusesWhatCannotWork) {
  expect_refused(fmt::format("render {} --frames 0:3 -o a.#.exr", kBox), "nothing moves");
  expect_refused(sliding("--frames 0:3 -o a.exr"), "is one name for 3 frames");
  expect_refused(sliding("--frames 0:3 -o a.#.exr --stats a.json"), "a.json: is one name for 3 frames");
  expect_refused(sliding("--frames 0:3 -o a.#.exr --checkpoint state"), "state: is one name for 3 frames");
  expect_refused(sliding("--frames 3:3 -o a.#.exr"), "holds no frame");
  expect_refused(sliding("--frames 3 -o a.#.exr"), "0:24");
  expect_refused(sliding("--frames 0:4:0 -o a.#.exr"), "--frames");
  expect_refused(sliding("--frames 0:3 -o a.#.exr -o a.%d.exr"), "is written twice");
  expect_refused(sliding("-o a.exr"), "--fps: means nothing for one picture");
  expect_refused(sliding("--frames 0:3 -o a.#.exr --pixel 1,1 --sample 0"), "--pixel");
  EXPECT_FALSE(exists("a.0.exr"));
}

// Files of a frame are written while the next one is rendered, one frame after the other.
TEST_F(Sequence, FramesAppearAndAreToldInTheirOrder) {
  const Outcome outcome = run(sliding("--frames 0:4 -o o#.exr -o o#.png --stats o#.json --json"));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  std::size_t told = 0, document = 0;
  for (int frame = 0; frame < 4; ++frame) {
    const std::string name = fmt::format("o{}.exr, o{}.png", frame, frame);
    told = outcome.err.find(name, told);
    ASSERT_NE(told, std::string::npos) << name << " in " << outcome.err;
    document = outcome.out.find(fmt::format("\"number\": {}", frame), document);
    ASSERT_NE(document, std::string::npos) << frame << " in " << outcome.out;
    EXPECT_GT(stats(fmt::format("o{}.json", frame))["seconds"]["write"], 0.0);
    if (frame == 0) continue;
    const auto written = [&](int number, const char* extension) {
      return std::filesystem::last_write_time(path(fmt::format("o{}.{}", number, extension)));
    };
    EXPECT_LE(written(frame - 1, "json"), written(frame, "exr")) << frame;
    EXPECT_LE(written(frame, "exr"), written(frame, "json")) << frame;
  }
  EXPECT_GT(outcome.err.find("4 frames in "), told);
}

// The frame in progress is dropped: what follows a frame that could not be written is not there.
TEST_F(Sequence, AFrameThatCannotBeWrittenEndsTheFilm) {
  std::filesystem::create_symlink("/dev/full", path("n1.png"));
  const Outcome outcome = run(sliding("--frames 0:6 --overwrite -o n#.png"));
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  EXPECT_NE(outcome.err.find("wavepath: error: n1.png"), std::string::npos) << outcome.err;
  EXPECT_TRUE(exists("n0.png"));
  for (const char* later : {"n2.png", "n3.png", "n5.png"}) EXPECT_FALSE(exists(later)) << later;
}

TEST_F(Sequence, AnInterruptLeavesWholeFrames) {
  const std::string film = fmt::format(
      "render {} --size 64x48 --spp 64 --max-depth 2 --animation slide --fps 4 --frames 0:4 -o i#.exr", lamps_);
  const Outcome outcome = run(film, {.signal_after = "i0.exr", .signal = SIGINT});
  EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
  EXPECT_TRUE(exists("i0.exr"));
  EXPECT_FALSE(exists("i3.exr"));
  const std::vector<float> first = red("i0.exr");
  const Outcome rest = run(film); // goes on where it was
  EXPECT_EQ(rest.exit_code, 0) << rest.err;
  EXPECT_EQ(red("i0.exr"), first);
  EXPECT_TRUE(exists("i3.exr"));
}

} // namespace
} // namespace wavepath::test
