// The cache of compiled kernels: kept between devices, and harmless whatever the disk holds.
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "host/base/cache_file.h"
#include "host/gpu/pipeline_cache.h"
#include "tests/probe.h"
#include "tests/probes/filter_probe.spv.h"
#include "tests/temporary_folder.h"

namespace wavepath::test {
namespace {

namespace fs = std::filesystem;

class PipelineCacheTest : public VulkanTest {
protected:
  void SetUp() override {
    VulkanTest::SetUp();
    if (const char* value = std::getenv("WAVEPATH_CACHE")) before_ = value;
    setenv("WAVEPATH_CACHE", cache_.c_str(), 1);
  }
  void TearDown() override {
    before_.empty() ? unsetenv("WAVEPATH_CACHE") : setenv("WAVEPATH_CACHE", before_.c_str(), 1);
    VulkanTest::TearDown();
  }

  // Opens the device as the program does, compiles a kernel and closes it again. Returns how the cache describes
  // itself.
  static std::string run_once() {
    Device device(std::getenv("WAVEPATH_DEVICE") ? std::getenv("WAVEPATH_DEVICE") : "");
    std::vector<ProbeBuffer> buffers{to_probe(std::vector<float>(128, 0.5f))};
    run_probe(device, wavepath_filter_probe_spv, 64, buffers);
    device.pipeline_cache().save();
    return device.pipeline_cache().describe();
  }
  fs::path only_file() const {
    EXPECT_EQ(std::distance(fs::directory_iterator(cache_), {}), 1);
    return fs::directory_iterator(cache_)->path();
  }
  static std::uint64_t key_of(const fs::path& file) {
    return std::stoull(file.filename().string().substr(10), nullptr, 16);
  }
  static std::string bytes_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  // Whatever the file holds, the program works and leaves a valid file.
  void expect_recovery(const fs::path& file, const std::string& contents) {
    std::ofstream(file, std::ios::binary) << contents;
    run_once();
    EXPECT_FALSE(read_cache_file(file, key_of(file)).empty());
  }

  TemporaryFolder folder_;
  fs::path cache_ = folder_.path() / "kernels";

private:
  std::string before_;
};

TEST_F(PipelineCacheTest, IsKeptFromRunToRun) {
  const std::string said = run_once();
  const fs::path file = only_file();
  EXPECT_NE(said.find(file.string()), std::string::npos) << said;
  EXPECT_GE(read_cache_file(file, key_of(file)).size(), 32u) << "Vulkan's own header at the least";
  const auto written = fs::last_write_time(file);
  run_once();
  EXPECT_EQ(only_file(), file);
  EXPECT_EQ(fs::last_write_time(file), written) << "not written again when nothing is new";
}

TEST_F(PipelineCacheTest, DamageIsReplaced) {
  run_once();
  const fs::path file = only_file();
  const std::string sound = bytes_of(file);
  expect_recovery(file, "");
  expect_recovery(file, "something else altogether");
  expect_recovery(file, sound.substr(0, sound.size() / 2));
  std::string flipped = sound;
  flipped.back() = static_cast<char>(flipped.back() ^ 1);
  expect_recovery(file, flipped);
}

TEST_F(PipelineCacheTest, AnotherOriginIsReplaced) {
  run_once();
  const fs::path file = only_file();
  const std::uint64_t key = key_of(file);
  const std::vector<std::uint8_t> sound = read_cache_file(file, key);
  ASSERT_TRUE(write_cache_file(file, key + 1, sound)); // whole, but of another driver, device or build
  run_once();
  EXPECT_FALSE(read_cache_file(file, key).empty());

  // Vulkan's header names vendor, device and UUID from byte 8 on; the driver has to see through this one itself.
  std::vector<std::uint8_t> foreign = sound;
  for (std::size_t i = 8; i < 32; ++i) foreign[i] ^= 0x5a;
  ASSERT_TRUE(write_cache_file(file, key, foreign));
  run_once();
  EXPECT_NE(read_cache_file(file, key), foreign);
}

TEST_F(PipelineCacheTest, AFolderThatCannotBeWrittenIsNoError) {
  std::ofstream(cache_) << "a file where the folder should be";
  EXPECT_NE(run_once().find("cannot be written"), std::string::npos);
}

TEST_F(PipelineCacheTest, CanBeTurnedOff) {
  setenv("WAVEPATH_CACHE", "off", 1);
  EXPECT_EQ(run_once(), "off");
  EXPECT_FALSE(fs::exists(cache_));
}

} // namespace
} // namespace wavepath::test
