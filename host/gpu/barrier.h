// Barriers: which accesses come before which, no wider than what the program does.
#pragma once

#include <span>

#include <vulkan/vulkan.h>

#include "host/gpu/context.h"

namespace wavepath {

// One side of a barrier.
struct MemoryAccess {
  VkPipelineStageFlags2 stages = VK_PIPELINE_STAGE_2_NONE;
  VkAccessFlags2 access = VK_ACCESS_2_NONE;
};

inline constexpr MemoryAccess kWrittenByKernel{VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_WRITE_BIT};
// Indirect reads of group counts included.
inline constexpr MemoryAccess kUsedByKernel{
    VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT,
    VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_SHADER_WRITE_BIT | VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT};
inline constexpr MemoryAccess kWrittenByCopy{VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT};
inline constexpr MemoryAccess kUsedByCopy{VK_PIPELINE_STAGE_2_TRANSFER_BIT,
                                          VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT};
inline constexpr MemoryAccess kWrittenByKernelOrCopy{
    VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_TRANSFER_BIT,
    VK_ACCESS_2_SHADER_WRITE_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT};
inline constexpr MemoryAccess kReadByHost{VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT};
// Across submissions, where neither side knows the other.
inline constexpr MemoryAccess kWritten{VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_WRITE_BIT};
inline constexpr MemoryAccess kUsed{VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                    VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT};

// The stages in which shaders run on this queue: one that cannot rasterize does not know vertices and fragments.
VkPipelineStageFlags2 shader_stages(const Context& context);
// Buffers that shaders or copies use.
MemoryAccess used_by_shader_or_copy(const Context& context);
MemoryAccess written_by_shader_or_copy(const Context& context);

// Records barriers: of `images`, and, unless `from` is empty, of all memory from the accesses `from` to those of `to`.
void record_barriers(VkCommandBuffer commands, std::span<const VkImageMemoryBarrier2> images, const MemoryAccess& from,
                     const MemoryAccess& to);
inline void record_barrier(VkCommandBuffer commands, const MemoryAccess& from, const MemoryAccess& to) {
  record_barriers(commands, {}, from, to);
}

} // namespace wavepath
