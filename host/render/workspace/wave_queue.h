// Submits work to the device with two pieces in flight: the device executes one while the host records the next.
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

// Times of a finished piece of work.
struct Finished {
  double seconds = 0.0;          // time that the device spent on it
  double longest_dispatch = 0.0; // 0 if dispatches are not timed
  double device_seconds = 0.0;   // sum over all timed dispatches
};

class WaveQueue {
public:
  // `workspace` must outlive the queue.
  explicit WaveQueue(Workspace& workspace);
  WaveQueue(WaveQueue&&) = delete;

  struct Work {
    std::uint32_t timed_dispatches = 0;
    const char* stage = nullptr;     // stage that the whole time is counted under, if its dispatches are not timed
    std::optional<gpu::Wave> wave{}; // wave by whose slots non-finite samples are located
    std::function<void(const Finished&)> done{}; // called after it was waited for
  };
  // Records and submits work. If two pieces are in flight, waits for the older one first. Pieces execute in the order
  // of submission.
  void submit(const std::function<void(Commands&)>& record, Work work);
  // Calls `action` when all work submitted so far has been waited for; at once if nothing is in flight.
  void afterwards(std::function<void()> action);
  // Waits for the oldest piece. Returns false if nothing is in flight.
  bool finish_one();
  void drain();
  // Waits for all work in flight and discards its results: no counts, no callbacks.
  void abandon() noexcept;

  Totals totals;

private:
  struct WaveResources { // resources of one of the two pieces in flight
    explicit WaveResources(Device& device);
    Commands commands;
    Buffer counters; // copy that the host reads
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
