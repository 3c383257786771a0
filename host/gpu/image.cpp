#include "host/gpu/image.h"

#include <cassert>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/gpu/buffer.h"
#include "kernels/base/gpu.h"

namespace wavepath {
namespace {

struct Format {
  const char* name;
  VkFormat vulkan;
  std::uint32_t bytes; // of a texel's colour or depth
};

// In the order of ImageFormat.
constexpr std::array<Format, 12> kFormats{{{"rgba8", VK_FORMAT_R8G8B8A8_UNORM, 4},
                                           {"rgba8_srgb", VK_FORMAT_R8G8B8A8_SRGB, 4},
                                           {"rgba16f", VK_FORMAT_R16G16B16A16_SFLOAT, 8},
                                           {"rgba32f", VK_FORMAT_R32G32B32A32_SFLOAT, 16},
                                           {"rg32f", VK_FORMAT_R32G32_SFLOAT, 8},
                                           {"r32f", VK_FORMAT_R32_SFLOAT, 4},
                                           {"rgba32ui", VK_FORMAT_R32G32B32A32_UINT, 16},
                                           {"rg32ui", VK_FORMAT_R32G32_UINT, 8},
                                           {"r32ui", VK_FORMAT_R32_UINT, 4},
                                           {"depth16", VK_FORMAT_D16_UNORM, 2},
                                           {"depth32f", VK_FORMAT_D32_SFLOAT, 4},
                                           {"depth32f_stencil8", VK_FORMAT_D32_SFLOAT_S8_UINT, 4}}};

const Format& entry(ImageFormat format) { return kFormats[static_cast<std::size_t>(format)]; }

VkImageAspectFlags aspect_flags(ImageFormat format, Aspect aspect) {
  if (aspect == Aspect::stencil) return VK_IMAGE_ASPECT_STENCIL_BIT;
  return has_depth(format) ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
}

VkImageAspectFlags all_aspects(ImageFormat format) {
  const VkImageAspectFlags main = aspect_flags(format, Aspect::main);
  return has_stencil(format) ? main | VK_IMAGE_ASPECT_STENCIL_BIT : main;
}

VkImageUsageFlags usage_of(const ImageInfo& info) {
  VkImageUsageFlags usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  if (info.sampled) usage |= VK_IMAGE_USAGE_SAMPLED_BIT;
  if (!info.attachment) return usage;
  return usage |
         (has_depth(info.format) ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT);
}

void require_support(const Device& device, const ImageInfo& info) {
  VkImageFormatProperties most{};
  const VkResult result =
      vkGetPhysicalDeviceImageFormatProperties(device.physical(), vulkan_format(info.format), VK_IMAGE_TYPE_2D,
                                               VK_IMAGE_TILING_OPTIMAL, usage_of(info), 0, &most);
  if (result == VK_ERROR_FORMAT_NOT_SUPPORTED)
    throw Error(device.info().name,
                fmt::format("cannot {} {} images ({})",
                            info.attachment && info.sampled ? "draw into and sample"
                            : info.attachment               ? "draw into"
                            : info.sampled                  ? "sample"
                                                            : "copy",
                            format_name(info.format), info.name),
                "use another device");
  check(result, "asking for the limits of an image");
  if (info.width > most.maxExtent.width || info.height > most.maxExtent.height || info.layers > most.maxArrayLayers)
    throw Error(device.info().name,
                fmt::format("holds {} images of at most {}x{} pixels and {} layers, not {}x{} and {} ({})",
                            format_name(info.format), most.maxExtent.width, most.maxExtent.height, most.maxArrayLayers,
                            info.width, info.height, info.layers, info.name),
                "use a smaller --size or another device");
}

// Accesses of a use. Writes stand in both scopes of a barrier: draws and copies follow one another into the same image.
MemoryAccess memory_access(const Device& device, ImageFormat format, ImageUse use) {
  switch (use) {
    case ImageUse::nothing:
      return {};
    case ImageUse::attachment:
      if (has_depth(format))
        return {VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
                VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT};
      return {VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
              VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT};
    case ImageUse::sampled:
      return {shader_stages(device), VK_ACCESS_2_SHADER_SAMPLED_READ_BIT};
    case ImageUse::copied_from:
      return {VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_READ_BIT};
    default:
      return {VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT};
  }
}

} // namespace

const char* format_name(ImageFormat format) { return entry(format).name; }
VkFormat vulkan_format(ImageFormat format) { return entry(format).vulkan; }
bool has_depth(ImageFormat format) { return format >= ImageFormat::depth16; }
bool has_stencil(ImageFormat format) { return format == ImageFormat::depth32f_stencil8; }

bool holds_integers(ImageFormat format) { return format >= ImageFormat::rgba32ui && format <= ImageFormat::r32ui; }

std::uint32_t texel_bytes(ImageFormat format, Aspect aspect) {
  return aspect == Aspect::stencil ? 1 : entry(format).bytes;
}

VkSampler create_sampler(const Device& device, ImageFormat format, const Sampling& sampling) {
  const auto refuse = [&](const char* what) {
    throw Error(device.info().name, fmt::format("cannot {} {} images", what, format_name(format)),
                "use another device");
  };
  VkFormatProperties properties{};
  vkGetPhysicalDeviceFormatProperties(device.physical(), vulkan_format(format), &properties);
  const VkFormatFeatureFlags has = properties.optimalTilingFeatures;
  if (!(has & VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT)) refuse("sample");
  const bool linear = sampling.filter == Filter::linear;
  if (linear && !(has & VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT)) refuse("linearly filter");
  if (sampling.compare && !has_depth(format)) refuse("compare depths of");

  constexpr std::array<VkSamplerAddressMode, 4> kAddresses{
      VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE, VK_SAMPLER_ADDRESS_MODE_REPEAT, VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_BORDER,
      VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_BORDER};
  VkSamplerCreateInfo info{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
  info.magFilter = info.minFilter = linear ? VK_FILTER_LINEAR : VK_FILTER_NEAREST;
  info.mipmapMode = VK_SAMPLER_MIPMAP_MODE_NEAREST;
  info.addressModeU = info.addressModeV = info.addressModeW = kAddresses[static_cast<std::size_t>(sampling.address)];
  info.compareEnable = sampling.compare.has_value();
  info.compareOp = static_cast<VkCompareOp>(sampling.compare.value_or(Compare::never));
  const bool one = sampling.address == Address::border_one;
  if (holds_integers(format))
    info.borderColor = one ? VK_BORDER_COLOR_INT_OPAQUE_WHITE : VK_BORDER_COLOR_INT_TRANSPARENT_BLACK;
  else
    info.borderColor = one ? VK_BORDER_COLOR_FLOAT_OPAQUE_WHITE : VK_BORDER_COLOR_FLOAT_TRANSPARENT_BLACK;
  VkSampler sampler = VK_NULL_HANDLE;
  check(vkCreateSampler(device.handle(), &info, nullptr, &sampler), "creating a sampler");
  return sampler;
}

DeviceImage::DeviceImage(Device& device, const ImageInfo& info) : device_(device), info_(info) {
  require_support(device, info);
  try {
    create();
    create_views();
  } catch (...) {
    release();
    throw;
  }
}

DeviceImage::~DeviceImage() { release(); }

void DeviceImage::release() {
  for (VkImageView view : layer_views_) vkDestroyImageView(device_.handle(), view, nullptr);
  for (VkImageView view : sampled_views_) vkDestroyImageView(device_.handle(), view, nullptr);
  vkDestroyImage(device_.handle(), image_, nullptr);
}

void DeviceImage::create() {
  VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = vulkan_format(info_.format);
  info.extent = {info_.width, info_.height, 1};
  info.mipLevels = 1;
  info.arrayLayers = info_.layers;
  info.samples = VK_SAMPLE_COUNT_1_BIT;
  info.tiling = VK_IMAGE_TILING_OPTIMAL;
  info.usage = usage_of(info_);
  check(vkCreateImage(device_.handle(), &info, nullptr, &image_), "creating an image");
  VkMemoryRequirements needs{};
  vkGetImageMemoryRequirements(device_.handle(), image_, &needs);
  if (!memory_.allocate(device_, needs, kDeviceLocal))
    throw Error(device_.info().name,
                fmt::format("no memory for a {} image of {:.1f} MiB ({})", format_name(info_.format),
                            needs.size / 1048576.0, info_.name),
                "use a smaller --size or scene, or close other programs");
  check(vkBindImageMemory(device_.handle(), image_, memory_.handle(), 0), "binding memory");
}

void DeviceImage::create_views() {
  const auto view = [&](VkImageAspectFlags aspects, VkImageViewType type, std::uint32_t layer, std::uint32_t layers) {
    VkImageViewCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
    info.image = image_;
    info.viewType = type;
    info.format = vulkan_format(info_.format);
    info.subresourceRange = {aspects, 0, 1, layer, layers};
    VkImageView result = VK_NULL_HANDLE;
    check(vkCreateImageView(device_.handle(), &info, nullptr, &result), "creating a view of an image");
    return result;
  };
  for (std::uint32_t i = 0; info_.attachment && i < info_.layers; ++i)
    layer_views_.push_back(view(all_aspects(info_.format), VK_IMAGE_VIEW_TYPE_2D, i, 1));
  if (!info_.sampled) return;
  const VkImageViewType type = info_.layers > 1 || info_.is_array ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : VK_IMAGE_VIEW_TYPE_2D;
  for (const Aspect aspect : {Aspect::main, Aspect::stencil})
    if (aspect == Aspect::main || has_stencil(info_.format))
      sampled_views_[static_cast<std::size_t>(aspect)] =
          view(aspect_flags(info_.format, aspect), type, 0, info_.layers);
}

VkImageLayout DeviceImage::layout(ImageUse use) const {
  switch (use) {
    case ImageUse::nothing:
      return VK_IMAGE_LAYOUT_UNDEFINED;
    // Layouts of depth alone or stencil alone are an optional feature.
    case ImageUse::attachment:
      return has_depth(info_.format) ? VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL
                                     : VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    case ImageUse::sampled:
      return VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL; // depth that nothing draws into, too
    case ImageUse::copied_from:
      return VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    default:
      return VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
  }
}

VkImageMemoryBarrier2 DeviceImage::barrier(ImageUse use) {
  assert(use != ImageUse::nothing);
  const MemoryAccess from = memory_access(device_, info_.format, use_), to = memory_access(device_, info_.format, use);
  VkImageMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
  barrier.srcStageMask = from.stages;
  barrier.srcAccessMask = from.access;
  barrier.dstStageMask = to.stages;
  barrier.dstAccessMask = to.access;
  barrier.oldLayout = layout(use_);
  barrier.newLayout = layout(use);
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image_;
  barrier.subresourceRange = {all_aspects(info_.format), 0, 1, 0, info_.layers};
  use_ = use;
  return barrier;
}

void DeviceImage::transition(VkCommandBuffer commands, ImageUse use) {
  record_barriers(commands, std::array{barrier(use)}, {}, {});
}

VkBufferImageCopy DeviceImage::whole(Aspect aspect) const {
  VkBufferImageCopy region{};
  region.imageSubresource = {aspect_flags(info_.format, aspect), 0, 0, info_.layers};
  region.imageExtent = {info_.width, info_.height, 1};
  return region;
}

VkBufferImageCopy DeviceImage::region_of(const ImagePart& part, std::uint32_t layer) const {
  VkBufferImageCopy region = whole(Aspect::main);
  region.bufferOffset = part.offset;
  region.bufferRowLength = part.row_texels;
  region.imageSubresource.baseArrayLayer = layer;
  region.imageSubresource.layerCount = 1;
  region.imageOffset = {static_cast<std::int32_t>(part.x), static_cast<std::int32_t>(part.y), 0};
  region.imageExtent = {part.width, part.height, 1};
  return region;
}

void DeviceImage::copy_to(VkCommandBuffer commands, const Buffer& to, Aspect aspect, std::uint64_t offset) {
  assert(to.bytes() >=
         offset + std::uint64_t{info_.width} * info_.height * info_.layers * texel_bytes(info_.format, aspect));
  VkBufferImageCopy region = whole(aspect);
  region.bufferOffset = offset;
  copy_regions(commands, to, {&region, 1});
}

void DeviceImage::copy_to(VkCommandBuffer commands, const Buffer& to, std::span<const ImagePart> parts) {
  std::vector<VkBufferImageCopy> regions;
  for (const ImagePart& part : parts) regions.push_back(region_of(part, 0));
  copy_regions(commands, to, regions);
}

void DeviceImage::copy_regions(VkCommandBuffer commands, const Buffer& to, std::span<const VkBufferImageCopy> regions) {
  record_barriers(commands, std::array{barrier(ImageUse::copied_from)}, kWrittenByKernelOrCopy, kUsedByCopy);
  vkCmdCopyImageToBuffer(commands, image_, layout(use_), to.handle(), static_cast<std::uint32_t>(regions.size()),
                         regions.data());
  record_barrier(commands, kWrittenByCopy, used_by_shader_or_copy(device_));
}

void DeviceImage::copy_from(VkCommandBuffer commands, const Buffer& from, Aspect aspect) {
  assert(from.bytes() >= std::uint64_t{info_.width} * info_.height * info_.layers * texel_bytes(info_.format, aspect));
  copy_region_from(commands, from, whole(aspect));
}

void DeviceImage::copy_from(VkCommandBuffer commands, const Buffer& from, const ImagePart& part, std::uint32_t layer) {
  assert(layer < info_.layers);
  copy_region_from(commands, from, region_of(part, layer));
}

void DeviceImage::copy_region_from(VkCommandBuffer commands, const Buffer& from, const VkBufferImageCopy& region) {
  record_barriers(commands, std::array{barrier(ImageUse::copied_to)}, kWrittenByKernelOrCopy, kUsedByCopy);
  vkCmdCopyBufferToImage(commands, from.handle(), image_, layout(use_), 1, &region);
  record_barrier(commands, kWrittenByCopy, used_by_shader_or_copy(device_));
}

} // namespace wavepath
