// A command buffer: recorded, handed to the device, waited for, recorded anew; with a time for every kernel it ran.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <vulkan/vulkan.h>

#include "host/gpu/kernel.h"

namespace wavepath {

struct KernelTime {
  const Kernel* kernel = nullptr;
  double seconds = 0.0;
};

// Ticks from one timestamp to a later one, of which the lowest `bits` count: they wrap, those of 36 bits within minutes
// or an hour.
constexpr std::uint64_t ticks_between(std::uint64_t from, std::uint64_t to, std::uint32_t bits) {
  return (to - from) & (bits < 64 ? (std::uint64_t{1} << bits) - 1 : ~std::uint64_t{0});
}

// Pool, command buffer, fence and timestamps are made once, however often it is recorded.
class Commands {
public:
  // Begins recording. `timed_dispatches`: how many dispatches at most are timed; none on a queue without timestamps.
  explicit Commands(Device& device, std::uint32_t timed_dispatches = 0);
  ~Commands(); // waits for what is in flight
  Commands(Commands&&) = delete;

  // Waits for work in flight, then begins recording anew. Recorded commands run after everything that was submitted to
  // the device before, and see what that wrote.
  void restart(std::uint32_t timed_dispatches);

  VkCommandBuffer handle() const { return commands_; }

  void bind(const BindingSet& bindings);
  // `push`: bindings.push_constant_bytes() bytes; `groups` workgroups along x.
  void dispatch(const Kernel& kernel, std::uint32_t groups, const void* push = nullptr);
  // Group counts are read from `arguments` at `offset`.
  void dispatch_indirect(const Kernel& kernel, const Buffer& arguments, std::uint64_t offset,
                         const void* push = nullptr);
  // Copies `bytes` (a multiple of 4, at most 65536) into `buffer` when the device gets there: after all that was
  // recorded before, visible to all that follows, shaders of rasterization included.
  void write(const Buffer& buffer, const void* data, std::uint64_t bytes);
  // The first `bytes` bytes of a buffer into another, with the same order and visibility. `unordered`: with none, for
  // copies at the beginning or the end of a recording that do not depend on each other.
  enum class Order { after_all, unordered };
  void copy(const Buffer& from, const Buffer& to, std::uint64_t bytes, Order order = Order::after_all);
  // Makes writes of the dispatches so far visible to every dispatch and indirect read that follows.
  void barrier();

  // Ends recording and hands it to the device. Throws Error if the device fails.
  void submit();
  // Until the device has run it. Afterwards times() is known, and mapped memory that it wrote can be read.
  void wait();
  void submit_and_wait() {
    submit();
    wait();
  }
  std::vector<KernelTime> times() const;

private:
  void create();
  void begin(std::uint32_t timed_dispatches);
  void start(const Kernel& kernel, const void* push);
  void stop();
  void write_time(std::uint32_t query);
  void release();

  Device* device_;
  const BindingSet* bindings_ = nullptr;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  VkFence fence_ = VK_NULL_HANDLE;
  VkQueryPool queries_ = VK_NULL_HANDLE;
  std::uint32_t query_capacity_ = 0; // timestamps in the pool
  std::uint32_t query_limit_ = 0;    // limit of this recording
  std::vector<const Kernel*> timed_;
  bool timing_ = false; // the dispatch being recorded is timed
  bool in_flight_ = false;
};

} // namespace wavepath
