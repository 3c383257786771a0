// What the driver made of our kernels, kept on disk from run to run: one file for a driver, a device and a build.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <vulkan/vulkan.h>

namespace wavepath {

class PipelineCache {
public:
  // Begins with what cache_folder() holds for this device, or empty. Never fails: without a cache kernels compile as ever.
  PipelineCache(VkPhysicalDevice physical, VkDevice device);
  ~PipelineCache(); // saves
  PipelineCache(PipelineCache&&) = delete;

  VkPipelineCache handle() const { return cache_; } // null if the driver refuses to make one

  // Writes it unless it is what was read. A folder that cannot be written is no error.
  void save();

  // For people: where it is, and what came of it.
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
