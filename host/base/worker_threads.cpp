#include "host/base/worker_threads.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <system_error>

#include <fmt/format.h>
#include <pthread.h>
#include <sched.h>

namespace wavepath {
namespace {

constexpr const char* kTasks = "/proc/self/task";
// A worker waits 1 to 3 % of the time that it runs on a quiet machine (two cores, llvmpipe), and as long as it runs if
// another program computes on its core.
constexpr double kPatience = 0.5;
constexpr std::uint64_t kTelling = 10'000'000; // nanoseconds of running, below which waiting tells nothing
constexpr std::chrono::milliseconds kBetweenLooks{20};

std::atomic<bool> leaves_alone{false};

std::vector<int> usable_cores() {
  cpu_set_t set;
  std::vector<int> cores;
  if (sched_getaffinity(0, sizeof(set), &set) != 0) return cores;
  for (int core = 0; core < CPU_SETSIZE; ++core)
    if (CPU_ISSET(core, &set)) cores.push_back(core);
  return cores;
}

// A thread that has ended stays as it is.
void allow(int thread, std::span<const int> cores) {
  cpu_set_t set;
  CPU_ZERO(&set);
  for (const int core : cores) CPU_SET(core, &set);
  sched_setaffinity(thread, sizeof(set), &set);
}

// In the order in which they were made, as the kernel lists them.
std::vector<int> threads_named(const std::string& name) {
  std::vector<int> found;
  std::error_code error;
  const std::filesystem::directory_iterator end;
  for (auto task = std::filesystem::directory_iterator(kTasks, error); task != end; task.increment(error)) {
    std::ifstream file(task->path() / "comm");
    std::string own;
    if (std::getline(file, own) && own == name) found.push_back(std::stoi(task->path().filename()));
  }
  return found;
}

ThreadTimes times_of(int thread) {
  ThreadTimes times;
  std::ifstream(std::filesystem::path(kTasks) / std::to_string(thread) / "schedstat") >> times.ran >> times.waited;
  return times;
}

} // namespace

bool waits_for_cores(std::span<const ThreadTimes> threads) {
  return std::ranges::any_of(threads, [](const ThreadTimes& t) {
    return t.ran >= kTelling && static_cast<double>(t.waited) > kPatience * static_cast<double>(t.ran);
  });
}

void leave_workers_alone() { leaves_alone = true; }

WorkerThreads::Making::Making(WorkerThreads& workers) {
  if (leaves_alone) return;
  static std::atomic<std::uint32_t> made{0};
  workers.name_ = fmt::format("worker {}", made++ % 10'000'000); // at most 15 characters
  pthread_getname_np(pthread_self(), own_name_, sizeof(own_name_));
  pthread_setname_np(pthread_self(), workers.name_.c_str());
}

WorkerThreads::Making::~Making() {
  if (own_name_[0] != '\0') pthread_setname_np(pthread_self(), own_name_);
}

void WorkerThreads::prepare() {
  if (!name_.empty())
    keep_apart();
  else if (are_apart() && Clock::now() - looked_ >= kBetweenLooks)
    free_if_they_wait();
}

void WorkerThreads::keep_apart() {
  std::vector<int> found = threads_named(name_);
  name_.clear();
  cores_ = usable_cores();
  if (cores_.size() < 2 || (found.size() != cores_.size() && found.size() != cores_.size() + 1)) return;
  found.erase(found.begin(), found.end() - static_cast<std::ptrdiff_t>(cores_.size()));
  for (std::size_t i = 0; i < found.size(); ++i) {
    workers_.push_back({found[i], times_of(found[i])});
    allow(found[i], std::span(cores_).subspan(i, 1));
  }
  looked_ = Clock::now();
}

void WorkerThreads::free_if_they_wait() {
  std::vector<ThreadTimes> since;
  for (Worker& worker : workers_) {
    const ThreadTimes now = times_of(worker.id);
    since.push_back({now.ran - worker.seen.ran, now.waited - worker.seen.waited});
    worker.seen = now;
  }
  looked_ = Clock::now();
  if (!waits_for_cores(since)) return;
  for (const Worker& worker : workers_) allow(worker.id, cores_);
  workers_.clear();
}

} // namespace wavepath
