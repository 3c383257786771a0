#include "host/gpu/raster.h"

#include <algorithm>
#include <cassert>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/gpu/pipeline_cache.h"
#include "host/gpu/shader_module.h"
#include "kernels/base/gpu.h"

namespace wavepath {
namespace {

struct Formats {
  std::vector<VkFormat> colour;
  VkFormat depth = VK_FORMAT_UNDEFINED, stencil = VK_FORMAT_UNDEFINED;
};

Formats formats_of(std::span<const AttachmentInfo> attachments) {
  Formats formats;
  for (const AttachmentInfo& attachment : attachments) {
    if (!has_depth(attachment.format)) {
      formats.colour.push_back(vulkan_format(attachment.format));
      continue;
    }
    assert(formats.depth == VK_FORMAT_UNDEFINED && "one depth attachment");
    formats.depth = vulkan_format(attachment.format);
    if (has_stencil(attachment.format)) formats.stencil = formats.depth;
  }
  return formats;
}

VkStencilOpState stencil_face(const StencilFace& face) {
  return {static_cast<VkStencilOp>(face.fail),
          static_cast<VkStencilOp>(face.pass),
          static_cast<VkStencilOp>(face.depth_fail),
          static_cast<VkCompareOp>(face.compare),
          face.read_mask,
          face.write_mask,
          face.reference};
}

VkPipelineDepthStencilStateCreateInfo depth_stencil_state(const RasterState& state, const Formats& formats) {
  VkPipelineDepthStencilStateCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
  info.depthTestEnable = state.depth.test && formats.depth != VK_FORMAT_UNDEFINED;
  info.depthWriteEnable = info.depthTestEnable && state.depth.write;
  info.depthCompareOp = static_cast<VkCompareOp>(state.depth.compare);
  assert(!state.stencil || formats.stencil != VK_FORMAT_UNDEFINED);
  info.stencilTestEnable = state.stencil.has_value();
  if (state.stencil) {
    info.front = stencil_face(state.stencil->front);
    info.back = stencil_face(state.stencil->back);
  }
  return info;
}

VkPipelineRasterizationStateCreateInfo rasterization_state(const RasterState& state) {
  VkPipelineRasterizationStateCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
  info.cullMode = static_cast<VkCullModeFlags>(state.cull);
  info.frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE;
  info.depthBiasEnable = state.depth.bias != 0.0f || state.depth.slope_bias != 0.0f;
  info.depthBiasConstantFactor = state.depth.bias;
  info.depthBiasSlopeFactor = state.depth.slope_bias;
  info.lineWidth = 1.0f;
  return info;
}

void set_blending(Blend blend, VkPipelineColorBlendAttachmentState& state) {
  if (blend == Blend::none) return;
  state.blendEnable = VK_TRUE;
  state.srcColorBlendFactor = VK_BLEND_FACTOR_ONE;
  state.dstColorBlendFactor = blend == Blend::over ? VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA : VK_BLEND_FACTOR_ONE;
  state.srcAlphaBlendFactor = VK_BLEND_FACTOR_ZERO;
  state.dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
  state.colorBlendOp = state.alphaBlendOp = VK_BLEND_OP_ADD;
}

void require_blending(const Device& device, const Formats& formats) {
  for (const VkFormat format : formats.colour) {
    VkFormatProperties properties{};
    vkGetPhysicalDeviceFormatProperties(device.physical(), format, &properties);
    if (!(properties.optimalTilingFeatures & VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BLEND_BIT))
      throw Error(device.info().name, "cannot blend colours of 32 bits", "use --transparency peel");
  }
}

void require_raster(const Device& device, VkExtent2D size, std::size_t colour_count) {
  const std::string& name = device.info().name;
  if (!device.rasterizes()) throw Error(name, "its queue cannot rasterize", "use --integrator path");
  VkPhysicalDeviceProperties properties{};
  vkGetPhysicalDeviceProperties(device.physical(), &properties);
  const VkPhysicalDeviceLimits& limits = properties.limits;
  if (colour_count > limits.maxColorAttachments)
    throw Error(name,
                fmt::format("draws into at most {} images at once, not {}", limits.maxColorAttachments, colour_count),
                "use another device");
  const std::uint32_t width =
      std::min({limits.maxFramebufferWidth, limits.maxImageDimension2D, limits.maxViewportDimensions[0]});
  const std::uint32_t height =
      std::min({limits.maxFramebufferHeight, limits.maxImageDimension2D, limits.maxViewportDimensions[1]});
  if (size.width > width || size.height > height)
    throw Error(name, fmt::format("rasterizes at most {}x{} pixels, not {}x{}", width, height, size.width, size.height),
                "use a smaller --size or --integrator path");
}

constexpr MemoryAccess kReadByShaders{VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT,
                                      VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_UNIFORM_READ_BIT};
// Writes that follow reads need an order, but no access made visible.
constexpr MemoryAccess kShadersDone{kReadByShaders.stages, VK_ACCESS_2_NONE};
constexpr MemoryAccess kKernelOrCopy{kWrittenByKernelOrCopy.stages, VK_ACCESS_2_NONE};

} // namespace

RasterPipeline::RasterPipeline(Device& device, const RasterCode& code, std::span<const AttachmentInfo> attachments,
                               const RasterState& state, const BindingSet& bindings,
                               std::span<const std::uint32_t> constants)
    : device_(device) {
  const ShaderModule vertex(device, code.name, code.vertex, constants, bindings.storage_texels()),
      fragment(device, code.name, code.fragment, constants, bindings.storage_texels());
  const std::array stages{vertex.stage(VK_SHADER_STAGE_VERTEX_BIT), fragment.stage(VK_SHADER_STAGE_FRAGMENT_BIT)};

  const Formats formats = formats_of(attachments);
  const VkPipelineVertexInputStateCreateInfo input{VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
  VkPipelineInputAssemblyStateCreateInfo assembly{VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
  assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  VkPipelineViewportStateCreateInfo viewport{VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
  viewport.viewportCount = viewport.scissorCount = 1;
  const VkPipelineRasterizationStateCreateInfo raster = rasterization_state(state);
  VkPipelineMultisampleStateCreateInfo samples{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
  samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
  const VkPipelineDepthStencilStateCreateInfo depth = depth_stencil_state(state, formats);
  // The same for all attachments, because masks of their own are an optional feature.
  VkPipelineColorBlendAttachmentState mask{};
  if (state.write_colour && !code.fragment.empty()) mask.colorWriteMask = 0xf; // red, green, blue and alpha
  if (state.blend != Blend::none) require_blending(device, formats);
  set_blending(state.blend, mask);
  const std::vector<VkPipelineColorBlendAttachmentState> masks(formats.colour.size(), mask);
  VkPipelineColorBlendStateCreateInfo blend{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
  blend.attachmentCount = static_cast<std::uint32_t>(masks.size());
  blend.pAttachments = masks.data();
  constexpr std::array kDynamicStates{VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
  VkPipelineDynamicStateCreateInfo dynamic{VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO};
  dynamic.dynamicStateCount = kDynamicStates.size();
  dynamic.pDynamicStates = kDynamicStates.data();
  VkPipelineRenderingCreateInfo rendering{VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO};
  rendering.colorAttachmentCount = static_cast<std::uint32_t>(formats.colour.size());
  rendering.pColorAttachmentFormats = formats.colour.data();
  rendering.depthAttachmentFormat = formats.depth;
  rendering.stencilAttachmentFormat = formats.stencil;

  VkGraphicsPipelineCreateInfo info{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO};
  info.pNext = &rendering;
  info.stageCount = code.fragment.empty() ? 1 : 2;
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
        fmt::format("compiling shader {}", code.name).c_str());
}

RasterPipeline::~RasterPipeline() { vkDestroyPipeline(device_.handle(), pipeline_, nullptr); }

RasterTarget::RasterTarget(Device& device, std::uint32_t width, std::uint32_t height,
                           std::span<const AttachmentInfo> attachments, std::uint32_t layers)
    : size_{width, height}, attachments_(attachments.begin(), attachments.end()) {
  require_raster(device, size_, formats_of(attachments).colour.size());
  device.note_rasterizing();
  for (const AttachmentInfo& attachment : attachments_) {
    if (!attachment.shared)
      owned_.push_back(std::make_unique<DeviceImage>(device, ImageInfo{.name = attachment.name,
                                                                       .format = attachment.format,
                                                                       .width = width,
                                                                       .height = height,
                                                                       .layers = layers,
                                                                       .attachment = true,
                                                                       .sampled = attachment.sampled}));
    images_.push_back(attachment.shared ? attachment.shared : owned_.back().get());
    [[maybe_unused]] const ImageInfo& info = images_.back()->info();
    assert(info.attachment && info.format == attachment.format && info.width == width && info.height == height &&
           info.layers == layers && info.sampled >= attachment.sampled);
  }
}

std::uint64_t RasterTarget::bytes() const {
  std::uint64_t bytes = 0;
  for (const std::unique_ptr<DeviceImage>& image : owned_) bytes += image->bytes();
  return bytes;
}

VkRenderingAttachmentInfo RasterTarget::rendering_info(std::size_t attachment, const RasterPass& pass,
                                                       std::uint32_t clear) const {
  const ClearValue& value = attachments_[attachment].clear;
  const ImageFormat format = attachments_[attachment].format;
  VkRenderingAttachmentInfo info{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
  info.imageView = images_[attachment]->layer_view(pass.layer);
  info.imageLayout = images_[attachment]->layout(ImageUse::attachment);
  info.loadOp = (pass.clear & clear) ? VK_ATTACHMENT_LOAD_OP_CLEAR : VK_ATTACHMENT_LOAD_OP_LOAD;
  info.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  if (has_depth(format))
    info.clearValue.depthStencil = {value.depth, value.stencil};
  else if (holds_integers(format))
    std::copy(value.words.begin(), value.words.end(), info.clearValue.color.uint32);
  else
    std::copy(value.colour.begin(), value.colour.end(), info.clearValue.color.float32);
  return info;
}

void RasterTarget::begin_rendering(VkCommandBuffer commands, const RasterPass& pass) const {
  std::vector<VkRenderingAttachmentInfo> colour;
  std::optional<VkRenderingAttachmentInfo> depth, stencil;
  for (std::size_t i = 0; i < attachments_.size(); ++i) {
    if (!has_depth(attachments_[i].format)) {
      colour.push_back(rendering_info(i, pass, kClearColour));
      continue;
    }
    depth = rendering_info(i, pass, kClearDepth);
    if (has_stencil(attachments_[i].format)) stencil = rendering_info(i, pass, kClearStencil);
  }
  VkRenderingInfo info{VK_STRUCTURE_TYPE_RENDERING_INFO};
  info.renderArea.extent = size_;
  info.layerCount = 1;
  info.colorAttachmentCount = static_cast<std::uint32_t>(colour.size());
  info.pColorAttachments = colour.data();
  info.pDepthAttachment = depth ? &*depth : nullptr;
  info.pStencilAttachment = stencil ? &*stencil : nullptr;
  vkCmdBeginRendering(commands, &info);
}

void RasterTarget::draw(Commands& commands, const RasterPass& pass) {
  const VkCommandBuffer to = commands.handle();
  std::vector<VkImageMemoryBarrier2> barriers;
  for (DeviceImage* image : images_) barriers.push_back(image->barrier(ImageUse::attachment));
  record_barriers(to, barriers, kWrittenByKernelOrCopy, kReadByShaders);
  begin_rendering(to, pass);
  const VkViewport viewport{0, 0, static_cast<float>(size_.width), static_cast<float>(size_.height), 0, 1};
  const VkRect2D scissor{{0, 0}, size_};
  vkCmdSetViewport(to, 0, 1, &viewport);
  vkCmdSetScissor(to, 0, 1, &scissor);
  for (const RasterDraw& draw : pass.draws) {
    const BindingSet& bindings = *draw.bindings;
    const VkDescriptorSet set = bindings.handle();
    vkCmdBindDescriptorSets(to, VK_PIPELINE_BIND_POINT_GRAPHICS, bindings.layout(), 0, 1, &set, 0, nullptr);
    if (draw.push)
      vkCmdPushConstants(to, bindings.layout(), bindings.stages(), 0, bindings.push_constant_bytes(), draw.push);
    vkCmdBindPipeline(to, VK_PIPELINE_BIND_POINT_GRAPHICS, draw.pipeline->handle());
    for (const VertexRange& range : draw.ranges)
      vkCmdDraw(to, range.vertex_count, range.instance_count, range.first_vertex, range.first_instance);
  }
  vkCmdEndRendering(to);
  record_barriers(to, {}, kShadersDone, kKernelOrCopy);
}

void RasterTarget::finish(Commands& commands) {
  std::vector<VkImageMemoryBarrier2> barriers;
  for (DeviceImage* image : images_)
    if (image->info().sampled) barriers.push_back(image->barrier(ImageUse::sampled));
  if (barriers.empty()) return;
  record_barriers(commands.handle(), barriers, {}, {});
}

} // namespace wavepath
