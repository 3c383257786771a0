// SPIR-V whose texel buffers are storage blocks, for devices whose texel buffers are too small (DeviceInfo). Kernels
// are written once, with texelFetch(): most drivers read texel buffers faster (README of benchmarks/results), and these
// hold 2^27 elements or more there.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace wavepath {

struct StorageTexels {
  std::uint32_t slot = 0;       // binding number, of descriptor set 0
  std::uint32_t components = 4; // 32-bit components of an element: 1, 2 or 4
  std::uint32_t block = 0;      // binding number of the storage block: the same, or that of one over the same memory
};

// `spirv` is valid, and reads the texel buffers at these slots by texelFetch() and textureSize() alone. The module that
// comes back reads storage blocks there, of tightly packed elements, and computes the same: components that an element
// lacks are 0, 0, 1, as of a texel. Throws Error if a buffer is used in another way.
std::vector<std::uint32_t> texels_as_storage(std::span<const std::uint32_t> spirv,
                                             std::span<const StorageTexels> texels);

} // namespace wavepath
