#include "host/gpu/kernel.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/gpu/device_limit.h"
#include "host/gpu/pipeline_cache.h"
#include "host/gpu/shader_module.h"
#include "host/gpu/trim_spirv.h"

namespace wavepath {
namespace {

struct TexelFormat {
  VkFormat format;
  std::uint64_t bytes;
};

VkDescriptorType descriptor_type(BindingKind kind) {
  if (kind == BindingKind::uniform) return VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
  if (kind == BindingKind::storage) return VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
  if (kind == BindingKind::sampled_image) return VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
  return VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
}

TexelFormat texel_format(BindingKind kind) {
  switch (kind) {
    case BindingKind::texels_rgba32f:
      return {VK_FORMAT_R32G32B32A32_SFLOAT, 16};
    case BindingKind::texels_rgba32ui:
      return {VK_FORMAT_R32G32B32A32_UINT, 16};
    case BindingKind::texels_rg32ui:
      return {VK_FORMAT_R32G32_UINT, 8};
    case BindingKind::texels_r32ui:
      return {VK_FORMAT_R32_UINT, 4};
    default:
      return {VK_FORMAT_R32_SFLOAT, 4};
  }
}

// Texel buffers and images share one limit of a stage.
void check_count(const DeviceInfo& info, std::span<const Binding> bindings) {
  const auto sampled = static_cast<std::uint32_t>(std::count_if(bindings.begin(), bindings.end(), [](const Binding& b) {
    return b.kind != BindingKind::uniform && b.kind != BindingKind::storage;
  }));
  const auto storage = static_cast<std::uint32_t>(std::ranges::count(bindings, BindingKind::storage, &Binding::kind));
  const auto bound = [&](const char* what, std::uint32_t count, std::uint32_t most) {
    if (count > most)
      throw DeviceLimit(info.name, fmt::format("kernels see at most {} {}, not {}", most, what, count),
                        "use another device or --integrator");
  };
  bound("texel buffers and images", sampled, info.max_sampled);
  bound("storage buffers", storage, info.max_storage);
}

} // namespace

BindingLayout::BindingLayout(Device& device, std::span<const Binding> bindings, std::uint32_t push_constant_bytes,
                             VkShaderStageFlags stages)
    : device_(&device), push_constant_bytes_(push_constant_bytes), stages_(stages | VK_SHADER_STAGE_COMPUTE_BIT) {
  check_count(device.info(), bindings);
  choose_storage_texels(bindings);
  std::vector<VkDescriptorSetLayoutBinding> slots;
  for (const Binding& binding : bindings)
    if (const auto type = type_of(binding)) slots.push_back({binding.slot, *type, 1, stages_, nullptr});
  for (const VkDescriptorSetLayoutBinding& slot : slots)
    slots_.insert(slots_.end(), {slot.binding, static_cast<std::uint32_t>(slot.descriptorType)});
  VkDescriptorSetLayoutCreateInfo set_info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
  set_info.bindingCount = static_cast<std::uint32_t>(slots.size());
  set_info.pBindings = slots.data();
  check(vkCreateDescriptorSetLayout(device.handle(), &set_info, nullptr, &set_layout_), "creating a layout");

  const VkPushConstantRange range{stages_, 0, push_constant_bytes_};
  VkPipelineLayoutCreateInfo layout_info{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  layout_info.setLayoutCount = 1;
  layout_info.pSetLayouts = &set_layout_;
  layout_info.pushConstantRangeCount = push_constant_bytes_ ? 1 : 0;
  layout_info.pPushConstantRanges = &range;
  try {
    check(vkCreatePipelineLayout(device.handle(), &layout_info, nullptr, &pipeline_layout_), "creating a layout");
  } catch (...) {
    release();
    throw;
  }
}

void BindingLayout::choose_storage_texels(std::span<const Binding> bindings) {
  if (!device_->info().has_few_texels) return;
  auto count = static_cast<std::uint32_t>(std::ranges::count(bindings, BindingKind::storage, &Binding::kind));
  for (const Binding& binding : bindings) {
    const bool through_another = binding.words != gpu::kNone;
    const bool fits = through_another || (!binding.is_small && count < device_->info().max_storage);
    if (!is_texels(binding.kind) || !fits) continue;
    const auto components = static_cast<std::uint32_t>(texel_format(binding.kind).bytes / 4);
    storage_texels_.push_back({binding.slot, components, through_another ? binding.words : binding.slot});
    count += !through_another;
  }
}

std::optional<VkDescriptorType> BindingLayout::type_of(const Binding& binding) const {
  const auto found = std::ranges::find(storage_texels_, binding.slot, &StorageTexels::slot);
  if (found == storage_texels_.end()) return descriptor_type(binding.kind);
  if (found->block != binding.slot) return {};
  return VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
}

std::vector<std::uint32_t> BindingLayout::description() const {
  std::vector<std::uint32_t> words = slots_;
  for (const StorageTexels& texels : storage_texels_)
    words.insert(words.end(), {texels.slot, texels.components, texels.block});
  words.insert(words.end(), {static_cast<std::uint32_t>(slots_.size()), push_constant_bytes_, stages_});
  return words;
}

BindingLayout::~BindingLayout() { release(); }

void BindingLayout::release() {
  vkDestroyPipelineLayout(device_->handle(), pipeline_layout_, nullptr);
  vkDestroyDescriptorSetLayout(device_->handle(), set_layout_, nullptr);
}

BindingSet::BindingSet(Device& device, std::span<const Binding> bindings, std::uint32_t push_constant_bytes,
                       VkShaderStageFlags stages)
    : BindingLayout(device, bindings, push_constant_bytes, stages) {
  for (const Binding& binding : bindings) check_limits(binding);
  try {
    allocate(bindings);
    write(bindings);
  } catch (...) {
    release();
    throw;
  }
}

BindingSet::~BindingSet() { release(); }

void BindingSet::release() {
  for (VkBufferView view : views_) vkDestroyBufferView(device_->handle(), view, nullptr);
  for (VkSampler sampler : samplers_) vkDestroySampler(device_->handle(), sampler, nullptr);
  vkDestroyDescriptorPool(device_->handle(), pool_, nullptr);
}

// Drivers cut off a binding beyond the device's limits without a message, so it is refused.
void BindingSet::check_limits(const Binding& binding) const {
  if (binding.kind == BindingKind::sampled_image) return;
  const DeviceInfo& info = device_->info();
  const std::uint64_t bytes = binding.buffer->bytes();
  const bool texels = type_of(binding) == VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
  const std::uint64_t limit =
      texels ? info.max_texel_elements * texel_format(binding.kind).bytes : info.max_storage_range;
  if (bytes > limit)
    throw DeviceLimit(
        info.name,
        fmt::format("a buffer of {:.0f} MiB exceeds its limit of {:.0f} MiB", bytes / 1048576.0, limit / 1048576.0),
        "use a smaller scene or --size, or another device");
}

void BindingSet::allocate(std::span<const Binding> bindings) {
  std::vector<VkDescriptorPoolSize> sizes;
  for (const Binding& binding : bindings)
    if (const auto type = type_of(binding)) sizes.push_back({*type, 1});
  VkDescriptorPoolCreateInfo pool_info{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  pool_info.maxSets = 1;
  pool_info.poolSizeCount = static_cast<std::uint32_t>(sizes.size());
  pool_info.pPoolSizes = sizes.data();
  check(vkCreateDescriptorPool(device_->handle(), &pool_info, nullptr, &pool_), "creating a descriptor pool");
  VkDescriptorSetAllocateInfo allocate{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  allocate.descriptorPool = pool_;
  allocate.descriptorSetCount = 1;
  allocate.pSetLayouts = &set_layout_;
  check(vkAllocateDescriptorSets(device_->handle(), &allocate, &set_), "allocating descriptors");
}

void BindingSet::write(std::span<const Binding> bindings) {
  std::vector<VkDescriptorBufferInfo> infos(bindings.size());
  std::vector<VkDescriptorImageInfo> images(bindings.size());
  std::vector<VkWriteDescriptorSet> writes;
  views_.resize(bindings.size(), VK_NULL_HANDLE);
  for (std::size_t i = 0; i < bindings.size(); ++i) {
    const Binding& binding = bindings[i];
    const auto type = type_of(binding);
    if (!type) continue;
    VkWriteDescriptorSet one{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
    one.dstSet = set_;
    one.dstBinding = binding.slot;
    one.descriptorCount = 1;
    one.descriptorType = *type;
    if (one.descriptorType == VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER) {
      VkBufferViewCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO};
      info.buffer = binding.buffer->handle();
      info.format = texel_format(binding.kind).format;
      info.range = VK_WHOLE_SIZE;
      check(vkCreateBufferView(device_->handle(), &info, nullptr, &views_[i]), "creating a texel view");
      one.pTexelBufferView = &views_[i];
    } else if (binding.kind == BindingKind::sampled_image) {
      images[i] = image_info(binding);
      one.pImageInfo = &images[i];
    } else {
      infos[i] = {binding.buffer->handle(), 0, VK_WHOLE_SIZE};
      one.pBufferInfo = &infos[i];
    }
    writes.push_back(one);
  }
  vkUpdateDescriptorSets(device_->handle(), static_cast<std::uint32_t>(writes.size()), writes.data(), 0, nullptr);
}

VkDescriptorImageInfo BindingSet::image_info(const Binding& binding) {
  // Comparison is of depths; a stencil value is an integer, which has no linear filter.
  [[maybe_unused]] const bool stencil = binding.aspect == Aspect::stencil;
  assert(binding.image->sampled_view(binding.aspect) && "ImageInfo::sampled");
  assert(!stencil || (binding.sampling.filter == Filter::nearest && !binding.sampling.compare));
  samplers_.push_back(create_sampler(*device_, binding.image->info().format, binding.sampling));
  return {samplers_.back(), binding.image->sampled_view(binding.aspect), binding.image->layout(ImageUse::sampled)};
}

Kernel::Kernel(Device& device, std::string name, std::span<const std::uint32_t> spirv, const BindingLayout& bindings,
               std::span<const std::uint32_t> constants)
    : device_(&device), name_(std::move(name)) {
  const auto make = [&] {
    const ShaderModule module(device, name_, spirv, constants, bindings.storage_texels());
    VkComputePipelineCreateInfo info{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
    if (device.use() == DeviceUse::compile) info.flags = VK_PIPELINE_CREATE_CAPTURE_STATISTICS_BIT_KHR;
    info.stage = module.stage(VK_SHADER_STAGE_COMPUTE_BIT);
    info.layout = bindings.layout();
    VkPipeline pipeline = VK_NULL_HANDLE;
    check(vkCreateComputePipelines(device.handle(), device.pipeline_cache().handle(), 1, &info, nullptr, &pipeline),
          ("compiling kernel " + name_).c_str());
    return pipeline;
  };
  KeptPipelines* kept = device.kept_pipelines();
  if (!kept) {
    pipeline_ = make();
    return;
  }
  std::vector<std::uint32_t> key = bindings.description();
  const std::vector<std::uint32_t> does = what_spirv_does(spirv, constants);
  key.insert(key.end(), does.begin(), does.end());
  pipeline_ = kept->of(std::move(key), make);
  is_kept_ = true;
}

Kernel::Kernel(Kernel&& other) noexcept
    : device_(other.device_),
      name_(std::move(other.name_)),
      pipeline_(std::exchange(other.pipeline_, VK_NULL_HANDLE)),
      is_kept_(other.is_kept_) {}

Kernel::~Kernel() {
  if (!is_kept_) vkDestroyPipeline(device_->handle(), pipeline_, nullptr);
}

} // namespace wavepath
