// Invocations take each entry of a queue once, and threads that run workgroups one after the other take some of all
// parts.
#include <algorithm>
#include <cstddef>
#include <numeric>

#include "kernels/base/features.h"
#include "tests/probe.h"
#include "tests/probes/queue_item_probe.spv.h"

namespace wavepath::test {
namespace {

class QueueItemTest : public VulkanTest {
protected:
  // By invocation.
  std::vector<std::uint32_t> places(std::uint32_t walk, std::uint32_t groups) {
    std::vector<std::uint32_t> constants(gpu::kSpecWalk + 1);
    constants[gpu::kSpecWalk] = walk;
    const std::uint32_t count = groups * gpu::kWorkgroupSize;
    std::vector<ProbeBuffer> buffers{to_probe(std::vector<std::uint32_t>(count, gpu::kNone))};
    run_probe(device(), wavepath_queue_item_probe_spv, count, buffers, constants);
    return from_probe<std::uint32_t>(buffers[0]);
  }
};

TEST_F(QueueItemTest, EachEntryIsTakenOnce) {
  for (const std::uint32_t groups : {1u, 31u, 255u, 256u, 257u, 511u, 1000u, 2048u, 4095u}) {
    std::vector<std::uint32_t> taken = places(gpu::kWalkInStep, groups), all(taken.size());
    std::iota(all.begin(), all.end(), 0u);
    std::ranges::sort(taken);
    EXPECT_EQ(taken, all) << groups;
  }
}

TEST_F(QueueItemTest, LanesThatGoTheirOwnWaysTakeTheirOwn) {
  const std::vector<std::uint32_t> taken = places(gpu::kWalkByLane, 512);
  for (std::uint32_t i = 0; i < taken.size(); ++i) ASSERT_EQ(taken[i], i);
}

// What two, three or four threads run has as much of each eighth of the queue.
TEST_F(QueueItemTest, EachThreadTakesSomeOfAllParts) {
  constexpr std::size_t kParts = 8;
  const std::vector<std::uint32_t> taken = places(gpu::kWalkInStep, 2048);
  for (std::size_t threads = 2; threads <= 4; ++threads)
    for (std::size_t thread = 0; thread < threads; ++thread) {
      const std::size_t first = thread * taken.size() / threads, end = (thread + 1) * taken.size() / threads;
      std::vector<double> of_part(kParts);
      for (std::size_t i = first; i < end; ++i) of_part[taken[i] * kParts / taken.size()] += 1.0;
      const double even = static_cast<double>(end - first) / kParts;
      for (const double count : of_part) EXPECT_NEAR(count, even, 0.3 * even) << threads << " " << thread;
    }
}

// Neighbours stay neighbours for long enough that threads seldom write to one line of the cache.
TEST_F(QueueItemTest, NeighboursStayTogether) {
  const std::vector<std::uint32_t> taken = places(gpu::kWalkInStep, 2048);
  std::size_t cuts = 0;
  for (std::size_t i = 1; i < taken.size(); ++i) cuts += taken[i] != taken[i - 1] + 1;
  EXPECT_LT(cuts, 100u);
  EXPECT_GT(cuts, 0u);
}

} // namespace
} // namespace wavepath::test
