// Threads that are kept on a core each, and freed when they have to wait.
#include "host/base/worker_threads.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <fstream>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <pthread.h>
#include <sched.h>
#include <unistd.h>

#include <gtest/gtest.h>

namespace wavepath::test {
namespace {

using Cores = std::set<int>;

Cores cores_of(int thread) {
  cpu_set_t set;
  Cores cores;
  if (sched_getaffinity(thread, sizeof(set), &set) == 0)
    for (int core = 0; core < CPU_SETSIZE; ++core)
      if (CPU_ISSET(core, &set)) cores.insert(core);
  return cores;
}

// Computes from start() until it goes; sleeps before.
class Thread {
public:
  Thread() : thread_([this] { run(); }) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return id_ != 0; });
  }
  ~Thread() {
    stops_ = true;
    start();
    thread_.join();
  }
  void start() {
    const std::lock_guard lock(mutex_);
    started_ = true;
    changed_.notify_all();
  }
  int id() const { return id_; }

private:
  void run() {
    std::unique_lock lock(mutex_);
    id_ = gettid();
    changed_.notify_all();
    changed_.wait(lock, [this] { return started_; });
    lock.unlock();
    while (!stops_) ++rounds_;
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  bool started_ = false;
  int id_ = 0;
  std::atomic<bool> stops_ = false;
  std::atomic<std::uint64_t> rounds_ = 0;
  std::thread thread_;
};

using Threads = std::vector<std::unique_ptr<Thread>>;

Threads make_threads(std::size_t count) {
  Threads threads;
  for (std::size_t i = 0; i < count; ++i) threads.push_back(std::make_unique<Thread>());
  return threads;
}

Threads make_workers(WorkerThreads& workers, std::size_t count) {
  const WorkerThreads::Making making(workers);
  return make_threads(count);
}

constexpr std::uint64_t kMillisecond = 1'000'000;
ThreadTimes times(std::uint64_t ran, std::uint64_t waited) { return {ran * kMillisecond, waited * kMillisecond}; }

TEST(WaitsForCores, WhereOneThreadSharesItsCore) {
  for (const std::size_t count : {1u, 2u, 4u, 16u, 128u}) {
    std::vector<ThreadTimes> threads(count, times(100, 3));
    EXPECT_FALSE(waits_for_cores(threads)) << count;
    threads.back() = times(100, 100);
    EXPECT_TRUE(waits_for_cores(threads)) << count;
    threads.back() = times(100, 30);
    EXPECT_FALSE(waits_for_cores(threads)) << count << ", for a moment";
  }
  EXPECT_FALSE(waits_for_cores({}));
}

TEST(WaitsForCores, NotWhereNothingRan) {
  EXPECT_FALSE(waits_for_cores(std::vector{times(0, 0), times(1, 5)}));
  EXPECT_FALSE(waits_for_cores(std::vector{times(0, 50), times(60, 2)}));
}

class WorkerThreadsTest : public testing::Test {
protected:
  void SetUp() override {
    if (all.size() < 2) GTEST_SKIP() << "a single core";
  }
  const Cores all = cores_of(0);
};

TEST_F(WorkerThreadsTest, EachHasACoreOfItsOwn) {
  WorkerThreads workers, others;
  const Threads made = make_workers(workers, all.size()), made_for_others = make_workers(others, 1);
  const Threads strangers = make_threads(1);
  workers.prepare();
  EXPECT_TRUE(workers.are_apart());
  Cores taken;
  for (const auto& thread : made) {
    const Cores own = cores_of(thread->id());
    EXPECT_EQ(own.size(), 1u);
    taken.insert(own.begin(), own.end());
  }
  EXPECT_EQ(taken, all);
  EXPECT_EQ(cores_of(strangers.front()->id()), all);
  EXPECT_EQ(cores_of(made_for_others.front()->id()), all);
  EXPECT_EQ(cores_of(0), all) << "who makes them may run anywhere";
}

TEST_F(WorkerThreadsTest, WhoGivesThemTheirWorkIsFree) {
  WorkerThreads workers;
  const Threads made = make_workers(workers, all.size() + 1);
  workers.prepare();
  EXPECT_TRUE(workers.are_apart());
  EXPECT_EQ(cores_of(made.front()->id()), all);
  for (std::size_t i = 1; i < made.size(); ++i) EXPECT_EQ(cores_of(made[i]->id()).size(), 1u) << i;
}

TEST_F(WorkerThreadsTest, FewerOrMoreThanCoresAreLeftAlone) {
  for (const std::size_t count : {all.size() - 1, all.size() + 2}) {
    WorkerThreads workers;
    const Threads made = make_workers(workers, count);
    workers.prepare();
    EXPECT_FALSE(workers.are_apart()) << count;
    for (const auto& thread : made) EXPECT_EQ(cores_of(thread->id()), all) << count;
  }
}

TEST_F(WorkerThreadsTest, ThoseThatWaitAreFreed) {
  WorkerThreads workers;
  const Threads made = make_workers(workers, all.size());
  workers.prepare();
  const Threads others = make_threads(2 * all.size()); // of which each core has some to run
  for (const Threads* threads : {&others, &made})
    for (const auto& thread : *threads) thread->start();
  using namespace std::chrono_literals;
  std::this_thread::sleep_for(100ms);
  std::uint64_t ran = 0;
  std::ifstream("/proc/self/task/" + std::to_string(made.front()->id()) + "/schedstat") >> ran;
  if (ran == 0) GTEST_SKIP() << "the kernel does not tell how long threads wait";
  for (int i = 0; i < 100 && workers.are_apart(); ++i) { // ends at once as a rule; a very busy machine may take longer
    workers.prepare();
    std::this_thread::sleep_for(100ms);
  }
  EXPECT_FALSE(workers.are_apart());
  for (const auto& thread : made) EXPECT_EQ(cores_of(thread->id()), all);
}

TEST_F(WorkerThreadsTest, TheMakerGetsItsNameBack) {
  char name[16] = {}, meanwhile[16] = {}, after[16] = {};
  pthread_getname_np(pthread_self(), name, sizeof(name));
  WorkerThreads workers;
  {
    const WorkerThreads::Making making(workers);
    pthread_getname_np(pthread_self(), meanwhile, sizeof(meanwhile));
  }
  pthread_getname_np(pthread_self(), after, sizeof(after));
  EXPECT_STRNE(meanwhile, name);
  EXPECT_STREQ(after, name);
}

} // namespace
} // namespace wavepath::test
