// Pipelines of kernels that stay as long as their device, so that kernels of the same code and bindings share one:
// whoever compiles for many scenes in one process, as tests do, compiles most kernels once.
#pragma once

#include <cstdint>
#include <functional>
#include <future>
#include <map>
#include <mutex>
#include <vector>

#include <vulkan/vulkan.h>

namespace wavepath {

class KeptPipelines {
public:
  KeptPipelines() = default;
  KeptPipelines(KeptPipelines&&) = delete;

  // The pipeline that `key` describes: code, constants and bindings. `make` makes it where there is none yet. A thread
  // that asks for what another one makes waits for it. Throws what making threw, and tries again the next time.
  VkPipeline of(std::vector<std::uint32_t> key, const std::function<VkPipeline()>& make);

  // Destroys all pipelines, which must not be used any more.
  void destroy(VkDevice device);

private:
  std::mutex mutex_;
  std::map<std::vector<std::uint32_t>, std::shared_future<VkPipeline>> pipelines_;
};

} // namespace wavepath
