// One picture by several devices: the bits of one, whatever the fractions, and whoever gets lost.
#include <algorithm>
#include <fstream>
#include <numeric>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/picture/files/picture_io.h"
#include "host/render/multi_device/deal.h"
#include "tests/run_wavepath.h"
#include "tests/temporary_folder.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {
namespace {

using Json = nlohmann::json;

TEST(Deal, PartsAddUp) {
  for (const std::vector<double>& speeds :
       {std::vector<double>{1.0}, {1.0, 1.0}, {1.0, 3.0}, {1e-9, 1.0, 1e9}, {0.0, 2.0}, {0.1, 0.1, 0.1}})
    for (const std::uint32_t count : {0u, 1u, 2u, 7u, 64u, 65536u}) {
      const auto fractions = deal(count, speeds);
      ASSERT_EQ(fractions.size(), speeds.size());
      EXPECT_EQ(std::accumulate(fractions.begin(), fractions.end(), 0u), count);
      for (std::size_t i = 0; i < speeds.size(); ++i) {
        const double exact = count * speeds[i] / std::accumulate(speeds.begin(), speeds.end(), 0.0);
        EXPECT_NEAR(fractions[i], exact, 1.0);
      }
    }
  EXPECT_EQ(deal(8, std::vector<double>{1.0, 3.0}), (std::vector<std::uint32_t>{2, 6}));
}

// Two logical devices of the one that there is stand for two.
class Devices : public ProgramTest {
protected:
  Outcome render(const std::string& output, std::vector<std::string> flags, const char* lose = nullptr) {
    std::vector<std::string> all{WAVEPATH_BINARY,
                                 "render",
                                 WAVEPATH_SOURCE_DIR "/scenes/cornell_box.gltf",
                                 "--size",
                                 "64x48",
                                 "--spp",
                                 "24",
                                 "-q",
                                 "-o",
                                 path(output)};
    all.insert(all.end(), flags.begin(), flags.end());
    RunOptions options;
    options.folder = folder_.path().string();
    if (lose) options.in_child = [lose] { setenv("WAVEPATH_LOSE_DEVICE", lose, 1); };
    return run_program(all, options);
  }
  void expect_same_bits(const std::string& a, const std::string& b) const {
    const Picture first = read_picture(path(a)), second = read_picture(path(b));
    ASSERT_EQ(first.channels.size(), second.channels.size());
    for (std::size_t c = 0; c < first.channels.size(); ++c)
      EXPECT_EQ(first.channels[c].values, second.channels[c].values) << first.channels[c].name;
  }
  Json fractions(const std::string& stats) const {
    std::ifstream file(path(stats));
    return Json::parse(file)["devices"];
  }
  std::string path(const std::string& name) const { return folder_.file(name); }

private:
  TemporaryFolder folder_;
};

// All samples, none twice.
void expect_whole(const Json& devices, std::uint32_t samples) {
  std::vector<int> times(samples);
  for (const Json& fraction : devices["shares"])
    for (const Json& range : fraction["ranges"])
      for (std::uint32_t s = range[0]; s < range[1]; ++s) ++times.at(s);
  EXPECT_EQ(times, std::vector<int>(samples, 1));
}

TEST_F(Devices, TwoHaveTheBitsOfOne) {
  for (const char* integrator : {"path", "bidirectional", "hybrid"}) {
    SCOPED_TRACE(integrator);
    ASSERT_EQ(render("one.exr", {"--integrator", integrator}).exit_code, 0);
    const Outcome outcome = render("two.exr", {"--integrator", integrator, "--devices", "0,0", "--stats", "two.json"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.err.find("validation:"), std::string::npos) << outcome.err;
    expect_same_bits("two.exr", "one.exr");
    const Json devices = fractions("two.json");
    EXPECT_TRUE(devices["bits_agree"]);
    ASSERT_EQ(devices["shares"].size(), 2u);
    expect_whole(devices, 24);
    for (const Json& fraction : devices["shares"]) EXPECT_GT(fraction["samples"], 0);
  }
}

TEST_F(Devices, PartsAndPicturesOfSeveralMerge) {
  ASSERT_EQ(render("whole.exr", {"--integrator", "path"}).exit_code, 0);
  ASSERT_EQ(render("a.exr", {"--integrator", "path", "--samples", "0:9", "--devices", "0,0"}).exit_code, 0);
  ASSERT_EQ(render("b.exr", {"--integrator", "path", "--samples", "9:24"}).exit_code, 0);
  ASSERT_EQ(
      run_program({WAVEPATH_BINARY, "merge", path("a.exr"), path("b.exr"), "-o", path("joined.exr"), "-q"}).exit_code,
      0);
  const Picture whole = read_picture(path("whole.exr")), joined = read_picture(path("joined.exr"));
  for (const char* name : {"R", "G", "B"})
    EXPECT_EQ(find_channel(joined, name)->values, find_channel(whole, name)->values) << name;
}

// Whenever it happens: while the pilot is rendered, or in any round.
TEST_F(Devices, TheOthersTakeOverFromOneThatIsLost) {
  ASSERT_EQ(render("one.exr", {"--integrator", "path"}).exit_code, 0);
  bool in_probe = false, with_samples = false;
  for (const char* lose : {"3@1", "12@1", "16@1", "20@1", "24@1", "14@0"}) {
    SCOPED_TRACE(lose);
    const Outcome outcome =
        render("two.exr", {"--integrator", "path", "--devices", "0,0", "--stats", "two.json"}, lose);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    expect_same_bits("two.exr", "one.exr");
    const Json devices = fractions("two.json");
    expect_whole(devices, 24);
    const Json& lost = devices["shares"][std::string(lose).back() - '0'];
    if (!lost["lost"]) continue; // it was done before
    EXPECT_NE(outcome.err.find("was lost while rendering"), std::string::npos) << outcome.err;
    (lost["samples"] == 0 ? in_probe : with_samples) = true;
  }
  EXPECT_TRUE(in_probe);
  EXPECT_TRUE(with_samples);
}

TEST_F(Devices, NoneLeftIsAnError) {
  const Outcome outcome = render("two.exr", {"--integrator", "path", "--devices", "0,0"}, "3");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("device lost"), std::string::npos) << outcome.err;
}

TEST_F(Devices, ATargetEndsThem) {
  const Outcome outcome = render("two.exr", {"--integrator", "path", "--devices", "0,0", "--spp", "4096",
                                             "--target-error", "0.2", "--stats", "two.json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  std::uint32_t samples = 0;
  const Json devices = fractions("two.json");
  for (const Json& fraction : devices["shares"]) samples += fraction["samples"].get<std::uint32_t>();
  EXPECT_LT(samples, 4096u);
}

// A render that time ends may leave out samples between others, of which a part cannot tell. It does not each time.
TEST_F(Devices, APictureWithHolesIsNoPart) {
  const std::string total = "60000";
  ASSERT_EQ(render("other.exr", {"--integrator", "path", "--reuse", "off", "--spp", total, "--samples", "59999:60000"})
                .exit_code,
            0);
  for (const char* seconds : {"0.4", "0.6", "0.8", "1.0"}) {
    SCOPED_TRACE(seconds);
    const Outcome outcome = render("two.exr", {"--integrator", "path", "--reuse", "off", "--devices", "0,0", "--spp",
                                               total, "--time", seconds, "--mergeable", "--stats", "two.json"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> ranges;
    const Json devices = fractions("two.json");
    for (const Json& fraction : devices["shares"])
      for (const Json& range : fraction["ranges"])
        if (range[0] != range[1]) ranges.emplace_back(range[0], range[1]);
    std::ranges::sort(ranges);
    bool holes = false;
    for (std::size_t i = 1; i < ranges.size(); ++i) holes |= ranges[i].first > ranges[i - 1].second;
    EXPECT_EQ(outcome.err.find("cannot be merged") != std::string::npos, holes) << outcome.err;
    const Outcome merged =
        run_program({WAVEPATH_BINARY, "merge", path("two.exr"), path("other.exr"), "-o", path("joined.exr"), "-q"});
    EXPECT_EQ(merged.exit_code, holes ? 1 : 0) << merged.err;
  }
}

TEST_F(Devices, WhatCannotBeSplitIsRefused) {
  for (const std::vector<std::string>& flags : {std::vector<std::string>{"--device", "0"},
                                                {"--checkpoint", path("state")},
                                                {"--adaptive", "--integrator", "path"},
                                                {"--denoise", "--integrator", "hybrid"}}) {
    SCOPED_TRACE(flags.front());
    std::vector<std::string> all{"--devices", "0,0"};
    all.insert(all.end(), flags.begin(), flags.end());
    const Outcome outcome = render("two.exr", all);
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_NE(outcome.err.find("--devices"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find(flags.front()), std::string::npos) << outcome.err;
  }
  EXPECT_EQ(render("two.exr", {"--devices", ","}).exit_code, 2);
  EXPECT_EQ(render("two.exr", {"--devices", "0,no such device"}).exit_code, 1);
  EXPECT_EQ(render("all.exr", {"--devices", "all"}).exit_code, 0);
}

} // namespace
} // namespace wavepath::test
