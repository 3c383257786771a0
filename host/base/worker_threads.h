// Threads of a library that shares each piece of work evenly among one thread a core, and waits for all of them.
//
// Linux may wake two such threads on one core while another core has nothing to do. A core that falls idle for less than
// half a millisecond at a time does not look for work elsewhere, so that only the tick, every 4 ms, parts them: pieces of a
// few milliseconds then take twice as long, again and again. Each thread kept on a core of its own ends that. But where
// other programs need a core, threads must be free to leave it: so they are, as soon as they have to wait.
#pragma once

#include <cstdint>
#include <vector>

namespace wavepath {

// While it lives, threads that the calling thread starts are known as workers: they inherit its name, which is another one
// until then.
class MakesWorkers {
public:
  MakesWorkers();
  ~MakesWorkers();
  MakesWorkers(MakesWorkers&&) = delete;

private:
  char name_[16] = {};
};

// Not for several threads at once.
class WorkerThreads {
public:
  WorkerThreads() = default; // none

  // The newest workers of this process, as many as the calling thread may use cores, each kept on one of these from now on.
  // None if there are fewer of them, or a single core.
  static WorkerThreads keep_apart();

  // To be called now and then: frees them, for good, if they have waited for their cores for a good part of the time that
  // they ran since it was called before (schedstat of proc(5); where the kernel does not tell, they stay).
  void free_if_they_wait();

  bool are_apart() const { return !workers_.empty(); }

private:
  struct Times {
    std::uint64_t ran = 0, waited = 0; // nanoseconds
  };
  struct Worker {
    int id; // of the kernel
    Times seen;
  };

  static Times times_of(int id);

  std::vector<Worker> workers_;
  std::vector<int> cores_;
};

} // namespace wavepath
