// Threads that are kept on a core each, and freed when they have to wait.
#include "host/base/worker_threads.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
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

Threads make_workers(std::size_t count) {
  const MakesWorkers makes_workers;
  return make_threads(count);
}

class WorkerThreadsTest : public testing::Test {
protected:
  void SetUp() override {
    if (all.size() < 2) GTEST_SKIP() << "a single core";
  }
  const Cores all = cores_of(0);
};

TEST_F(WorkerThreadsTest, EachHasACoreOfItsOwn) {
  const Threads others = make_threads(1), workers = make_workers(all.size());
  const WorkerThreads kept = WorkerThreads::keep_apart();
  EXPECT_TRUE(kept.are_apart());
  Cores taken;
  for (const auto& worker : workers) {
    const Cores own = cores_of(worker->id());
    EXPECT_EQ(own.size(), 1u);
    taken.insert(own.begin(), own.end());
  }
  EXPECT_EQ(taken, all);
  EXPECT_EQ(cores_of(others.front()->id()), all) << "no worker";
  EXPECT_EQ(cores_of(0), all) << "who makes them may run anywhere";
}

TEST_F(WorkerThreadsTest, OfMoreTheNewestAreKept) {
  const Threads workers = make_workers(all.size() + 1);
  EXPECT_TRUE(WorkerThreads::keep_apart().are_apart());
  EXPECT_EQ(cores_of(workers.front()->id()), all);
  for (std::size_t i = 1; i < workers.size(); ++i) EXPECT_EQ(cores_of(workers[i]->id()).size(), 1u) << i;
}

TEST_F(WorkerThreadsTest, FewerThanCoresAreLeftAlone) {
  const Threads workers = make_workers(all.size() - 1);
  EXPECT_FALSE(WorkerThreads::keep_apart().are_apart());
  for (const auto& worker : workers) EXPECT_EQ(cores_of(worker->id()), all);
}

TEST_F(WorkerThreadsTest, ThoseThatRestStayWhereTheyAre) {
  const Threads workers = make_workers(all.size());
  WorkerThreads kept = WorkerThreads::keep_apart();
  kept.free_if_they_wait();
  EXPECT_TRUE(kept.are_apart());
  for (const auto& worker : workers) EXPECT_EQ(cores_of(worker->id()).size(), 1u);
}

TEST_F(WorkerThreadsTest, ThoseThatWaitAreFreed) {
  if (access("/proc/self/schedstat", R_OK) != 0) GTEST_SKIP() << "the kernel does not tell how long threads wait";
  const Threads workers = make_workers(all.size());
  WorkerThreads kept = WorkerThreads::keep_apart();
  const Threads others = make_threads(2 * all.size()); // of which each core has some to run
  for (const Threads* threads : {&others, &workers})
    for (const auto& thread : *threads) thread->start();
  using namespace std::chrono_literals;
  for (int i = 0; i < 100 && kept.are_apart(); ++i) { // ends at once as a rule; a very busy machine may take longer
    std::this_thread::sleep_for(100ms);
    kept.free_if_they_wait();
  }
  EXPECT_FALSE(kept.are_apart());
  for (const auto& worker : workers) EXPECT_EQ(cores_of(worker->id()), all);
}

TEST_F(WorkerThreadsTest, TheMakerGetsItsNameBack) {
  char name[16] = {}, meanwhile[16] = {}, after[16] = {};
  pthread_getname_np(pthread_self(), name, sizeof(name));
  {
    const MakesWorkers makes_workers;
    pthread_getname_np(pthread_self(), meanwhile, sizeof(meanwhile));
  }
  pthread_getname_np(pthread_self(), after, sizeof(after));
  EXPECT_STRNE(meanwhile, name);
  EXPECT_STREQ(after, name);
}

} // namespace
} // namespace wavepath::test
