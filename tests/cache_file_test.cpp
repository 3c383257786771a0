// Cache files: what was written comes back, and anything else on the disk counts as nothing.
#include <cstdlib>
#include <fstream>
#include <map>
#include <numeric>
#include <optional>
#include <string>

#include <sys/stat.h>

#include <gtest/gtest.h>

#include "host/base/cache_file.h"
#include "tests/temporary_folder.h"

namespace wavepath::test {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kKey = 42;

// The three variables that choose the folder; as they were, afterwards.
class CacheFileTest : public ::testing::Test {
protected:
  void SetUp() override {
    for (const char* name : {"WAVEPATH_CACHE", "XDG_CACHE_HOME", "HOME"}) {
      const char* value = std::getenv(name);
      before_[name] = value ? std::optional<std::string>(value) : std::nullopt;
      unsetenv(name);
    }
  }
  void TearDown() override {
    for (const auto& [name, value] : before_) value ? setenv(name.c_str(), value->c_str(), 1) : unsetenv(name.c_str());
  }
  void write_raw(const std::string& bytes) { std::ofstream(path_, std::ios::binary) << bytes; }
  std::string read_raw() {
    std::ifstream file(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  TemporaryFolder folder_;
  fs::path path_ = folder_.path() / "cache";
  std::vector<std::uint8_t> data_ = [] {
    std::vector<std::uint8_t> bytes(1000);
    std::iota(bytes.begin(), bytes.end(), std::uint8_t{0});
    return bytes;
  }();

private:
  std::map<std::string, std::optional<std::string>> before_;
};

TEST_F(CacheFileTest, WhatWasWrittenComesBack) {
  ASSERT_TRUE(write_cache_file(path_, kKey, data_));
  EXPECT_EQ(read_cache_file(path_, kKey), data_);
  data_.resize(10);
  ASSERT_TRUE(write_cache_file(path_, kKey, data_)) << "a second time, shorter";
  EXPECT_EQ(read_cache_file(path_, kKey), data_);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), {}), 1) << "no temporary file stays behind";
}

TEST_F(CacheFileTest, AnotherKeyFindsNothing) {
  ASSERT_TRUE(write_cache_file(path_, kKey, data_));
  EXPECT_TRUE(read_cache_file(path_, kKey + 1).empty());
}

TEST_F(CacheFileTest, DamageAnywhereIsNoticed) {
  ASSERT_TRUE(write_cache_file(path_, kKey, data_));
  const std::string sound = read_raw();
  for (std::size_t at = 0; at < sound.size(); ++at) {
    std::string damaged = sound;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    write_raw(damaged);
    ASSERT_TRUE(read_cache_file(path_, kKey).empty()) << at;
  }
}

TEST_F(CacheFileTest, CutShortOrTooLongIsNoticed) {
  ASSERT_TRUE(write_cache_file(path_, kKey, data_));
  const std::string sound = read_raw();
  for (const std::size_t length :
       {std::size_t{0}, std::size_t{1}, std::size_t{31}, std::size_t{32}, sound.size() - 1}) {
    write_raw(sound.substr(0, length));
    EXPECT_TRUE(read_cache_file(path_, kKey).empty()) << length;
  }
  write_raw(sound + "x");
  EXPECT_TRUE(read_cache_file(path_, kKey).empty());
}

TEST_F(CacheFileTest, WhatIsNoFileIsLeftAlone) {
  EXPECT_TRUE(read_cache_file(path_, kKey).empty());
  fs::create_directory(path_);
  EXPECT_TRUE(read_cache_file(path_, kKey).empty());
  EXPECT_FALSE(write_cache_file(path_, kKey, data_));
  const fs::path pipe = folder_.path() / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_TRUE(read_cache_file(pipe, kKey).empty()) << "and returns, rather than wait for a writer";
  EXPECT_FALSE(write_cache_file(pipe, kKey, data_)) << "and returns, rather than wait for a reader";
}

TEST_F(CacheFileTest, AFolderThatCannotBeMadeIsNoError) {
  write_raw("a file where a folder should be");
  EXPECT_FALSE(write_cache_file(path_ / "sub" / "cache", kKey, data_));
  EXPECT_TRUE(read_cache_file(path_ / "sub" / "cache", kKey).empty());
}

TEST_F(CacheFileTest, ANewFolderIsTheUsersAlone) {
  const fs::path deep = folder_.path() / "a" / "b";
  ASSERT_TRUE(write_cache_file(deep / "cache", kKey, data_));
  EXPECT_EQ(fs::status(deep).permissions(), fs::perms::owner_all);
}

TEST_F(CacheFileTest, TheEnvironmentChoosesTheFolder) {
  EXPECT_EQ(cache_folder(), "");
  setenv("HOME", "/somewhere", 1);
  EXPECT_EQ(cache_folder(), "/somewhere/.cache/wavepath");
  setenv("XDG_CACHE_HOME", "relative", 1);
  EXPECT_EQ(cache_folder(), "/somewhere/.cache/wavepath");
  setenv("XDG_CACHE_HOME", "/elsewhere", 1);
  EXPECT_EQ(cache_folder(), "/elsewhere/wavepath");
  setenv("WAVEPATH_CACHE", "", 1);
  EXPECT_EQ(cache_folder(), "/elsewhere/wavepath");
  setenv("WAVEPATH_CACHE", "/chosen", 1);
  EXPECT_EQ(cache_folder(), "/chosen");
  setenv("WAVEPATH_CACHE", "off", 1);
  EXPECT_EQ(cache_folder(), "");
}

} // namespace
} // namespace wavepath::test
