#include "host/gpu/shader_module.h"

#include "host/gpu/trim_spirv.h"

namespace wavepath {

ShaderModule::ShaderModule(const Context& context, const std::string& name, std::span<const std::uint32_t> spirv,
                           std::span<const std::uint32_t> constants, std::span<const StorageTexels> texels)
    : context_(context), constants_(constants.begin(), constants.end()) {
  if (spirv.empty()) return;
  const std::vector<std::uint32_t> code = texels_as_storage(trim_spirv(spirv, constants), texels);
  VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
  info.codeSize = code.size() * sizeof(std::uint32_t);
  info.pCode = code.data();
  check(vkCreateShaderModule(context.handle(), &info, nullptr, &module_), ("loading shader " + name).c_str());
  for (std::uint32_t i = 0; i < constants_.size(); ++i) entries_.push_back({i, i * 4, 4});
  specialization_ = {static_cast<std::uint32_t>(entries_.size()), entries_.data(), constants_.size() * 4,
                     constants_.data()};
}

ShaderModule::~ShaderModule() { vkDestroyShaderModule(context_.handle(), module_, nullptr); }

VkPipelineShaderStageCreateInfo ShaderModule::stage(VkShaderStageFlagBits stage) const {
  VkPipelineShaderStageCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
  info.stage = stage;
  info.module = module_;
  info.pName = "main";
  info.pSpecializationInfo = &specialization_;
  return info;
}

} // namespace wavepath
