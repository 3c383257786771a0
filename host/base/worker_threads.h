// Threads of a library that shares each piece of work evenly among one thread a core, and waits for all of them.
//
// Linux may wake two such threads on one core while another core has nothing to do. A core that falls idle for less
// than half a millisecond at a time does not look for work elsewhere, so that only the tick, every 4 ms, parts them:
// pieces of a few milliseconds then take twice as long, again and again. Each thread kept on a core of its own ends
// that. But where other programs need a core, threads must be free to leave it: so they are, all of them, as soon as
// one has to wait.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "host/base/clock.h"

namespace wavepath {

// Times of a thread, from the kernel's schedstat (proc(5)): nanoseconds that it ran, and that it waited for a core.
struct ThreadTimes {
  std::uint64_t ran = 0, waited = 0;
};

// True if one of these threads waits for a good part of the time that it runs.
bool waits_for_cores(std::span<const ThreadTimes> threads);

// From here on, workers of this process run on whatever core Linux gives them: for a library, whose caller decides
// about the threads of the process.
void leave_workers_alone();

// Threads on which a driver computes. Not safe to call from several threads.
class WorkerThreads {
public:
  // While it lives, threads that the calling thread starts are the workers: they inherit a name that the calling thread
  // has meanwhile.
  class Making {
  public:
    explicit Making(WorkerThreads& workers);
    ~Making();
    Making(Making&&) = delete;

  private:
    char own_name_[16] = {};
  };

  // To be called before each piece of work. The first time, keeps the workers on a core each, if they are as many as
  // the cores that the calling thread may use; one more is one that gives them their work, and was made before them.
  // Later, now and then, frees them for good if one waits; where the kernel does not tell, they stay.
  void prepare();

  bool are_apart() const { return !workers_.empty(); }

private:
  struct Worker {
    int id; // thread id of the kernel
    ThreadTimes seen;
  };

  void keep_apart();
  void free_if_they_wait();

  std::string name_; // until they are found
  std::vector<Worker> workers_;
  std::vector<int> cores_;
  Clock::time_point looked_{};
};

} // namespace wavepath
