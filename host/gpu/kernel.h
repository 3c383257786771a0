// Compute kernels, and the sets of buffers and images that they are bound to. One BindingSet can serve many kernels.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <vulkan/vulkan.h>

#include "host/gpu/buffer.h"
#include "host/gpu/device.h"
#include "host/gpu/image.h"
#include "host/gpu/texels_as_storage.h"
#include "kernels/base/gpu.h"

namespace wavepath {

// Kinds of bindings: a buffer as uniform block, storage block or texels of a format; or an image.
enum class BindingKind {
  uniform,
  storage,
  texels_rgba32f,
  texels_rgba32ui,
  texels_rg32ui,
  texels_r32ui,
  texels_r32f,
  sampled_image, // sampler2D, usampler2D, sampler2DShadow, or an array of such layers
};

constexpr bool is_texels(BindingKind kind) {
  return kind >= BindingKind::texels_rgba32f && kind <= BindingKind::texels_r32f;
}

// The buffer or the image outlives the set. Whenever kernels run, the image is for ImageUse::sampled.
struct Binding {
  std::uint32_t slot = 0;
  BindingKind kind = BindingKind::storage;
  const Buffer* buffer = nullptr;     // for all kinds but sampled_image
  const DeviceImage* image = nullptr; // for sampled_image
  Aspect aspect = Aspect::main;       // aspect of the image
  Sampling sampling{};
  // For texels, which kernels read as storage blocks if DeviceInfo::has_few_texels. `is_small`: they stay texels,
  // because they are few on any device or leave the block to others. `words`: binding of the storage block over the
  // same memory, through which they are read.
  bool is_small = false;
  std::uint32_t words = gpu::kNone;
};

// Numbers and kinds of bindings, which is all that compiling needs to know of them.
class BindingLayout {
public:
  static constexpr VkShaderStageFlags kRasterStages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;

  // `stages`: the shaders that see the bindings, besides compute. The bindings may lack their buffers. Throws Error if
  // they are more than the device allows.
  BindingLayout(Device& device, std::span<const Binding> bindings, std::uint32_t push_constant_bytes,
                VkShaderStageFlags stages = 0);
  ~BindingLayout();
  BindingLayout(BindingLayout&&) = delete;

  VkPipelineLayout layout() const { return pipeline_layout_; }
  VkShaderStageFlags stages() const { return stages_; }
  std::uint32_t push_constant_bytes() const { return push_constant_bytes_; }
  // Equal words for layouts that pipelines may be made with one of and used with the other.
  std::vector<std::uint32_t> description() const;
  // Texels that shaders have to see as storage blocks: the first ones, that the device has room for.
  std::span<const StorageTexels> storage_texels() const { return storage_texels_; }

protected:
  // None of those that are seen through another.
  std::optional<VkDescriptorType> type_of(const Binding& binding) const;

  Device* device_;
  VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;

private:
  void choose_storage_texels(std::span<const Binding> bindings);
  void release();

  std::vector<StorageTexels> storage_texels_;
  std::vector<std::uint32_t> slots_; // each with its VkDescriptorType
  std::uint32_t push_constant_bytes_;
  VkShaderStageFlags stages_;
  VkPipelineLayout pipeline_layout_ = VK_NULL_HANDLE;
};

// A layout with the descriptors that fill it.
class BindingSet : public BindingLayout {
public:
  // Throws Error as well if a binding exceeds the device's limits.
  BindingSet(Device& device, std::span<const Binding> bindings, std::uint32_t push_constant_bytes,
             VkShaderStageFlags stages = 0);
  ~BindingSet();

  VkDescriptorSet handle() const { return set_; }

private:
  void check_limits(const Binding& binding) const;
  void allocate(std::span<const Binding> bindings);
  void write(std::span<const Binding> bindings);
  VkDescriptorImageInfo image_info(const Binding& binding);
  void release();

  VkDescriptorPool pool_ = VK_NULL_HANDLE;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
  std::vector<VkBufferView> views_;
  std::vector<VkSampler> samplers_;
};

// An embedded kernel: its name for people, its SPIR-V (wavepath_NAME_spv of a generated header), and that of its other
// builds, if there are such: for scenes with layered materials (wavepath_NAME_layered_spv), and with ray queries in
// place of traversal (wavepath_NAME_query_spv, wavepath_NAME_layered_query_spv).
struct KernelCode {
  const char* name = "";
  std::span<const std::uint32_t> spirv;
  std::span<const std::uint32_t> layered{};
  std::span<const std::uint32_t> query{};
  std::span<const std::uint32_t> layered_query{};

  // `has_layers`: the scene has kLobesLayered.
  std::span<const std::uint32_t> build(bool has_layers, bool by_query = false) const {
    if (by_query && !query.empty()) return has_layers && !layered_query.empty() ? layered_query : query;
    return has_layers && !layered.empty() ? layered : spirv;
  }
};

// Workgroups that hold `count` invocations. The caller keeps them below DeviceInfo::max_groups.
inline std::uint32_t groups_for(std::uint64_t count) {
  return static_cast<std::uint32_t>((count + gpu::kWorkgroupSize - 1) / gpu::kWorkgroupSize);
}

// A compute pipeline. `constants[i]` is the value of specialization constant i; those that the kernel lacks are
// ignored.
class Kernel {
public:
  Kernel(Device& device, std::string name, std::span<const std::uint32_t> spirv, const BindingLayout& bindings,
         std::span<const std::uint32_t> constants);
  Kernel(Device& device, const KernelCode& code, const BindingLayout& bindings,
         std::span<const std::uint32_t> constants)
      : Kernel(device, code.name, code.spirv, bindings, constants) {}
  ~Kernel();
  Kernel(Kernel&& other) noexcept;
  Kernel& operator=(Kernel&&) = delete;

  VkPipeline handle() const { return pipeline_; }
  const std::string& name() const { return name_; }

private:
  Device* device_;
  std::string name_;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
  bool is_kept_ = false; // true: the device owns the pipeline
};

} // namespace wavepath
