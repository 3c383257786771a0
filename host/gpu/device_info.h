// Properties and abilities of a device.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace wavepath {

// A device as `wavepath info` reports it. `missing` names what the program needs and the device lacks; empty = usable.
struct DeviceInfo {
  std::string name, driver;
  // One of cpu, integrated, discrete, virtual, other. Choices between CPU and GPU depend on it (see WAVEPATH_EMULATE).
  std::string type;
  std::string api; // "1.3.230"
  std::uint32_t subgroup_size = 0;
  std::uint64_t memory_bytes = 0; // largest heap of the device; of an integrated one, largest heap
  std::uint64_t max_storage_range = 0, max_texel_elements = 0, max_allocation = 0;
  std::uint32_t max_groups = 0;
  std::uint32_t max_image_side = 0, max_image_layers = 0;         // limits of 8-bit images that kernels sample
  std::uint64_t max_image_bytes = 0;                              // limit for all layers of such an image
  std::uint32_t max_sampled = 0;                                  // texel buffers and images of a shader
  std::uint32_t max_storage = 0;                                  // storage buffers of a shader
  double timestamp_period_ns = 0.0;                               // 0 = the queue has no timestamps
  std::uint32_t timestamp_bits = 64;                              // valid bits of a timestamp
  bool rasterizes = false;                                        // its queue takes graphics work as well
  bool draws_slowly = false;                                      // slower than computing: see draws_slowly()
  bool has_ray_queries = false;                                   // VK_KHR_ray_query
  std::uint64_t max_query_triangles = 0, max_query_instances = 0; // limits of a structure for ray queries
  // llvmpipe (Mesa 22.3, 25.0): a dispatch is done when the next command begins. But once anything was rasterized, a
  // timestamp is taken at the next flush, which a barrier causes.
  bool dispatches_at_once = false;
  // llvmpipe (Mesa 22.3): all loops of an invocation end after 65,535 rounds together, without a word.
  bool ends_long_loops = false;
  // Scenes do not fit into its texel buffers: kernels read theirs as storage blocks (texels_as_storage.h).
  bool has_few_texels = false;
  // Texels of that size in a binding, where there is room for their storage block.
  std::uint64_t max_texels(std::uint64_t bytes) const {
    return has_few_texels ? max_storage_range / bytes : max_texel_elements;
  }
  std::vector<std::string> missing;
};

// True if a device of this name traces camera rays sooner than it rasterizes the triangles that they would meet:
// NVIDIA's Hopper cards, of whose 66 texture processing clusters two draw (1080p on an H200: 1.6 to 6.9 ms drawn, 0.4
// to 0.9 ms traced). Known by name, because what is drawn and what is traced differ along edges: a choice by the clock
// would change pictures.
bool draws_slowly(const std::string& device_name);

} // namespace wavepath
