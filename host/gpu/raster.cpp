#include "host/gpu/raster.h"

#include <algorithm>
#include <array>
#include <vector>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/gpu/pipeline_cache.h"
#include "kernels/gpu.h"

namespace wavepath {
namespace {

constexpr VkFormat kColourFormat = VK_FORMAT_R32G32_UINT; // every device can draw into it
constexpr VkFormat kDepthFormat = VK_FORMAT_D32_SFLOAT;

struct Module {
  Module(Device& device_, const std::string& name, std::span<const std::uint32_t> spirv) : device(device_) {
    VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    info.codeSize = spirv.size_bytes();
    info.pCode = spirv.data();
    check(vkCreateShaderModule(device.handle(), &info, nullptr, &handle), ("loading shader " + name).c_str());
  }
  ~Module() { vkDestroyShaderModule(device.handle(), handle, nullptr); }
  Module(Module&&) = delete;

  Device& device;
  VkShaderModule handle = VK_NULL_HANDLE;
};

void require_raster(const Device& device, VkExtent2D size) {
  const std::string& name = device.info().name;
  if (!device.rasterizes()) throw Error(name, "its queue cannot rasterize", "use --integrator path");
  VkFormatProperties format{};
  vkGetPhysicalDeviceFormatProperties(device.physical(), kDepthFormat, &format);
  if (!(format.optimalTilingFeatures & VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT))
    throw Error(name, "has no depth buffer of 32-bit floats", "use --integrator path");
  VkPhysicalDeviceProperties properties{};
  vkGetPhysicalDeviceProperties(device.physical(), &properties);
  const VkPhysicalDeviceLimits& limits = properties.limits;
  const std::uint32_t width =
      std::min({limits.maxFramebufferWidth, limits.maxImageDimension2D, limits.maxViewportDimensions[0]});
  const std::uint32_t height =
      std::min({limits.maxFramebufferHeight, limits.maxImageDimension2D, limits.maxViewportDimensions[1]});
  if (size.width > width || size.height > height)
    throw Error(name, fmt::format("rasterizes at most {}x{} pixels, not {}x{}", width, height, size.width, size.height),
                "use a smaller --size or --integrator path");
}

VkImageSubresourceRange whole(VkImageAspectFlags aspect) { return {aspect, 0, 1, 0, 1}; }

struct Use {
  VkImageLayout layout;
  VkPipelineStageFlags2 stages;
  VkAccessFlags2 access;
};
constexpr Use kNotUsed{VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_2_NONE, VK_ACCESS_2_NONE};
constexpr Use kDrawnColour{VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
                           VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT};
constexpr Use kDrawnDepth{
    VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL, // depth alone would be an optional feature
    VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
    VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT};
constexpr Use kCopied{VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_PIPELINE_STAGE_2_COPY_BIT,
                      VK_ACCESS_2_TRANSFER_READ_BIT};

VkImageMemoryBarrier2 transition(VkImage image, VkImageAspectFlags aspect, const Use& from, const Use& to) {
  VkImageMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
  barrier.srcStageMask = from.stages;
  barrier.srcAccessMask = from.access;
  barrier.dstStageMask = to.stages;
  barrier.dstAccessMask = to.access;
  barrier.oldLayout = from.layout;
  barrier.newLayout = to.layout;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image;
  barrier.subresourceRange = whole(aspect);
  return barrier;
}

void record(Commands& commands, std::span<const VkImageMemoryBarrier2> images) {
  VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  info.imageMemoryBarrierCount = static_cast<std::uint32_t>(images.size());
  info.pImageMemoryBarriers = images.data();
  vkCmdPipelineBarrier2(commands.handle(), &info);
}

VkRenderingAttachmentInfo attachment(VkImageView view, VkImageLayout layout, bool first) {
  VkRenderingAttachmentInfo info{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
  info.imageView = view;
  info.imageLayout = layout;
  info.loadOp = first ? VK_ATTACHMENT_LOAD_OP_CLEAR : VK_ATTACHMENT_LOAD_OP_LOAD;
  info.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  return info;
}

} // namespace

RasterPipeline::RasterPipeline(Device& device, const std::string& name, std::span<const std::uint32_t> vertex_spirv,
                               std::span<const std::uint32_t> fragment_spirv, const BindingSet& bindings,
                               std::span<const std::uint32_t> constants)
    : device_(device) {
  const Module vertex(device, name, vertex_spirv), fragment(device, name, fragment_spirv);
  std::vector<VkSpecializationMapEntry> entries;
  for (std::uint32_t i = 0; i < constants.size(); ++i) entries.push_back({i, i * 4, 4});
  const VkSpecializationInfo specialization{static_cast<std::uint32_t>(entries.size()), entries.data(),
                                            constants.size_bytes(), constants.data()};
  std::array<VkPipelineShaderStageCreateInfo, 2> stages{};
  for (VkPipelineShaderStageCreateInfo& stage : stages) {
    stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    stage.pName = "main";
    stage.pSpecializationInfo = &specialization;
  }
  stages[0].stage = VK_SHADER_STAGE_VERTEX_BIT;
  stages[0].module = vertex.handle;
  stages[1].stage = VK_SHADER_STAGE_FRAGMENT_BIT;
  stages[1].module = fragment.handle;

  const VkPipelineVertexInputStateCreateInfo input{VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
  VkPipelineInputAssemblyStateCreateInfo assembly{VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
  assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  VkPipelineViewportStateCreateInfo viewport{VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
  viewport.viewportCount = viewport.scissorCount = 1;
  VkPipelineRasterizationStateCreateInfo raster{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
  raster.lineWidth = 1.0f;
  VkPipelineMultisampleStateCreateInfo samples{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
  samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
  VkPipelineDepthStencilStateCreateInfo depth{VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
  depth.depthTestEnable = depth.depthWriteEnable = VK_TRUE;
  depth.depthCompareOp = VK_COMPARE_OP_GREATER;
  VkPipelineColorBlendAttachmentState words{};
  words.colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT;
  VkPipelineColorBlendStateCreateInfo blend{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
  blend.attachmentCount = 1;
  blend.pAttachments = &words;
  const std::array<VkDynamicState, 2> dynamic_states{VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
  VkPipelineDynamicStateCreateInfo dynamic{VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO};
  dynamic.dynamicStateCount = dynamic_states.size();
  dynamic.pDynamicStates = dynamic_states.data();
  VkPipelineRenderingCreateInfo rendering{VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO};
  rendering.colorAttachmentCount = 1;
  rendering.pColorAttachmentFormats = &kColourFormat;
  rendering.depthAttachmentFormat = kDepthFormat;

  VkGraphicsPipelineCreateInfo info{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO};
  info.pNext = &rendering;
  info.stageCount = stages.size();
  info.pStages = stages.data();
  info.pVertexInputState = &input;
  info.pInputAssemblyState = &assembly;
  info.pViewportState = &viewport;
  info.pRasterizationState = &raster;
  info.pMultisampleState = &samples;
  info.pDepthStencilState = &depth;
  info.pColorBlendState = &blend;
  info.pDynamicState = &dynamic;
  info.layout = bindings.layout();
  check(vkCreateGraphicsPipelines(device.handle(), device.pipeline_cache().handle(), 1, &info, nullptr, &pipeline_),
        ("compiling shader " + name).c_str());
}

RasterPipeline::~RasterPipeline() { vkDestroyPipeline(device_.handle(), pipeline_, nullptr); }

RasterTarget::RasterTarget(Device& device, std::uint32_t width, std::uint32_t height)
    : device_(device), size_{width, height} {
  require_raster(device, size_);
  try {
    create(colour_, kColourFormat, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
           VK_IMAGE_ASPECT_COLOR_BIT);
    create(depth_, kDepthFormat, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, VK_IMAGE_ASPECT_DEPTH_BIT);
  } catch (...) {
    release();
    throw;
  }
}

RasterTarget::~RasterTarget() { release(); }

void RasterTarget::release() {
  for (const Attachment* attachment : {&colour_, &depth_}) {
    vkDestroyImageView(device_.handle(), attachment->view, nullptr);
    vkDestroyImage(device_.handle(), attachment->image, nullptr);
    vkFreeMemory(device_.handle(), attachment->memory, nullptr);
    device_.count_memory(-static_cast<std::int64_t>(attachment->bytes));
  }
}

void RasterTarget::create(Attachment& attachment, VkFormat format, VkImageUsageFlags usage, VkImageAspectFlags aspect) {
  VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = format;
  info.extent = {size_.width, size_.height, 1};
  info.mipLevels = info.arrayLayers = 1;
  info.samples = VK_SAMPLE_COUNT_1_BIT;
  info.tiling = VK_IMAGE_TILING_OPTIMAL;
  info.usage = usage;
  check(vkCreateImage(device_.handle(), &info, nullptr, &attachment.image), "creating a picture to draw into");
  VkMemoryRequirements needs{};
  vkGetImageMemoryRequirements(device_.handle(), attachment.image, &needs);
  VkMemoryAllocateInfo allocate{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
  allocate.allocationSize = needs.size;
  allocate.memoryTypeIndex = device_.memory_type(needs.memoryTypeBits, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
  if (allocate.memoryTypeIndex == gpu::kNone) allocate.memoryTypeIndex = device_.memory_type(needs.memoryTypeBits, 0);
  check(vkAllocateMemory(device_.handle(), &allocate, nullptr, &attachment.memory),
        "finding memory for a picture to draw into");
  attachment.bytes = needs.size;
  device_.count_memory(static_cast<std::int64_t>(attachment.bytes));
  check(vkBindImageMemory(device_.handle(), attachment.image, attachment.memory, 0), "binding memory");
  VkImageViewCreateInfo view{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
  view.image = attachment.image;
  view.viewType = VK_IMAGE_VIEW_TYPE_2D;
  view.format = format;
  view.subresourceRange = whole(aspect);
  check(vkCreateImageView(device_.handle(), &view, nullptr, &attachment.view), "creating a view of a picture");
}

void RasterTarget::draw(Commands& commands, const RasterPipeline& pipeline, const BindingSet& bindings,
                        const void* push, std::span<const VertexRange> ranges, bool first) {
  const VkCommandBuffer to = commands.handle();
  // What the last picture was used for has been waited for; what earlier slices of this one drew is kept.
  record(commands,
         std::array{transition(colour_.image, VK_IMAGE_ASPECT_COLOR_BIT, first ? kNotUsed : kDrawnColour, kDrawnColour),
                    transition(depth_.image, VK_IMAGE_ASPECT_DEPTH_BIT, first ? kNotUsed : kDrawnDepth, kDrawnDepth)});
  VkRenderingAttachmentInfo colour = attachment(colour_.view, kDrawnColour.layout, first);
  colour.clearValue.color = {.uint32 = {gpu::kNone, gpu::kNone, 0, 0}};
  VkRenderingAttachmentInfo depth = attachment(depth_.view, kDrawnDepth.layout, first);
  depth.clearValue.depthStencil.depth = 0.0f;
  VkRenderingInfo rendering{VK_STRUCTURE_TYPE_RENDERING_INFO};
  rendering.renderArea.extent = size_;
  rendering.layerCount = 1;
  rendering.colorAttachmentCount = 1;
  rendering.pColorAttachments = &colour;
  rendering.pDepthAttachment = &depth;
  vkCmdBeginRendering(to, &rendering);

  const VkViewport viewport{0, 0, static_cast<float>(size_.width), static_cast<float>(size_.height), 0, 1};
  const VkRect2D scissor{{0, 0}, size_};
  vkCmdSetViewport(to, 0, 1, &viewport);
  vkCmdSetScissor(to, 0, 1, &scissor);
  const VkDescriptorSet set = bindings.handle();
  vkCmdBindDescriptorSets(to, VK_PIPELINE_BIND_POINT_GRAPHICS, bindings.layout(), 0, 1, &set, 0, nullptr);
  vkCmdPushConstants(to, bindings.layout(), bindings.stages(), 0, bindings.push_constant_bytes(), push);
  vkCmdBindPipeline(to, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline.handle());
  for (const VertexRange& range : ranges)
    vkCmdDraw(to, range.vertex_count, range.instance_count, range.first_vertex, range.first_instance);
  vkCmdEndRendering(to);
}

void RasterTarget::copy(Commands& commands, const Buffer& to) {
  record(commands, std::array{transition(colour_.image, VK_IMAGE_ASPECT_COLOR_BIT, kDrawnColour, kCopied)});
  VkBufferImageCopy region{};
  region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  region.imageExtent = {size_.width, size_.height, 1};
  vkCmdCopyImageToBuffer(commands.handle(), colour_.image, kCopied.layout, to.handle(), 1, &region);
  commands.barrier();
}

} // namespace wavepath
