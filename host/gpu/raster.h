// Rasterization by dynamic rendering: a pipeline that fetches its own vertices, and the picture of two words a pixel,
// with a depth buffer, that it draws into.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include <vulkan/vulkan.h>

#include "host/gpu/commands.h"
#include "host/gpu/kernel.h"

namespace wavepath {

// What one draw call covers. There are no vertex buffers: the shaders know what the numbers stand for.
struct VertexRange {
  std::uint32_t first_vertex = 0, vertex_count = 0, first_instance = 0, instance_count = 1;
};

// Triangles, whichever way they face; what is nearer has the greater depth, between 1 (near plane) and 0 (infinity). Of
// equal depths the first one drawn stays.
class RasterPipeline {
public:
  // `constants[i]` is the value of specialization constant i in both shaders.
  RasterPipeline(Device& device, const std::string& name, std::span<const std::uint32_t> vertex_spirv,
                 std::span<const std::uint32_t> fragment_spirv, const BindingSet& bindings,
                 std::span<const std::uint32_t> constants);
  ~RasterPipeline();
  RasterPipeline(RasterPipeline&&) = delete;

  VkPipeline handle() const { return pipeline_; }

private:
  Device& device_;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
};

class RasterTarget {
public:
  // Throws Error if the device cannot rasterize, or not so large a picture, or has no memory for it.
  RasterTarget(Device& device, std::uint32_t width, std::uint32_t height);
  ~RasterTarget();
  RasterTarget(RasterTarget&&) = delete;

  // Records `ranges` in order. `first`: the picture is emptied before (words 0xffffffff, depth 0), else what earlier
  // commands drew is kept. `push`: bindings.push_constant_bytes() bytes.
  void draw(Commands& commands, const RasterPipeline& pipeline, const BindingSet& bindings, const void* push,
            std::span<const VertexRange> ranges, bool first);
  // Records the copy of the words into `to`, row by row, for kernels of these and later commands. Ends the picture.
  void copy(Commands& commands, const Buffer& to);

  std::uint64_t bytes() const { return colour_.bytes + depth_.bytes; }

private:
  struct Attachment {
    VkImage image = VK_NULL_HANDLE;
    VkImageView view = VK_NULL_HANDLE;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    std::uint64_t bytes = 0;
  };
  void create(Attachment& attachment, VkFormat format, VkImageUsageFlags usage, VkImageAspectFlags aspect);
  void release();

  Device& device_;
  VkExtent2D size_;
  Attachment colour_, depth_;
};

} // namespace wavepath
