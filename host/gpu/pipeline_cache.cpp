#include "host/gpu/pipeline_cache.h"

#include <string_view>

#include <fmt/format.h>

#include "host/base/cache_file.h"
#include "host/base/hash.h"
#include "kernels/fingerprint.spv.h"

namespace wavepath {
namespace {

// Everything whose change makes compiled code useless. Drivers check most of it again, but not all of them reliably.
std::uint64_t cache_key(VkPhysicalDevice physical) {
  VkPhysicalDeviceProperties properties{};
  vkGetPhysicalDeviceProperties(physical, &properties);
  const std::string_view uuid(reinterpret_cast<const char*>(properties.pipelineCacheUUID), VK_UUID_SIZE);
  return hash_bytes(fmt::format("{} {} {} {} {} {}", properties.vendorID, properties.deviceID, properties.driverVersion,
                                properties.deviceName, uuid, kKernelsFingerprint));
}

} // namespace

PipelineCache::PipelineCache(VkPhysicalDevice physical, VkDevice device) : device_(device), key_(cache_key(physical)) {
  if (const std::filesystem::path folder = cache_folder(); !folder.empty()) {
    file_ = folder / fmt::format("pipelines-{:016x}", key_);
    on_disk_ = read_cache_file(file_, key_);
  }
  VkPipelineCacheCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO};
  info.initialDataSize = on_disk_.size();
  info.pInitialData = on_disk_.data();
  if (vkCreatePipelineCache(device_, &info, nullptr, &cache_) == VK_SUCCESS) return;
  info.initialDataSize = 0;
  if (vkCreatePipelineCache(device_, &info, nullptr, &cache_) != VK_SUCCESS) cache_ = VK_NULL_HANDLE;
}

PipelineCache::~PipelineCache() {
  save();
  vkDestroyPipelineCache(device_, cache_, nullptr);
}

std::vector<std::uint8_t> PipelineCache::contents() const {
  std::size_t bytes = 0;
  if (!cache_ || vkGetPipelineCacheData(device_, cache_, &bytes, nullptr) != VK_SUCCESS) return {};
  std::vector<std::uint8_t> data(bytes);
  if (vkGetPipelineCacheData(device_, cache_, &bytes, data.data()) != VK_SUCCESS) return {};
  data.resize(bytes);
  return data;
}

void PipelineCache::save() {
  if (file_.empty()) return;
  std::vector<std::uint8_t> data = contents();
  if (data.empty() || data == on_disk_) return;
  writable_ = write_cache_file(file_, key_, data);
  if (writable_) on_disk_ = std::move(data);
}

std::string PipelineCache::describe() const {
  if (file_.empty()) return "off";
  if (!writable_) return fmt::format("{}: cannot be written, compiled kernels are not kept", file_.string());
  return fmt::format("{}: {} bytes", file_.string(), on_disk_.size());
}

} // namespace wavepath
