#include "host/gpu/kept_pipelines.h"

#include <utility>

namespace wavepath {

VkPipeline KeptPipelines::of(std::vector<std::uint32_t> key, const std::function<VkPipeline()>& make) {
  std::promise<VkPipeline> promise;
  std::unique_lock lock(mutex_);
  const auto [found, is_new] = pipelines_.try_emplace(std::move(key), promise.get_future().share());
  const std::shared_future<VkPipeline> pipeline = found->second;
  lock.unlock();
  if (!is_new) return pipeline.get();
  try {
    promise.set_value(make());
  } catch (...) {
    promise.set_exception(std::current_exception());
    lock.lock();
    pipelines_.erase(found);
  }
  return pipeline.get();
}

void KeptPipelines::destroy(VkDevice device) {
  for (const auto& [key, pipeline] : pipelines_) vkDestroyPipeline(device, pipeline.get(), nullptr);
  pipelines_.clear();
}

} // namespace wavepath
