// Runs a probe kernel: storage buffers in and out, one invocation an element, on the device that the tests use.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "host/gpu/commands.h"
#include "kernels/base/gpu.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {

// One storage buffer of a probe, at the binding of its position in the list. Its bytes go in and come back.
using ProbeBuffer = std::vector<std::byte>;

template <class T>
ProbeBuffer to_probe(const std::vector<T>& values) {
  ProbeBuffer bytes(values.size() * sizeof(T));
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}
template <class T>
std::vector<T> from_probe(const ProbeBuffer& bytes) {
  std::vector<T> values(bytes.size() / sizeof(T));
  std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return values;
}

// Dispatches ceil(invocations / kWorkgroupSize) groups of `spirv` (local size kWorkgroupSize, storage buffers 0..n-1 of
// set 0, specialization constants by id) and reads every buffer back. The probe gets `invocations` as a uint push
// constant.
inline void run_probe(Device& device, std::span<const std::uint32_t> spirv, std::uint32_t invocations,
                      std::vector<ProbeBuffer>& buffers, std::span<const std::uint32_t> constants = {}) {
  std::vector<Buffer> memory;
  std::vector<Binding> bindings;
  for (const ProbeBuffer& bytes : buffers) memory.push_back(upload(device, bytes));
  for (std::uint32_t i = 0; i < memory.size(); ++i) bindings.push_back({i, BindingKind::storage, &memory[i]});
  const BindingSet set(device, bindings, sizeof(std::uint32_t));
  const Kernel kernel(device, "probe", spirv, set, constants);
  Commands commands(device);
  commands.bind(set);
  commands.dispatch(kernel, (invocations + gpu::kWorkgroupSize - 1) / gpu::kWorkgroupSize, &invocations);
  commands.submit_and_wait();
  for (std::size_t i = 0; i < buffers.size(); ++i)
    if (!buffers[i].empty()) memory[i].read(buffers[i].data(), buffers[i].size());
}

} // namespace wavepath::test
