// The driver's pipeline cache, kept on disk between runs: one file per driver, device and build.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <vulkan/vulkan.h>

namespace wavepath {

class PipelineCache {
public:
  // Begins with what cache_folder() holds for this device, or empty. Never fails: without a cache, kernels are
  // compiled.
  PipelineCache(VkPhysicalDevice physical, VkDevice device);
  ~PipelineCache(); // saves
  PipelineCache(PipelineCache&&) = delete;

  VkPipelineCache handle() const { return cache_; } // null if the driver refuses to make one

  // Writes the file unless it holds the same already. A folder that cannot be written is no error.
  void save();

  // Description for the user: the file and its size, or the reason why there is none.
  std::string describe() const;

private:
  std::vector<std::uint8_t> contents() const;

  VkDevice device_;
  VkPipelineCache cache_ = VK_NULL_HANDLE;
  std::filesystem::path file_; // empty: not kept
  std::uint64_t key_ = 0;
  std::vector<std::uint8_t> on_disk_;
  bool writable_ = true;
};

} // namespace wavepath
