// What tev is shown, and what happens where there is none.
#include "host/picture/tev.h"

#include <numeric>
#include <utility>

#include <gtest/gtest.h>

#include "host/base/clock.h"
#include "host/base/error.h"
#include "tests/fake_tev.h"

namespace wavepath::test {
namespace {

Picture picture_of(std::uint32_t width, std::uint32_t height, float first) {
  Picture picture{width, height, {}};
  for (const char* name : {"R", "G", "B", "A", "albedo.R"}) {
    Channel& channel = picture.channels.emplace_back(Channel{name, std::vector<float>(width * height)});
    std::iota(channel.values.begin(), channel.values.end(), first += 0.25f);
  }
  return picture;
}

void expect_same(const Picture& shown, const Picture& expected) {
  ASSERT_EQ(shown.width, expected.width);
  ASSERT_EQ(shown.height, expected.height);
  ASSERT_EQ(shown.channels.size(), expected.channels.size());
  for (std::size_t i = 0; i < expected.channels.size(); ++i) {
    EXPECT_EQ(shown.channels[i].name, expected.channels[i].name);
    EXPECT_EQ(shown.channels[i].values, expected.channels[i].values) << expected.channels[i].name;
  }
}

TEST(Tev, ShowsEveryChannelAndWhatChanges) {
  FakeTev tev;
  const Picture first = picture_of(7, 5, 0.0f), last = picture_of(7, 5, 1000.0f);
  {
    TevViewer viewer(tev.address());
    for (const auto& [name, picture] : {std::pair{"a.exr", &first}, {"a.exr", &last}, {"b.exr", &first}}) {
      EXPECT_TRUE(viewer.show(name, *picture));
      EXPECT_TRUE(viewer.finish());
    }
  }
  tev.wait();
  EXPECT_EQ(tev.packets, 5) << "two images are made, and three pictures sent";
  ASSERT_EQ(tev.images.size(), 2u);
  expect_same(tev.images["a.exr"], last);
  expect_same(tev.images["b.exr"], first);
}

// The last picture of a render may have passes that those before it lacked.
TEST(Tev, MakesAnImageAnewForMoreChannels) {
  FakeTev tev;
  const Picture first = picture_of(16, 8, 1.0f);
  Picture last = picture_of(16, 8, 2.0f);
  last.channels.push_back({"id.node", std::vector<float>(16 * 8, 3.0f)});
  {
    TevViewer viewer(tev.address());
    for (const Picture* picture : {&first, static_cast<const Picture*>(&last)}) {
      EXPECT_TRUE(viewer.show("a.exr", *picture));
      EXPECT_TRUE(viewer.finish());
    }
  }
  tev.wait();
  EXPECT_EQ(tev.packets, 4) << "the image is made twice, and a picture sent for each";
  expect_same(tev.images["a.exr"], last);
}

// A packet is of a few MiB at most.
TEST(Tev, CutsLargePictures) {
  FakeTev tev;
  const Picture large = picture_of(1000, 517, 0.0f);
  {
    TevViewer viewer(tev.address());
    EXPECT_TRUE(viewer.show("large", large));
    EXPECT_TRUE(viewer.finish());
  }
  tev.wait();
  EXPECT_EQ(tev.packets, 1 + 3);
  EXPECT_EQ(tev.pictures, 1);
  expect_same(tev.images["large"], large);
}

TEST(Tev, SaysOnceThatTheViewerIsGone) {
  FakeTev tev(1);
  TevViewer viewer(tev.address());
  const Picture picture = picture_of(64, 64, 0.0f);
  EXPECT_TRUE(viewer.show("a", picture));
  tev.wait();
  bool shown = true;
  for (int i = 0; i < 100 && shown; ++i) // the system takes some bytes more
    shown = viewer.show("a", picture) && viewer.finish();
  EXPECT_FALSE(shown);
  EXPECT_FALSE(viewer.finish());
  EXPECT_FALSE(viewer.show("a", picture));
}

// Pictures that have not begun to be sent are replaced by later ones.
TEST(Tev, ShowsTheLatest) {
  FakeTev tev;
  const Picture last = picture_of(700, 500, 1000.0f);
  {
    TevViewer viewer(tev.address());
    for (int i = 0; i < 20; ++i) EXPECT_TRUE(viewer.show("a", picture_of(700, 500, static_cast<float>(i))));
    EXPECT_TRUE(viewer.show("a", last));
    EXPECT_TRUE(viewer.finish());
  }
  tev.wait();
  EXPECT_GE(tev.pictures, 1);
  EXPECT_LE(tev.pictures, 21);
  expect_same(tev.images["a"], last);
}

// One that reads nothing costs nothing while there is something to render, and a second at the end.
TEST(Tev, WaitsForNoneThatHangs) {
  const SilentTev tev;
  const Picture large = picture_of(2000, 1000, 0.0f); // 40 MB
  const Clock::time_point start = Clock::now();
  {
    TevViewer viewer(tev.address());
    for (int i = 0; i < 5; ++i) EXPECT_TRUE(viewer.show("a", large));
    const Clock::time_point shown = Clock::now();
    EXPECT_FALSE(viewer.finish());
    EXPECT_GT(seconds_since(shown), 0.9);
    EXPECT_LT(seconds_since(shown), 2.5);
    EXPECT_FALSE(viewer.show("a", large));
  }
  EXPECT_LT(seconds_since(start), 4.0);
}

TEST(Tev, WaitsASecondForAnAnswer) {
  const SilentTev tev(true);
  const Clock::time_point start = Clock::now();
  try {
    TevViewer viewer(tev.address());
    FAIL() << "it has no room for another connection";
  } catch (const Error& error) {
    EXPECT_EQ(error.what(), "--tev: no tev answers at " + tev.address() +
                                ": Connection timed out; start tev there, or leave out --tev");
  }
  EXPECT_LT(seconds_since(start), 2.5);
}

TEST(Tev, RefusesWhereNoneIs) {
  std::string address;
  {
    const FakeTev tev;
    address = tev.address();
  }
  const auto message = [](const std::string& text) -> std::string {
    try {
      TevViewer viewer(text);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message(address),
            "--tev: no tev answers at " + address + ": Connection refused; start tev there, or leave out --tev");
  EXPECT_EQ(message(":14158"), "--tev: ':14158' names no host; write HOST or HOST:PORT");
  EXPECT_EQ(message("[]:14158"), "--tev: '[]:14158' names no host; write HOST or HOST:PORT");
  for (const char* port : {"", "0", "65536", "1x", "-1", "1234567"})
    EXPECT_EQ(message(std::string("localhost:") + port),
              "--tev: '" + std::string(port) + "' is no port; write one of 1 to 65535, or none for 14158");
  EXPECT_NE(message("no-such-host.invalid").find("--tev: the host no-such-host.invalid is not known: "),
            std::string::npos);
  EXPECT_NE(message("[::1]:1").find("--tev: no tev answers at ::1:1: "), std::string::npos) << message("[::1]:1");
}

} // namespace
} // namespace wavepath::test
