// Buffers by declaration: each has a name, a size rule and its bindings. Allocation, bindings, byte counts and dummies
// are derived from these.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host/gpu/kernel.h"
#include "kernels/base/features.h"

namespace wavepath {

// Quantities that the sizes of buffers depend on.
struct BufferDimensions {
  std::uint64_t pixels = 0;
  std::uint64_t slots = 0;         // paths in flight
  gpu::Feature features = 0;       // kFeature bits of all kernels that may run
  std::uint32_t options = 0;       // bits, whose meaning the owner of the buffers defines
  std::uint32_t shadow_queues = 1; // of shadow rays; each has an entry for every path
};

struct BufferView {
  std::uint32_t slot;
  BindingKind kind;
};

struct BufferRule {
  const char* name;
  // Size in bytes; 0 = not needed, so kernels are bound to a dummy. Null = the owner makes the buffer.
  std::uint64_t (*bytes)(const BufferDimensions&);
  std::vector<BufferView> views;
};

class BufferSet {
public:
  // `rules` must outlive the set.
  BufferSet(Device& device, std::span<const BufferRule> rules)
      : device_(&device), rules_(rules), buffers_(rules.size()) {}

  // Replaces buffers that are too small, whose contents are lost. Returns true if any was replaced. Throws Error if the
  // device has no memory for it.
  bool fit(const BufferDimensions& dimensions);

  Buffer& operator[](std::size_t rule) { return buffers_[rule]; }
  const Buffer& operator[](std::size_t rule) const { return buffers_[rule]; }
  void add_bindings(std::vector<Binding>& bindings) const;
  std::uint64_t bytes() const;

private:
  Device* device_;
  std::span<const BufferRule> rules_;
  std::vector<Buffer> buffers_;
};

// Adds binding numbers and kinds without buffers, for layouts.
void add_layout(std::span<const BufferRule> rules, std::vector<Binding>& bindings);

// Replaces `buffer` if it is smaller than `bytes`; its contents are lost then. Returns true if it was replaced.
bool reserve(Device& device, Buffer& buffer, std::uint64_t bytes);

} // namespace wavepath
