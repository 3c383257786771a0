// The device itself: staging where device memory cannot be mapped, the CPU driver that is treated as a discrete GPU,
// and whether the validation layer checks synchronization.
#include "host/gpu/device.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <sched.h>

#include "host/base/error.h"
#include "host/gpu/commands.h"
#include "host/gpu/device_choice.h"
#include "host/gpu/device_limit.h"
#include "host/gpu/kernel.h"
#include "tests/emulate.h"
#include "tests/probe.h"

namespace wavepath::test {
namespace {

const char* wanted_device() { return std::getenv("WAVEPATH_DEVICE") ? std::getenv("WAVEPATH_DEVICE") : ""; }

class DeviceTest : public VulkanTest {};

TEST_F(DeviceTest, ACpuEmulatesADiscreteGpu) {
  const Emulate plain(nullptr);
  if (Device(wanted_device()).info().type != "cpu") GTEST_SKIP() << "only a CPU device emulates another";
  const Emulate emulate("discrete");
  const Device device(wanted_device());
  EXPECT_EQ(device.info().type, "discrete");
  EXPECT_FALSE(device.unified_memory());
  for (const DeviceInfo& info : list_devices()) EXPECT_NE(info.type, "cpu");
}

TEST_F(DeviceTest, RefusesMoreBuffersThanAKernelSees) {
  const DeviceInfo& info = device().info();
  for (const auto& [kind, most] :
       {std::pair{BindingKind::storage, info.max_storage}, {BindingKind::texels_r32ui, info.max_sampled}}) {
    if (most > 1000) continue; // whatever kernels ask for
    std::vector<Binding> bindings;
    for (std::uint32_t slot = 0; slot <= most; ++slot) bindings.push_back({slot, kind, nullptr});
    EXPECT_THROW(BindingLayout(device(), bindings, 0), DeviceLimit) << most;
  }
}

std::set<int> threads() {
  std::set<int> found;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task"))
    found.insert(std::stoi(task.path().filename()));
  return found;
}

// host/base/worker_threads.h knows them by what they inherit from the thread that opens the device.
TEST_F(DeviceTest, ThreadsThatLlvmpipeComputesOnAreKeptApart) {
  cpu_set_t set;
  const bool known = sched_getaffinity(0, sizeof(set), &set) == 0;
  const int cores = known ? CPU_COUNT(&set) : 0;
  constexpr int kMostThreads = 16; // of llvmpipe
  if (cores < 2 || cores > kMostThreads || std::getenv("LP_NUM_THREADS")) GTEST_SKIP() << "not a thread for each core";
  const std::set<int> before = threads();
  Device device(wanted_device());
  if (!device.info().dispatches_at_once) GTEST_SKIP() << "not llvmpipe";
  const auto nameless = [&] { // threads that still have the inherited name
    return std::ranges::count_if(threads(), [&](int thread) {
      std::ifstream file("/proc/self/task/" + std::to_string(thread) + "/comm");
      std::string name;
      return !before.contains(thread) && std::getline(file, name) && name.starts_with("worker ");
    });
  };
  using namespace std::chrono_literals;
  for (int i = 0; i < 1000 && nameless() > cores + 1; ++i) std::this_thread::sleep_for(10ms); // one that keeps a cache
  device.prepare_workers();
  int kept = 0;
  for (const int thread : threads())
    kept += !before.contains(thread) && sched_getaffinity(thread, sizeof(set), &set) == 0 && CPU_COUNT(&set) == 1;
  EXPECT_EQ(kept, cores);
}

TEST_F(DeviceTest, AnUnknownEmulationIsRefused) {
  const Emulate emulate("integrated");
  for (const auto& attempt :
       {std::function<void()>([] { list_devices(); }), std::function<void()>([] { Device(""); })}) {
    try {
      attempt();
      ADD_FAILURE() << "not refused";
    } catch (const Error& error) {
      const std::string message = error.what();
      EXPECT_NE(message.find("WAVEPATH_EMULATE: unknown value 'integrated'"), std::string::npos) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos);
    }
  }
}

TEST_F(DeviceTest, TheFormerNameOfEmulationIsRead) {
  const Emulate none(nullptr);
  const char* value = std::getenv("WAVEPATH_EMULATE");
  const std::string before = value ? value : "";
  setenv("WAVEPATH_EMULATE", "integrated", 1);
  EXPECT_THROW(list_devices(), Error);
  {
    const Emulate first("discrete");
    EXPECT_NO_THROW(list_devices()) << "the new name comes first";
  }
  before.empty() ? unsetenv("WAVEPATH_EMULATE") : setenv("WAVEPATH_EMULATE", before.c_str(), 1);
}

// More than the staging buffer holds, at an odd offset, and from several threads.
TEST_F(DeviceTest, MemoryThatCannotBeMappedIsStaged) {
  const Emulate emulate("discrete");
  Device device(wanted_device());
  std::vector<std::uint32_t> values((80u << 20) / sizeof(std::uint32_t));
  std::iota(values.begin(), values.end(), 1u);
  Buffer buffer = upload(device, values);
  EXPECT_EQ(buffer.mapped(), nullptr);
  EXPECT_EQ(download<std::uint32_t>(buffer, values.size()), values);

  const std::uint32_t mark = 0xabcdef01u;
  buffer.write(&mark, sizeof(mark), 12);
  buffer.fill_zero(8);
  EXPECT_EQ(download<std::uint32_t>(buffer, 5), (std::vector<std::uint32_t>{0, 0, 3, mark, 5}));
  EXPECT_EQ(download<std::uint32_t>(buffer, 2, values.size() * 4 - 8),
            (std::vector<std::uint32_t>{values.back() - 1, values.back()}));

  std::vector<std::thread> threads;
  std::vector<std::vector<std::uint32_t>> read(4);
  for (std::size_t i = 0; i < read.size(); ++i)
    threads.emplace_back([&, i] {
      for (int times = 0; times < 8; ++times) read[i] = download<std::uint32_t>(buffer, 100 + i, 4000 * i + 400);
    });
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < read.size(); ++i)
    EXPECT_TRUE(
        std::equal(read[i].begin(), read[i].end(), values.begin() + static_cast<std::ptrdiff_t>(1000 * i + 100)));
}

TEST_F(DeviceTest, ReadBackBuffersAreMapped) {
  const std::vector<std::uint32_t> values{3, 1, 4, 1, 5};
  const Buffer from = upload(device(), values);
  Buffer to(device(), values.size() * 4, BufferHome::readback);
  Commands commands(device());
  commands.copy(from, to, from.bytes());
  commands.submit_and_wait();
  to.invalidate();
  const auto* mapped = static_cast<const std::uint32_t*>(to.mapped());
  EXPECT_EQ(std::vector<std::uint32_t>(mapped, mapped + values.size()), values);
  EXPECT_EQ(from.mapped(), nullptr) << "also where the host could reach it, so that no code relies on that";
}

DeviceInfo made_up(const char* name, const char* type, bool usable = true) {
  DeviceInfo info;
  info.name = name;
  info.type = type;
  if (!usable) info.missing.emplace_back("Vulkan 1.3");
  return info;
}

TEST(DeviceChoice, PrefersDiscreteThenIntegratedThenCpu) {
  const DeviceInfo cpu = made_up("llvmpipe", "cpu"), integrated = made_up("UHD", "integrated"),
                   discrete = made_up("Arc A770", "discrete"), old = made_up("GTX 680", "discrete", false);
  EXPECT_EQ(choose_device({cpu, integrated, discrete}, ""), 2u);
  EXPECT_EQ(choose_device({old, cpu, integrated}, ""), 2u);
  EXPECT_EQ(choose_device({cpu}, ""), 0u);
}

// A number that is no index is part of a name.
TEST(DeviceChoice, TakesIndicesAndPartsOfNames) {
  const std::vector<DeviceInfo> devices = {made_up("llvmpipe", "cpu"), made_up("Intel Arc A770", "discrete"),
                                           made_up("GeForce RTX 4090", "discrete")};
  EXPECT_EQ(choose_device(devices, "0"), 0u);
  EXPECT_EQ(choose_device(devices, "2"), 2u);
  EXPECT_EQ(choose_device(devices, "770"), 1u);
  EXPECT_EQ(choose_device(devices, "4090"), 2u);
  EXPECT_EQ(choose_device(devices, "geforce"), 2u);
  EXPECT_THROW(choose_device(devices, "3"), Error);
  for (const char* digits : {"7", "77", "409", "090"}) EXPECT_THROW(choose_device(devices, digits), Error) << digits;
  EXPECT_THROW(choose_device(devices, "radeon"), Error);
  EXPECT_THROW(choose_device({}, ""), Error);
  EXPECT_THROW(choose_device({made_up("GTX 680", "discrete", false)}, "680"), Error);
}

TEST(Timestamps, WrapWhereTheyHaveFewBits) {
  constexpr std::uint64_t kTop36 = (std::uint64_t{1} << 36) - 10, kTop64 = ~std::uint64_t{0} - 9;
  EXPECT_EQ(ticks_between(100, 150, 36), 50u);
  EXPECT_EQ(ticks_between(kTop36, 40, 36), 50u);
  EXPECT_EQ(ticks_between(kTop64, 40, 64), 50u);
  EXPECT_EQ(ticks_between(0xf00000000000000a, 60, 36), 50u); // above them is nothing to rely on
}

// Two copies into one buffer with no barrier between them: the suite's barriers are checked only if this is noticed.
TEST(ValidationTest, MissingBarriersAreNoticed) {
  const char* wanted = std::getenv("WAVEPATH_VALIDATION");
  if (!test_device().device || !wanted || std::string(wanted) != "1") GTEST_SKIP() << "without the validation layer";
  Device& device = *test_device().device;
  const Buffer a(device, 1024), b(device, 1024);
  const std::uint32_t before = Device::validation_messages();
  Commands commands(device);
  commands.copy(a, b, 1024);
  commands.copy(a, b, 1024);
  EXPECT_EQ(Device::validation_messages(), before);
  commands.copy(a, b, 1024, Commands::Order::unordered);
  commands.copy(a, b, 1024, Commands::Order::unordered);
  EXPECT_GT(Device::validation_messages(), before);
}

} // namespace
} // namespace wavepath::test
