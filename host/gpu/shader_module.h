// A shader on its way into a pipeline: SPIR-V, without what its specialization constants leave unreachable, and these.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <vulkan/vulkan.h>

#include "host/gpu/context.h"
#include "host/gpu/texels_as_storage.h"

namespace wavepath {

class ShaderModule {
public:
  // `name`: for the message of an Error. `constants[i]` is the value of specialization constant i, which the shader may
  // lack. `texels`: see BindingLayout::storage_texels(). Without any SPIR-V it is none.
  ShaderModule(const Context& context, const std::string& name, std::span<const std::uint32_t> spirv,
               std::span<const std::uint32_t> constants, std::span<const StorageTexels> texels = {});
  ~ShaderModule();
  ShaderModule(ShaderModule&&) = delete;

  // Refers to this module, which has to live until the pipeline is made.
  VkPipelineShaderStageCreateInfo stage(VkShaderStageFlagBits stage) const;

private:
  const Context& context_;
  VkShaderModule module_ = VK_NULL_HANDLE;
  std::vector<std::uint32_t> constants_;
  std::vector<VkSpecializationMapEntry> entries_;
  VkSpecializationInfo specialization_{};
};

} // namespace wavepath
