// Stopping, splitting and joining renders as a user does: whatever happens in between, the bits are those of one
// render.
#include <bit>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <glm/glm.hpp>
#include <nlohmann/json.hpp>

#include "host/base/error.h"
#include "host/film/error.h"
#include "host/film/film.h"
#include "host/picture/files/picture_io.h"
#include "host/render/render.h"
#include "host/render/report/state_file.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/scene/gltf/gltf.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"
#include "tests/plan_in_stats.h"
#include "tests/run_wavepath.h"
#include "tests/small_disk.h"
#include "tests/temporary_folder.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {
namespace {

const std::string kCornell = std::string(WAVEPATH_SOURCE_DIR) + "/scenes/cornell_box.gltf";

class Resume : public ProgramTest {
protected:
  Outcome wavepath(std::vector<std::string> arguments, RunOptions options = {}) {
    arguments.insert(arguments.begin(), WAVEPATH_BINARY);
    options.folder = folder_.path().string();
    return run_program(arguments, options);
  }
  // Renders the Cornell box; the flags at the end count.
  Outcome render(const std::string& output, std::vector<std::string> flags, const RunOptions& options = {}) {
    std::vector<std::string> all{"render", kCornell, "--size", "64x48", "--spp", "48", "-q", "-o", output};
    all.insert(all.end(), flags.begin(), flags.end());
    return wavepath(all, options);
  }
  // Without pilots of --reuse auto: renders that end early have none and go on so, and pilots submit work, too.
  Outcome render_apart(const std::string& output, std::vector<std::string> flags, const RunOptions& options = {}) {
    flags.insert(flags.begin(), {"--reuse", "off"});
    return render(output, flags, options);
  }
  std::string path(const std::string& name) const { return folder_.file(name); }
  void expect_same_bits(const std::string& a, const std::string& b) {
    const Picture first = read_picture(path(a)), second = read_picture(path(b));
    ASSERT_EQ(first.channels.size(), second.channels.size());
    for (std::size_t c = 0; c < first.channels.size(); ++c)
      EXPECT_EQ(first.channels[c].values, second.channels[c].values) << first.channels[c].name;
  }
  std::string bytes(const std::string& name) const {
    std::ifstream file(path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  TemporaryFolder folder_;
};

// The filtered picture is made from the sums: of a resumed render it has the same bits, and parts that are joined are
// filtered anew. Their first hits join to within rounding.
TEST_F(Resume, FilteredPicturesFollowTheSums) {
  ASSERT_EQ(render_apart("whole.exr", {"--denoise"}).exit_code, 0);
  ASSERT_EQ(render_apart("part.exr", {"--denoise", "--spp", "20", "--checkpoint", "state"}).exit_code, 0);
  ASSERT_EQ(render_apart("part.exr", {"--denoise", "--checkpoint", "state", "--resume"}).exit_code, 0);
  expect_same_bits("part.exr", "whole.exr");

  ASSERT_EQ(render_apart("a.exr", {"--denoise", "--samples", "0:20"}).exit_code, 0);
  ASSERT_EQ(render_apart("b.exr", {"--denoise", "--samples", "20:48"}).exit_code, 0);
  ASSERT_EQ(wavepath({"merge", "a.exr", "b.exr", "-o", "joined.exr", "-q"}).exit_code, 0);
  const Picture joined = read_picture(path("joined.exr")), whole = read_picture(path("whole.exr"));
  for (const char* name : {"R", "G", "B"})
    EXPECT_EQ(find_channel(joined, name)->values, find_channel(whole, name)->values) << name;
  const Channel *ours = find_channel(joined, "denoised.G"), *theirs = find_channel(whole, "denoised.G");
  ASSERT_TRUE(ours && theirs);
  for (std::size_t i = 0; i < ours->values.size(); ++i)
    EXPECT_NEAR(ours->values[i], theirs->values[i], 1e-3f * (0.1f + theirs->values[i])) << i;
}

TEST_F(Resume, SurvivesBeingKilledAtAnyMoment) {
  const std::vector<std::string> flags{"--aov", "albedo,depth,variance,samples"};
  const auto began = std::chrono::steady_clock::now();
  ASSERT_EQ(render("whole.exr", flags).exit_code, 0);
  const std::chrono::duration<double> whole = std::chrono::steady_clock::now() - began;
  const std::vector<std::string> resumed{
      "--aov", "albedo,depth,variance,samples", "--checkpoint", "state", "--checkpoint-interval", "0", "--resume"};
  std::mt19937 random(1);
  std::uniform_real_distribution<double> moment(0.0, 1.5 * whole.count()); // seconds
  int killed = 0, with_state = 0;
  // More often where the machine grew busy after the whole was timed, so that most are killed before they have saved
  // anything.
  for (int i = 0; i < 12 || (i < 100 && (killed <= 5 || with_state <= 5)); ++i) {
    std::vector<std::string> arguments{"/usr/bin/timeout",
                                       "-s",
                                       "KILL",
                                       fmt::format("{:.3f}", moment(random)),
                                       WAVEPATH_BINARY,
                                       "render",
                                       kCornell,
                                       "--size",
                                       "64x48",
                                       "--spp",
                                       "48",
                                       "-q",
                                       "-o",
                                       "part.exr"};
    arguments.insert(arguments.end(), resumed.begin(), resumed.end());
    RunOptions options;
    options.folder = folder_.path().string();
    const Outcome outcome = run_program(arguments, options);
    const bool was_killed = outcome.exit_code == 128 + SIGKILL;
    killed += was_killed;
    with_state += std::filesystem::exists(path("state"));
    if (was_killed) continue;
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    expect_same_bits("part.exr", "whole.exr");
    std::filesystem::remove(path("state")); // and again from the beginning
  }
  EXPECT_GT(killed, 5);
  EXPECT_GT(with_state, 5);
  ASSERT_EQ(render("part.exr", resumed).exit_code, 0);
  expect_same_bits("part.exr", "whole.exr");
}

TEST_F(Resume, GoesOnAfterAnInterruptAndBeyondTheEnd) {
  for (const char* reuse : {"off", "on"}) {
    SCOPED_TRACE(reuse);
    const auto go = [&](const std::string& output, std::vector<std::string> flags) {
      flags.insert(flags.begin(), {"--reuse", reuse});
      const Outcome outcome = render(output, flags);
      ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    };
    std::filesystem::remove(path("state"));
    go("whole.exr", {});
    go("part.exr", {"--checkpoint", "state", "--spp", "20", "--time", "0.05"});
    go("part.exr", {"--checkpoint", "state", "--resume", "--spp", "20"});
    go("part.exr", {"--checkpoint", "state", "--resume"});
    expect_same_bits("part.exr", "whole.exr");
    // The same again from the finished state renders nothing more.
    go("again.exr", {"--checkpoint", "state", "--resume"});
    expect_same_bits("again.exr", "whole.exr");
  }
}

// What the last estimate held is written, with one line that says so, and a resumed render makes up for the rest.
TEST_F(Resume, ALostDeviceLosesLittle) {
  RunOptions lost;
  lost.in_child = [] { setenv("WAVEPATH_LOSE_DEVICE", "10", 1); };
  ASSERT_EQ(render_apart("whole.exr", {}).exit_code, 0);
  const Outcome outcome = render_apart("part.exr", {"--checkpoint", "state", "--stats", "part.json"}, lost);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("was lost while rendering"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("--resume"), std::string::npos) << outcome.err;
  const std::uint32_t samples = nlohmann::json::parse(bytes("part.json"))["spp"];
  EXPECT_GE(samples, 2u);
  EXPECT_LT(samples, 48u);
  ASSERT_EQ(render_apart("short.exr", {"--spp", std::to_string(samples)}).exit_code, 0);
  expect_same_bits("part.exr", "short.exr");
  ASSERT_EQ(render_apart("part.exr", {"--checkpoint", "state", "--resume"}).exit_code, 0);
  expect_same_bits("part.exr", "whole.exr");
}

// A state that was saved after the last estimate is not replaced by that one.
TEST_F(Resume, ALostDeviceKeepsTheNewerState) {
  const std::vector<std::string> long_passes{"--size", "256x192", "--spp", "24", "--adaptive", "off", "--reuse", "off"};
  const auto with = [&](std::vector<std::string> flags) {
    flags.insert(flags.end(), long_passes.begin(), long_passes.end());
    return flags;
  };
  ASSERT_EQ(render("whole.exr", long_passes).exit_code, 0);
  bool newer = false;
  for (int submissions = 12; submissions < 20 && !newer; ++submissions) {
    std::filesystem::remove(path("state"));
    RunOptions lost;
    lost.in_child = [=] { setenv("WAVEPATH_LOSE_DEVICE", std::to_string(submissions).c_str(), 1); };
    ASSERT_EQ(
        render("part.exr", with({"--checkpoint", "state", "--checkpoint-interval", "0", "--stats", "part.json"}), lost)
            .exit_code,
        1);
    const std::uint32_t shown = nlohmann::json::parse(bytes("part.json"))["spp"];
    newer = read_state(path("state")).state.cursor.sample > shown;
  }
  EXPECT_TRUE(newer);
  ASSERT_EQ(render("part.exr", with({"--checkpoint", "state", "--resume"})).exit_code, 0);
  expect_same_bits("part.exr", "whole.exr");
}

// What is measured after the last sample is not worth the picture.
TEST_F(Resume, ADeviceThatIsLostAfterwardsLosesNothing) {
  ASSERT_EQ(render("whole.exr", {}).exit_code, 0);
  bool lost_afterwards = false;
  for (int submissions = 12; submissions < 24 && !lost_afterwards; ++submissions) {
    RunOptions lost;
    lost.in_child = [=] { setenv("WAVEPATH_LOSE_DEVICE", std::to_string(submissions).c_str(), 1); };
    const Outcome outcome = render("part.exr", {"--stats", "part.json"}, lost);
    if (outcome.exit_code != 0) continue;
    lost_afterwards = outcome.err.find("lost after the last sample") != std::string::npos;
    expect_same_bits("part.exr", "whole.exr");
  }
  EXPECT_TRUE(lost_afterwards);
}

// There is nothing to write yet.
TEST_F(Resume, ADeviceThatIsLostAtOnceIsAnError) {
  RunOptions lost;
  lost.in_child = [] { setenv("WAVEPATH_LOSE_DEVICE", "3", 1); };
  const Outcome outcome = render("part.exr", {}, lost);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("device lost"), std::string::npos) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(path("part.exr")));
}

TEST_F(Resume, KeepsAdaptiveLevels) {
  ASSERT_EQ(render_apart("whole.exr", {"--adaptive", "--time", "1000"}).exit_code,
            0); // with a pilot as short as the part's
  ASSERT_EQ(render_apart("part.exr", {"--adaptive", "--checkpoint", "state", "--time", "0.1"}).exit_code, 0);
  ASSERT_EQ(render_apart("part.exr", {"--adaptive", "--checkpoint", "state", "--resume"}).exit_code, 0);
  expect_same_bits("part.exr", "whole.exr");
}

// Levels that auto chose last as long as the state, whatever is asked for later.
TEST_F(Resume, KeepsTheLevelsThatAutoChose) {
  const auto go_on = [&](std::vector<std::string> flags) {
    flags.insert(flags.end(), {"--size", "256x128", "--max-depth", "1", "--checkpoint", "state"});
    return render("part.exr", flags);
  };
  ASSERT_EQ(go_on({"--spp", "64"}).exit_code, 0);
  for (int i = 0; i < 2; ++i) { // 70 is no multiple of four; the second time all of it is there
    const Outcome outcome = go_on({"--spp", "70", "--resume", "--stats", path("stats.json")});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const auto stats = nlohmann::json::parse(std::ifstream(path("stats.json")));
    EXPECT_EQ(decision_in(stats, "adaptive")["taken"], "on");
  }
  const std::string before = bytes("state");
  const Outcome merged = go_on({"--spp", "128", "--resume", "--mergeable"});
  EXPECT_EQ(merged.exit_code, 1);
  EXPECT_NE(merged.err.find("cannot be merged"), std::string::npos) << merged.err;
  EXPECT_EQ(bytes("state"), before);
}

// A disk that takes the picture but no state: the render goes on, says so, and the old state stays whole.
TEST_F(Resume, FullDiskLosesNothing) {
  SmallDisk disk(folder_.path());
  ASSERT_EQ(render_apart("whole.exr", {}).exit_code, 0);
  ASSERT_EQ(render_apart("part.exr", {"--checkpoint", "state", "--time", "0.05"}).exit_code, 0);
  const std::string before = bytes("state");
  disk.leave(200000); // the state has 393,000 and more, the picture half of that
  const Outcome outcome =
      render_apart("part.exr", {"--checkpoint", "state", "--resume", "--checkpoint-interval", "0"}, disk.options());
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_NE(outcome.err.find("state"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("the render goes on"), std::string::npos) << outcome.err;
  expect_same_bits("part.exr", "whole.exr");
  EXPECT_EQ(bytes("state"), before);
}

TEST_F(Resume, RefusesWhatIsNotItsOwn) {
  ASSERT_EQ(render("part.exr", {"--checkpoint", "state", "--spp", "8"}).exit_code, 0);
  const std::string good = bytes("state");
  const auto refused = [&](std::vector<std::string> flags, const std::string& words, int code = 1) {
    flags.insert(flags.begin(), {"--checkpoint", "state", "--resume"});
    const Outcome outcome = render("x.exr", flags);
    EXPECT_EQ(outcome.exit_code, code) << words;
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(path("x.exr")));
    EXPECT_EQ(bytes("state"), good) << "the state was touched";
  };
  refused({"--seed", "3"}, "seed is 3, not 0");
  refused({"--max-depth", "3"}, "max-depth is 3, not 8");
  refused({"--size", "32x32"}, "size is 32x32, not 64x48");
  refused({"--yfov", "30"}, "the camera is another");
  refused({"--env", "1,1,1"}, "the scene is another");
  refused({"--env", "studio"}, "the scene is another");
  refused({"--ground"}, "the scene is another");
  refused({"--adaptive"}, "adaptive is on, not off");
  refused({"--spp", "4"}, "already holds samples up to 8, beyond 4");
  const Outcome unasked = render("x.exr", {"--checkpoint", "state"});
  EXPECT_EQ(unasked.exit_code, 2);
  EXPECT_NE(unasked.err.find("add --resume"), std::string::npos) << unasked.err;

  for (const std::size_t size : {std::size_t{0}, std::size_t{10}, std::size_t{100}, good.size() / 2, good.size() - 1}) {
    std::ofstream(path("state"), std::ios::binary) << good.substr(0, size);
    EXPECT_THROW(read_state(path("state")), Error) << size;
  }
  const Outcome cut = render("x.exr", {"--checkpoint", "state", "--resume"});
  EXPECT_EQ(cut.exit_code, 1);
  EXPECT_NE(cut.err.find("wavepath: error: state: "), std::string::npos) << cut.err;
  std::string damaged = good;
  damaged[damaged.size() - 1000] ^= 1;
  std::ofstream(path("state"), std::ios::binary) << damaged;
  const Outcome outcome = render("x.exr", {"--checkpoint", "state", "--resume"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("checksum"), std::string::npos) << outcome.err;
}

// The samples before a range, or those of it that are left out, would count twice once the parts are merged.
TEST_F(Resume, RefusesAnotherRangeThanItBeganWith) {
  ASSERT_EQ(render("part.exr", {"--checkpoint", "state", "--samples", "4:8"}).exit_code, 0);
  const auto refused = [&](const std::string& samples, const std::string& words) {
    const Outcome outcome = render("x.exr", {"--checkpoint", "state", "--resume", "--samples", samples});
    EXPECT_EQ(outcome.exit_code, 1) << samples;
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
  };
  refused("0:8", "begins at sample 4, not 0");
  refused("6:12", "begins at sample 4, not 6");
  refused("4:6", "already holds samples up to 8, beyond 6");
  ASSERT_EQ(render("part.exr", {"--checkpoint", "state", "--resume", "--samples", "4:12"}).exit_code, 0);
  EXPECT_EQ(read_attribute(path("part.exr"), "wavepath.samples"), "4:12");
}

// A pass gives all pixels the same samples; a state saved within one cannot end before the pass does.
TEST_F(Resume, RefusesAnEndWithinThePassInProgress) {
  ASSERT_EQ(render("part.exr", {"--checkpoint", "state", "--spp", "8"}).exit_code, 0);
  StateRecord record = read_state(path("state"));
  record.state.cursor = {4, 4, 0, 100};
  write_state(path("state"), record.identity, record.device, record.plan, record.state);
  const Outcome outcome = render("x.exr", {"--checkpoint", "state", "--resume", "--spp", "6"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("already holds samples up to 8, beyond 6; ask for 8"), std::string::npos) << outcome.err;
}

// Light selection is trained for as long as the render was to be when it began.
TEST_F(Resume, KeepsTheTrainingOfLights) {
  const auto training_paths = [&](std::vector<std::string> flags) {
    flags.insert(flags.end(), {"--env", "studio", "--stats", path("stats.json")});
    const Outcome outcome = render("part.exr", flags);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return nlohmann::json::parse(std::ifstream(path("stats.json")))["light_selection"]["sky"]["pilot_paths"]
        .get<std::uint64_t>();
  };
  const std::uint64_t of_short = training_paths({"--spp", "12", "--checkpoint", "state"});
  std::filesystem::copy_file(path("state"), path("state2"));
  EXPECT_EQ(training_paths({"--checkpoint", "state", "--resume"}), of_short);
  std::filesystem::rename(path("part.exr"), path("at_once.exr"));
  EXPECT_EQ(training_paths({"--spp", "25", "--checkpoint", "state2", "--resume"}), of_short);
  EXPECT_EQ(training_paths({"--checkpoint", "state2", "--resume"}), of_short);
  expect_same_bits("part.exr", "at_once.exr");
  EXPECT_GT(training_paths({}), of_short);
  const std::uint64_t timed = training_paths({"--time", "0.0002", "--checkpoint", "timed"}); // 20,000 paths of a GPU
  EXPECT_LT(timed, of_short);
  EXPECT_EQ(training_paths({"--checkpoint", "timed", "--resume"}), timed);
  EXPECT_EQ(training_paths({"--mergeable"}), 65536 / (64 * 48) * 64 * 48);
  EXPECT_EQ(training_paths({"--spp", "960", "--samples", "12:13"}), training_paths({"--mergeable"}));

  const Outcome merged = render("part.exr", {"--env", "studio", "--checkpoint", "state", "--resume", "--mergeable"});
  EXPECT_EQ(merged.exit_code, 1);
  EXPECT_NE(merged.err.find("cannot be merged"), std::string::npos) << merged.err;
}

// A path is traced with the trained probabilities of its render, also of one that was resumed.
TEST_F(Resume, ReplaysPathsOfRendersThatTrained) {
  const auto with = [&](std::vector<std::string> flags) {
    flags.insert(flags.end(), {"--env", "studio", "--filter", "box", "--integrator", "path"});
    return flags;
  };
  const auto expect_replayed = [&](int spp, std::vector<std::string> flags) {
    glm::dvec3 sum(0.0);
    for (int sample = 0; sample < spp; ++sample) {
      std::vector<std::string> all{
          "render", kCornell, "--size", "64x48", "--json", "--pixel", "30,40", "--sample", std::to_string(sample)};
      all.insert(all.end(), flags.begin(), flags.end());
      const Outcome outcome = wavepath(all);
      ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
      const auto radiance = nlohmann::json::parse(outcome.out)["radiance"];
      for (int c = 0; c < 3; ++c) sum[c] += radiance[c].get<double>();
    }
    const Picture picture = read_picture(path("picture.exr"));
    const char* names[] = {"R", "G", "B"};
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(find_channel(picture, names[c])->values[40 * 64 + 30], sum[c] / spp, 1e-5 * sum[c]) << spp;
  };
  ASSERT_EQ(render("picture.exr", with({"--spp", "1", "--checkpoint", "state"})).exit_code, 0);
  expect_replayed(1, with({"--spp", "1"}));
  const std::vector<std::string> longer = with({"--spp", "4", "--checkpoint", "state", "--resume"});
  ASSERT_EQ(render("picture.exr", longer).exit_code, 0);
  expect_replayed(4, longer);
}

// Parts train alike, whatever their length.
TEST_F(Resume, PartsThatTrainLightsJoinToTheWhole) {
  const std::vector<std::string> studio{"--env", "studio"};
  const auto with = [&](std::vector<std::string> flags) {
    flags.insert(flags.end(), studio.begin(), studio.end());
    return flags;
  };
  ASSERT_EQ(render("whole.exr", with({"--mergeable"})).exit_code, 0);
  ASSERT_EQ(render("a.exr", with({"--spp", "480", "--samples", "0:5"})).exit_code, 0); // what it tells is ignored
  ASSERT_EQ(render("b.exr", with({"--samples", "5:48"})).exit_code, 0);
  ASSERT_EQ(wavepath({"merge", "a.exr", "b.exr", "-o", "joined.exr", "-q"}).exit_code, 0);
  expect_same_bits("joined.exr", "whole.exr");
}

TEST_F(Resume, PartsJoinToTheWhole) {
  for (const std::string sampler : {"sobol", "stratified"}) {
    SCOPED_TRACE(sampler);
    const std::vector<std::string> all{"--sampler", sampler, "--aov", "variance,samples"};
    ASSERT_EQ(render("whole.exr", all).exit_code, 0);
    std::string parts[3] = {"0:5", "5:32", "32:48"}; // neither aligned nor even
    for (int i = 0; i < 3; ++i) {
      std::vector<std::string> flags = all;
      flags.insert(flags.end(), {"--samples", parts[i]});
      ASSERT_EQ(render(fmt::format("part{}.exr", i), flags).exit_code, 0);
    }
    ASSERT_EQ(wavepath({"merge", "part2.exr", "part0.exr", "-o", "two.exr"}).exit_code, 0);
    const Outcome merged = wavepath({"merge", "two.exr", "part1.exr", "-o", "merged.exr", "-o", "merged.png"});
    ASSERT_EQ(merged.exit_code, 0) << merged.err;
    expect_same_bits("merged.exr", "whole.exr");
    EXPECT_EQ(read_attribute(path("two.exr"), "wavepath.samples"), "0:5,32:48");
    EXPECT_EQ(read_attribute(path("merged.exr"), "wavepath.samples"), "0:48");
    EXPECT_EQ(read_number(path("merged.exr"), "wavepath.error"), read_number(path("whole.exr"), "wavepath.error"));
    EXPECT_EQ(read_matrix(path("merged.exr"), "worldToNDC"), read_matrix(path("whole.exr"), "worldToNDC"));
  }
}

// More samples would make auto choose anew, and otherwise: the file says what the render was begun as.
TEST_F(Resume, WhatAutoChoseIsKept) {
  const auto render_beam = [&](const char* spp, std::vector<std::string> more, const RunOptions& options = {}) {
    std::vector<std::string> all{"render",       std::string(WAVEPATH_SOURCE_DIR) + "/scenes/caustics/prism_spot.glb",
                                 "--integrator", "auto",
                                 "--size",       "16x12",
                                 "--max-depth",  "5",
                                 "--spp",        spp};
    all.insert(all.end(), more.begin(), more.end());
    return wavepath(all, options);
  };
  const Outcome begun = render_beam("4", {"-o", "part.exr", "--checkpoint", "state"});
  EXPECT_NE(begun.err.find("plan: integrator path"), std::string::npos) << begun.err;
  RunOptions until_planned; // its picture would cost more than all of this test
  until_planned.signal_after = "plan: integrator bidirectional";
  until_planned.signal = SIGKILL;
  const Outcome fresh = render_beam("6144", {"-o", "fresh.exr"}, until_planned);
  EXPECT_EQ(fresh.exit_code, 128 + SIGKILL) << fresh.err;
  const Outcome resumed = render_beam("6144", {"-o", "part.exr", "--checkpoint", "state", "--resume", "--mergeable"});
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_TRUE(read_film(path("part.exr"))->splats.empty()); // path tracing has none
}

// Light paths bring light to pixels of other waves, of other parts and of what was rendered before the interrupt.
TEST_F(Resume, LightPathsJoinToTheWhole) {
  const std::vector<std::string> all{"--integrator", "bidirectional", "--max-depth", "4", "--spp", "24"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), all.begin(), all.end());
    return more;
  };
  ASSERT_EQ(render("whole.exr", with({"--mergeable"})).exit_code, 0);
  ASSERT_FALSE(read_film(path("whole.exr"))->splats.empty());
  ASSERT_EQ(render("part.exr", with({"--checkpoint", "state", "--time", "0.05"})).exit_code, 0);
  ASSERT_EQ(render("part.exr", with({"--checkpoint", "state", "--resume", "--mergeable"})).exit_code, 0);
  expect_same_bits("part.exr", "whole.exr");
  EXPECT_TRUE(*read_film(path("part.exr")) == *read_film(path("whole.exr")));
  ASSERT_EQ(render("a.exr", with({"--samples", "0:5"})).exit_code, 0);
  ASSERT_EQ(render("b.exr", with({"--samples", "5:24"})).exit_code, 0);
  ASSERT_EQ(wavepath({"merge", "b.exr", "a.exr", "-o", "merged.exr"}).exit_code, 0);
  expect_same_bits("merged.exr", "whole.exr");
  EXPECT_TRUE(*read_film(path("merged.exr")) == *read_film(path("whole.exr")));
  EXPECT_EQ(read_number(path("merged.exr"), "wavepath.error"), read_number(path("whole.exr"), "wavepath.error"));
}

// Far from the origin floats are coarse: a place that is found by subtracting them is millimetres off.
TEST_F(Resume, MergedPositionsAreThoseOfTheWhole) {
  std::ifstream file(kCornell);
  nlohmann::json scene = nlohmann::json::parse(file);
  scene["nodes"].push_back({{"translation", {100000.3, 0.0, 0.0}}, {"children", scene["scenes"][0]["nodes"]}});
  scene["scenes"][0]["nodes"] = {scene["nodes"].size() - 1};
  std::ofstream(path("far.gltf")) << scene;
  const auto render_far = [&](const std::string& output, const std::string& samples) {
    return wavepath({"render", "far.gltf", "--size", "16x16", "--spp", "8", "--samples", samples, "-q", "--aov",
                     "position,depth", "-o", output})
        .exit_code;
  };
  ASSERT_EQ(render_far("whole.exr", "0:8") + render_far("a.exr", "0:3") + render_far("b.exr", "3:8"), 0);
  const Outcome merged = wavepath({"merge", "b.exr", "a.exr", "-o", "merged.exr"});
  ASSERT_EQ(merged.exit_code, 0) << merged.err;
  const std::optional<glm::dvec3> origin = read_vector(path("whole.exr"), "wavepath.origin");
  ASSERT_TRUE(origin);
  EXPECT_GT(origin->x, 1e5);
  EXPECT_EQ(read_vector(path("merged.exr"), "wavepath.origin"), origin);
  const Picture whole = read_picture(path("whole.exr")), joined = read_picture(path("merged.exr"));
  for (const char* name : {"P.X", "P.Y", "P.Z"})
    for (std::size_t i = 0; i < 256; ++i) {
      const float a = find_channel(whole, name)->values[i], b = find_channel(joined, name)->values[i];
      ASSERT_LE(std::abs(a - b), std::abs(std::nextafter(a, 2.0f * a) - a) + 1e-6f) << name << " of pixel " << i;
    }
}

TEST_F(Resume, MergeRefusesWhatDoesNotBelongTogether) {
  ASSERT_EQ(render("a.exr", {"--samples", "0:4"}).exit_code, 0);
  ASSERT_EQ(render("b.exr", {"--samples", "3:8"}).exit_code, 0);
  ASSERT_EQ(render("seed.exr", {"--samples", "4:8", "--seed", "1"}).exit_code, 0);
  ASSERT_EQ(render("size.exr", {"--samples", "4:8", "--size", "32x32"}).exit_code, 0);
  ASSERT_EQ(render("scene.exr", {"--samples", "4:8", "--env", "1,1,1"}).exit_code, 0);
  ASSERT_EQ(render("plain.exr", {"--spp", "2"}).exit_code, 0);
  const auto refused = [&](const std::string& other, const std::string& words, int code = 1) {
    const Outcome outcome = wavepath({"merge", "a.exr", other, "-o", "x.exr"});
    EXPECT_EQ(outcome.exit_code, code) << outcome.err;
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(path("x.exr")));
  };
  refused("b.exr", "holds samples 3:8");
  refused("a.exr", "some as well");
  refused("seed.exr", "seed is 1, not 0");
  refused("size.exr", "size is 32x32, not 64x48");
  refused("scene.exr", "the scene is another");
  refused("plain.exr", "holds no exact sums");
  refused("missing.exr", "does not exist");
  refused("picture.png", "does not exist");
  EXPECT_EQ(wavepath({"merge", "a.exr", "-o", "x.exr"}).exit_code, 2);
  EXPECT_EQ(wavepath({"merge", "a.exr", "b.exr"}).exit_code, 2);
}

// The lines of `parts`, as tasks of an array job on this machine; one is killed and started again.
TEST_F(Resume, PartsMakeTheWholePicture) {
  ASSERT_EQ(render("whole.exr", {"--mergeable", "--sampler", "sobol"}).exit_code, 0);
  const auto parts = [&](std::vector<std::string> flags) {
    std::vector<std::string> all{"parts", kCornell, "--size", "64x48", "--spp=48", "--sampler", "sobol", "-q"};
    all.insert(all.end(), flags.begin(), flags.end());
    return wavepath(all);
  };
  const std::string picture = path("a farm's/picture.exr");
  std::filesystem::create_directory(path("a farm's"));
  const Outcome printed =
      parts({"--count", "5", "-o", picture, "-o", path("small.png"), "--exposure", "2", "--stats", "s.json"});
  ASSERT_EQ(printed.exit_code, 0) << printed.err;
  EXPECT_EQ(std::ranges::count(printed.out, '\n'), 6);
  std::ofstream(path("job.txt")) << printed.out;
  const std::string script = std::string(WAVEPATH_SOURCE_DIR) + "/farm/slurm.sh";
  const auto run_line = [&](int line, double kill_after) {
    RunOptions options;
    options.folder = folder_.path().string();
    options.in_child = [line] {
      const std::string folder = std::filesystem::path(WAVEPATH_BINARY).parent_path().string();
      setenv("PATH", (folder + ":" + std::getenv("PATH")).c_str(), 1);
      setenv("SLURM_ARRAY_TASK_ID", std::to_string(line).c_str(), 1);
    };
    return run_program({"/usr/bin/timeout", "-s", "KILL", fmt::format("{}", kill_after), script, "--line", "job.txt"},
                       options);
  };
  run_line(2, 0.5);
  for (int line = 1; line <= 6; ++line) {
    const Outcome outcome = run_line(line, 600.0);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  const Picture whole = read_picture(path("whole.exr")), joined = read_picture(picture);
  for (const char* name : {"R", "G", "B"})
    EXPECT_EQ(find_channel(joined, name)->values, find_channel(whole, name)->values) << name;
  EXPECT_TRUE(std::filesystem::exists(path("small.png")));
  EXPECT_TRUE(std::filesystem::exists(path("a farm's/picture-part-00004.json")));

  const nlohmann::json document = nlohmann::json::parse(parts({"--count", "3", "--json", "--samples", "4:10"}).out);
  ASSERT_EQ(document["parts"].size(), 3u);
  EXPECT_NE(document["parts"][1].get<std::string>().find(" --samples 6:8 "), std::string::npos);
  EXPECT_NE(document["merge"].get<std::string>().find("cornell_box-part-00002.exr -o cornell_box.exr"),
            std::string::npos);
}

TEST_F(Resume, PartsRefuseWhatNoPartHas) {
  const auto refused = [&](std::vector<std::string> flags, const std::string& words) {
    flags.insert(flags.begin(), {"parts", kCornell, "--count", "4"});
    const Outcome outcome = wavepath(flags);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
  };
  refused({}, "--spp: is missing");
  refused({"--spp", "3"}, "asks for 4 parts of 3 samples");
  refused({"--spp", "8", "--samples", "6:9"}, "ends beyond --spp 8");
  refused({"--spp", "8", "--checkpoint", "a.state"}, "--checkpoint: is no flag of a part");
  refused({"--spp", "8", "--frames", "0:4", "--animation", "walk"}, "--frames: is no flag of a part");
  refused({"--spp", "8", "--adaptive"}, "--adaptive");
  refused({"--spp", "8", "--sampler", "sobl"}, "sobol");
}

TEST_F(Resume, UsageIsChecked) {
  EXPECT_EQ(render("x.exr", {"--resume"}).exit_code, 2);
  EXPECT_EQ(render("x.exr", {"--adaptive", "--samples", "0:4"}).exit_code, 2);
  EXPECT_EQ(render("x.exr", {"-o", "x.exr"}).exit_code, 2) << "the same output twice";
  EXPECT_EQ(render("x.exr", {"--checkpoint", "nowhere/state"}).exit_code, 1);
}

// Renders that end at a moment which no flag names.
class ResumedLoop : public VulkanTest {
protected:
  ResumedLoop() {
    settings_.width = settings_.height = 32;
    settings_.wave_slots = 4096; // many waves
  }
  RenderResult render(const RenderHooks& hooks = {}) {
    if (!kernels_) kernels_ = std::make_unique<KernelCompiler>(device()); // compiles each of them once
    const View view = resolve_view(scene_, {}, settings_.width, settings_.height);
    return wavepath::render(device(), packed_, view, settings_, hooks, *kernels_);
  }
  // The state of a render whose progress `goes_on` ends.
  RenderState interrupted(const ProgressCallback& goes_on) {
    std::optional<RenderState> state;
    RenderHooks hooks;
    hooks.progress = goes_on;
    hooks.save = [&](const RenderState& saved) { state = saved; };
    hooks.save_interval = 1e9; // at the end alone
    EXPECT_NE(render(hooks).stop, StopReason::samples);
    return state.value();
  }

  Scene scene_ = load_gltf(kCornell);
  PackedScene packed_ = pack(scene_);
  RenderPlan settings_;
  std::unique_ptr<KernelCompiler> kernels_;
};

// A GPU leaves out estimates that it would have to wait for, but those that decide.
TEST_F(ResumedLoop, EveryCheckpointIsToldAndThoseThatDecideAreEstimated) {
  settings_.integrator = find_integrator("path");
  settings_.adaptive = kAdaptiveOff;
  settings_.last_sample = 64;
  const auto estimated = [&](const RenderHooks& hooks) {
    const std::vector<Checkpoint> points = render(hooks).checkpoints;
    std::vector<std::uint32_t> samples;
    std::size_t estimates = 0;
    for (const Checkpoint& point : points) {
      samples.push_back(point.spp);
      estimates += has_estimate(point.spp, point.error);
    }
    EXPECT_EQ(samples, (std::vector<std::uint32_t>{1, 2, 4, 8, 16, 32, 64}));
    EXPECT_TRUE(has_estimate(points.back().spp, points.back().error));
    return estimates;
  };
  EXPECT_GE(estimated({}), device().info().type == "cpu" ? 6u : 2u); // two may be under way beside the last
  RenderHooks compares;
  compares.checkpoint = [](const Checkpoint&, const Picture&) {};
  EXPECT_EQ(estimated(compares), 6u);
  settings_.target_error = 1e-6;
  EXPECT_EQ(estimated({}), 6u);
}

TEST_F(ResumedLoop, AnInterruptedPilotLeavesNoTrace) {
  settings_.adaptive = kAdaptiveOn;
  settings_.width = settings_.height = 64; // waves remain when the second one is done
  settings_.wave_slots = 512;
  settings_.last_sample = 16;
  const RenderResult whole = render();
  int waves = 0;
  const RenderState state = interrupted([&](const Progress&) { return ++waves < 2; });
  ASSERT_EQ(state.cursor.sample + state.cursor.pass_samples, 0u) << "the pilot was over";
  RenderHooks hooks;
  hooks.resume = &state;
  const RenderResult resumed = render(hooks);
  EXPECT_TRUE(*resumed.film == *whole.film);
  EXPECT_EQ(resumed.spp, whole.spp);
}

// The film of the checkpoint is at hand then, but the pass has added to it.
TEST_F(ResumedLoop, InterruptedWithinThePassAfterACheckpointNoSampleIsLost) {
  settings_.last_sample = 16;
  settings_.wave_slots = 100; // many waves a pass
  const RenderResult whole = render();
  const RenderState state =
      interrupted([&](const Progress& now) { return now.spp_done < 8 || now.fraction < 8.5 / 16.0; });
  ASSERT_EQ(state.cursor.sample, 8u);
  ASSERT_GT(state.cursor.pixels_done, 0u);
  RenderHooks hooks;
  hooks.resume = &state;
  EXPECT_TRUE(*render(hooks).film == *whole.film);
}

// Where the error is looked at next is part of the state, so that the render ends where it would have ended.
TEST_F(ResumedLoop, InterruptedBeforeALookATargetIsReachedAtTheSameSample) {
  settings_.last_sample = 4096;
  settings_.target_error = 0.05;
  const RenderResult whole = render();
  ASSERT_EQ(whole.stop, StopReason::target_error);
  ASSERT_FALSE(std::has_single_bit(whole.spp)) << "found at a checkpoint, without a look between two";
  for (std::uint32_t end = std::bit_floor(whole.spp) - 2; end < whole.spp;
       end += 3) { // looks are due or pending at some
    SCOPED_TRACE(end);
    const RenderState state = interrupted([&](const Progress& now) { return now.spp_done < end; });
    RenderHooks hooks;
    hooks.resume = &state;
    const RenderResult resumed = render(hooks);
    EXPECT_EQ(resumed.stop, StopReason::target_error);
    EXPECT_EQ(resumed.spp, whole.spp);
    EXPECT_TRUE(*resumed.film == *whole.film);
  }
}

// Kernels that were made for an adaptive render are there, and do not serve an even one.
TEST_F(ResumedLoop, AnEvenRenderAfterAnAdaptiveOneIsTheSame) {
  settings_.last_sample = 8;
  const RenderResult expected = render();
  kernels_.reset();
  settings_.adaptive = kAdaptiveOn;
  render();
  settings_.adaptive = kAdaptiveOff;
  EXPECT_TRUE(*render().film == *expected.film);
}

} // namespace
} // namespace wavepath::test
