#include "host/base/worker_threads.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <system_error>

#include <pthread.h>
#include <sched.h>

namespace wavepath {
namespace {

constexpr const char* kName = "wavepath-worker"; // 15 characters, the most that a name has
constexpr const char* kTasks = "/proc/self/task";
// Of what a worker runs it waits 1 to 3 % on a quiet machine (two cores, llvmpipe), and as long as it runs where another
// program computes on its core.
constexpr double kPatience = 0.3;
constexpr std::uint64_t kTelling = 20'000'000; // nanoseconds of running, below which waiting tells nothing

std::vector<int> usable_cores() {
  cpu_set_t set;
  std::vector<int> cores;
  if (sched_getaffinity(0, sizeof(set), &set) != 0) return cores;
  for (int core = 0; core < CPU_SETSIZE; ++core)
    if (CPU_ISSET(core, &set)) cores.push_back(core);
  return cores;
}

// A thread that has ended stays as it is.
void allow(int thread, const std::vector<int>& cores) {
  cpu_set_t set;
  CPU_ZERO(&set);
  for (const int core : cores) CPU_SET(core, &set);
  sched_setaffinity(thread, sizeof(set), &set);
}

} // namespace

MakesWorkers::MakesWorkers() {
  pthread_getname_np(pthread_self(), name_, sizeof(name_));
  pthread_setname_np(pthread_self(), kName);
}

MakesWorkers::~MakesWorkers() { pthread_setname_np(pthread_self(), name_); }

WorkerThreads WorkerThreads::keep_apart() {
  WorkerThreads found;
  std::error_code error;
  for (const auto& task : std::filesystem::directory_iterator(kTasks, error)) {
    std::ifstream file(task.path() / "comm");
    std::string name;
    if (std::getline(file, name) && name == kName) found.workers_.push_back({std::stoi(task.path().filename()), {}});
  }
  found.cores_ = usable_cores();
  if (found.cores_.size() < 2 || found.workers_.size() < found.cores_.size()) return {};
  std::ranges::sort(found.workers_, std::greater(), &Worker::id);
  found.workers_.resize(found.cores_.size());
  for (std::size_t i = 0; i < found.workers_.size(); ++i) {
    found.workers_[i].seen = times_of(found.workers_[i].id);
    allow(found.workers_[i].id, {found.cores_[i]});
  }
  return found;
}

WorkerThreads::Times WorkerThreads::times_of(int id) {
  Times times;
  std::ifstream(std::filesystem::path(kTasks) / std::to_string(id) / "schedstat") >> times.ran >> times.waited;
  return times;
}

void WorkerThreads::free_if_they_wait() {
  if (!are_apart()) return;
  std::vector<Times> now;
  std::uint64_t ran = 0, waited = 0;
  for (const Worker& worker : workers_) {
    now.push_back(times_of(worker.id));
    ran += now.back().ran - worker.seen.ran;
    waited += now.back().waited - worker.seen.waited;
  }
  if (ran < kTelling) return;
  for (std::size_t i = 0; i < workers_.size(); ++i) workers_[i].seen = now[i];
  if (static_cast<double>(waited) <= kPatience * static_cast<double>(ran)) return;
  for (const Worker& worker : workers_) allow(worker.id, cores_);
  workers_.clear();
}

} // namespace wavepath
