// Rasterization by dynamic rendering: targets of any attachments, and pipelines whose shaders fetch their own vertices.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <vulkan/vulkan.h>

#include "host/gpu/commands.h"
#include "host/gpu/image.h"
#include "host/gpu/kernel.h"

namespace wavepath {

// Values that an attachment is cleared to: float and fixed-point formats to `colour`, integers to `words`, depth
// formats to `depth` and `stencil`.
struct ClearValue {
  std::array<float, 4> colour{};
  std::array<std::uint32_t, 4> words{};
  float depth = 0.0f;
  std::uint32_t stencil = 0;
};

// An attachment. A list of these declares a target and the pipelines that draw into it. Output i of the fragment shader
// is colour attachment i; at most one format has depth.
struct AttachmentInfo {
  const char* name = ""; // for error messages
  ImageFormat format = ImageFormat::rgba32f;
  bool sampled = false; // kernels sample it
  ClearValue clear{};
  // Image of the target's size and this format, which is drawn into in place of an image of the target's own; null =
  // own image.
  DeviceImage* shared = nullptr;
};

enum class Cull { none, front, back }; // front: counter-clockwise in the picture, whose y axis points down

// Depth clamping and a limit of the bias are optional features of Vulkan, so they are missing here. Without a depth
// attachment there is no test.
struct DepthState {
  bool test = true, write = true;
  Compare compare = Compare::greater;   // "new COMPARE old" draws
  float bias = 0.0f, slope_bias = 0.0f; // in units of the format's resolution there, and of the triangle's slope
};

// In the order of VkStencilOp.
enum class StencilOp { keep, zero, replace, increment_clamp, decrement_clamp, invert, increment_wrap, decrement_wrap };

struct StencilFace {
  StencilOp fail = StencilOp::keep, depth_fail = StencilOp::keep, pass = StencilOp::keep;
  Compare compare = Compare::always; // "(reference & read_mask) COMPARE (old & read_mask)" passes
  std::uint32_t reference = 0, read_mask = 0xff, write_mask = 0xff;
};

struct StencilState {
  StencilFace front, back;
};

// Blending of colours that are drawn over others. The alpha of an attachment is multiplied by one minus the alpha of
// what is drawn: if it is 1 at first, it is the fraction of light that passes all that was drawn. All attachments blend
// alike, because states of their own are an optional feature.
enum class Blend {
  none, // replaced
  over, // colours are attenuated by what is drawn, whose own are multiplied by its alpha already (Porter and Duff 1984)
  sum   // colours are added
};

struct RasterState {
  DepthState depth{};
  std::optional<StencilState> stencil;
  Cull cull = Cull::none;
  Blend blend = Blend::none;
  bool write_colour = true; // into all colour attachments or, for passes that only count or test, into none
};

struct RasterCode {
  const char* name = "";
  std::span<const std::uint32_t> vertex, fragment; // no fragment shader: depth and stencil alone
};

// A pipeline that draws triangles.
class RasterPipeline {
public:
  // `constants[i]` is the value of specialization constant i in both shaders. `bindings` need
  // BindingSet::kRasterStages. Throws Error if the device cannot blend into a format.
  RasterPipeline(Device& device, const RasterCode& code, std::span<const AttachmentInfo> attachments,
                 const RasterState& state, const BindingSet& bindings, std::span<const std::uint32_t> constants);
  ~RasterPipeline();
  RasterPipeline(RasterPipeline&&) = delete;

  VkPipeline handle() const { return pipeline_; }

private:
  Device& device_;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
};

// Vertices and instances of one draw call. There are no vertex buffers: shaders read gl_VertexIndex and
// gl_InstanceIndex.
struct VertexRange {
  std::uint32_t first_vertex = 0, vertex_count = 0, first_instance = 0, instance_count = 1;
};

struct RasterDraw {
  const RasterPipeline* pipeline = nullptr;
  const BindingSet* bindings = nullptr;
  const void* push = nullptr; // bindings->push_constant_bytes() bytes
  std::span<const VertexRange> ranges;
};

inline constexpr std::uint32_t kClearNothing = 0, kClearColour = 1, kClearDepth = 2, kClearStencil = 4, kClearAll = 7;

struct RasterPass {
  std::span<const RasterDraw> draws; // in order
  std::uint32_t clear = kClearAll;   // attachments to clear; the others keep their contents
  std::uint32_t layer = 0;           // layer of all attachments
};

class RasterTarget {
public:
  // Throws Error if the device cannot rasterize, or lacks a format, the size, the number of attachments or the memory.
  RasterTarget(Device& device, std::uint32_t width, std::uint32_t height, std::span<const AttachmentInfo> attachments,
               std::uint32_t layers = 1);
  RasterTarget(RasterTarget&&) = delete;

  // Records the pass. Its shaders see what kernels and copies wrote before, and later kernels may write what they read.
  void draw(Commands& commands, const RasterPass& pass);
  // Records that drawing is over: kernels may sample the attachments declared so, until the next pass.
  void finish(Commands& commands);

  // The image of an attachment, by its index in the list. DeviceImage::copy_to() records a read-back.
  DeviceImage& image(std::size_t attachment) { return *images_[attachment]; }
  const DeviceImage& image(std::size_t attachment) const { return *images_[attachment]; }
  std::uint64_t bytes() const; // memory of the images that the target owns

private:
  VkRenderingAttachmentInfo rendering_info(std::size_t attachment, const RasterPass& pass, std::uint32_t clear) const;
  void begin_rendering(VkCommandBuffer commands, const RasterPass& pass) const;

  VkExtent2D size_;
  std::vector<AttachmentInfo> attachments_;
  std::vector<std::unique_ptr<DeviceImage>> owned_;
  std::vector<DeviceImage*> images_; // for each attachment
};

} // namespace wavepath
