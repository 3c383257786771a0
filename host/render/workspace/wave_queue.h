// Submits work to the device, two pieces in flight: while the device executes one, the host records the next.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/base/clock.h"
#include "host/gpu/commands.h"
#include "host/render/workspace/totals.h"
#include "kernels/base/frame_types.h"

namespace wavepath {

class Workspace;

// Of one piece of work, once it is done.
struct Finished {
  double seconds = 0.0;          // that it kept the device
  double longest_dispatch = 0.0; // 0 where dispatches are not timed
  double device_seconds = 0.0;   // of all timed dispatches
};

class WaveQueue {
public:
  // `workspace` outlives the queue.
  explicit WaveQueue(Workspace& workspace);
  WaveQueue(WaveQueue&&) = delete;

  struct Work {
    std::uint32_t timed_dispatches = 0;
    const char* stage = nullptr;     // the whole is counted as time of this stage, where its dispatches are not timed
    std::optional<gpu::Wave> wave{}; // whose slots non-finite samples are counted by
    std::function<void(const Finished&)> done{}; // called when it was waited for
  };
  // Records and submits; waits first where two pieces are in flight already. All work is done in the order in which it
  // was submitted.
  void submit(const std::function<void(Commands&)>& record, Work work);
  // Calls `action` when all that was submitted so far has been waited for: at once if nothing is in flight.
  void afterwards(std::function<void()> action);
  // Waits for the oldest piece. False if there was none.
  bool finish_one();
  void drain();
  // Waits for all that is in flight, and forgets it: nothing is counted, nothing called.
  void abandon() noexcept;

  Totals totals;

private:
  struct WaveResources { // what one of the two pieces in flight uses
    explicit WaveResources(Device& device);
    Commands commands;
    Buffer counters; // read back
  };
  struct Flight {
    WaveResources* resources;
    Work work;
    Clock::time_point submitted;
    std::vector<std::function<void()>> afterwards;
  };
  Finished count(Flight& flight);
  void count_counters(const gpu::Counters& counters, const std::optional<gpu::Wave>& wave);
  void count_time(const std::string& name, double seconds);

  Workspace& workspace_;
  std::array<WaveResources, 2> resources_;
  std::size_t next_resources_ = 0;
  std::deque<Flight> in_flight_;
  Clock::time_point last_finished_{};
};

} // namespace wavepath
