// Images: formats, what an image is used for next, copies between images and buffers, and how kernels sample them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <vulkan/vulkan.h>

#include "host/gpu/barrier.h"
#include "host/gpu/device.h"
#include "host/gpu/memory.h"

namespace wavepath {

class Buffer;

// Every Vulkan 1.3 device draws into and samples the formats but the last two, and filters rgba8, rgba8_srgb and
// rgba16f linearly. Formats beyond these that a device lacks are refused.
enum class ImageFormat {
  rgba8,      // fixed point, 0 to 1
  rgba8_srgb, // the same, colours decoded from sRGB before they are filtered
  rgba16f,
  rgba32f,
  rg32f,
  r32f,
  rgba32ui,
  rg32ui,
  r32ui,
  depth16,
  depth32f,
  depth32f_stencil8,
};

// The part of an image that is copied or sampled: its colour or depth, or the stencil of a depth-stencil format.
enum class Aspect { main, stencil };

const char* format_name(ImageFormat format);
VkFormat vulkan_format(ImageFormat format);
bool has_depth(ImageFormat format);
bool has_stencil(ImageFormat format);
bool holds_integers(ImageFormat format);
std::uint32_t texel_bytes(ImageFormat format, Aspect aspect = Aspect::main); // bytes of a texel in a buffer of a copy

// In the order of VkCompareOp.
enum class Compare { never, less, equal, less_or_equal, greater, not_equal, greater_or_equal, always };
enum class Filter { nearest, linear };
enum class Address { clamp, repeat, border_zero, border_one };

// Sampling of an image by kernels. With `compare` the kernel declares a shadow sampler, which returns the fraction of
// texels of the filter's footprint for which "reference COMPARE depth" holds.
struct Sampling {
  Filter filter = Filter::nearest;
  Address address = Address::clamp;
  std::optional<Compare> compare;
};

// Throws Error if the device cannot sample images of this format so.
VkSampler create_sampler(const Device& device, ImageFormat format, const Sampling& sampling);

// Use of an image. Copies are always allowed; rasterization and sampling are declared in ImageInfo.
enum class ImageUse { nothing, attachment, sampled, copied_from, copied_to };

struct ImageInfo {
  const char* name = "image"; // for error messages
  ImageFormat format = ImageFormat::rgba32f;
  std::uint32_t width = 0, height = 0, layers = 1;
  bool attachment = false; // rasterization draws into it
  bool sampled = false;    // kernels sample it
  bool is_array = false;   // sampled as an array, even with a single layer
};

// A rectangle of an image, and where its copy is in a buffer: its first byte, and the texels from row to row.
struct ImagePart {
  std::uint32_t x = 0, y = 0, width = 0, height = 0;
  std::uint64_t offset = 0;
  std::uint32_t row_texels = 0;
};

// A two-dimensional image without mip levels, or an array of them. It remembers what it was used for last, in the order
// in which commands were recorded; commands have to be submitted in that order.
class DeviceImage {
public:
  // Throws Error, naming the format, if the device lacks the format, the size or the memory.
  DeviceImage(Device& device, const ImageInfo& info);
  ~DeviceImage();
  DeviceImage(DeviceImage&&) = delete;

  const ImageInfo& info() const { return info_; }
  VkImage handle() const { return image_; }
  std::uint64_t bytes() const { return memory_.bytes(); } // of device memory

  // For rasterization: one layer, with all aspects.
  VkImageView layer_view(std::uint32_t layer) const { return layer_views_[layer]; }
  // For descriptors: all layers (sampler2D, or sampler2DArray if there are several), one aspect.
  VkImageView sampled_view(Aspect aspect) const { return sampled_views_[static_cast<std::size_t>(aspect)]; }
  VkImageLayout layout(ImageUse use) const;

  // Records that the image is for `use` next: what was drawn or copied before is visible then. The contents are kept.
  void transition(VkCommandBuffer commands, ImageUse use);
  // The barrier that transition() records; the caller records it.
  VkImageMemoryBarrier2 barrier(ImageUse use);

  // Record copies of all layers, rows and texels without gaps between them, and make them visible to later kernels,
  // copies and, after the fence, the host. The image is for copies afterwards. `offset`: the buffer's first byte, a
  // multiple of 4.
  void copy_to(VkCommandBuffer commands, const Buffer& to, Aspect aspect = Aspect::main, std::uint64_t offset = 0);
  void copy_from(VkCommandBuffer commands, const Buffer& from, Aspect aspect = Aspect::main);
  // The same of a part of one layer, and of parts of the first, the colour alone.
  void copy_from(VkCommandBuffer commands, const Buffer& from, const ImagePart& part, std::uint32_t layer);
  void copy_to(VkCommandBuffer commands, const Buffer& to, std::span<const ImagePart> parts);

private:
  VkBufferImageCopy whole(Aspect aspect) const;
  VkBufferImageCopy region_of(const ImagePart& part, std::uint32_t layer) const;
  void copy_regions(VkCommandBuffer commands, const Buffer& to, std::span<const VkBufferImageCopy> regions);
  void copy_region_from(VkCommandBuffer commands, const Buffer& from, const VkBufferImageCopy& region);
  void create();
  void create_views();
  void release();

  Device& device_;
  ImageInfo info_;
  ImageUse use_ = ImageUse::nothing;
  VkImage image_ = VK_NULL_HANDLE;
  Memory memory_;
  std::vector<VkImageView> layer_views_;
  std::array<VkImageView, 2> sampled_views_{}; // indexed by Aspect
};

} // namespace wavepath
