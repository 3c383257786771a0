#include "host/gpu/barrier.h"

namespace wavepath {

VkPipelineStageFlags2 shader_stages(const Context& context) {
  const VkPipelineStageFlags2 raster =
      context.rasterizes() ? VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT : 0;
  return VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | raster;
}

MemoryAccess used_by_shader_or_copy(const Context& context) {
  return {shader_stages(context) | VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT | VK_PIPELINE_STAGE_2_TRANSFER_BIT,
          VK_ACCESS_2_UNIFORM_READ_BIT | kUsedByKernel.access | kUsedByCopy.access};
}

MemoryAccess written_by_shader_or_copy(const Context& context) {
  return {shader_stages(context) | VK_PIPELINE_STAGE_2_TRANSFER_BIT, kWrittenByKernelOrCopy.access};
}

void record_barriers(VkCommandBuffer commands, std::span<const VkImageMemoryBarrier2> images, const MemoryAccess& from,
                     const MemoryAccess& to) {
  VkMemoryBarrier2 memory{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
  memory.srcStageMask = from.stages;
  memory.srcAccessMask = from.access;
  memory.dstStageMask = to.stages;
  memory.dstAccessMask = to.access;
  VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  info.memoryBarrierCount = from.stages == VK_PIPELINE_STAGE_2_NONE ? 0 : 1;
  info.pMemoryBarriers = &memory;
  info.imageMemoryBarrierCount = static_cast<std::uint32_t>(images.size());
  info.pImageMemoryBarriers = images.data();
  vkCmdPipelineBarrier2(commands, &info);
}

} // namespace wavepath
