#include "host/integrators/hybrid/frame_filter.h"

namespace wavepath {
namespace {

// By FrameFilter::OwnBuffer. A filter of one pass finds no edges for another.
const std::vector<BufferRule> kFrameFilterRules = {
    {"frame",
     [](const BufferDimensions&) { return std::uint64_t{sizeof(gpu::Reprojection)}; },
     {{gpu::kFilterReprojection, BindingKind::uniform}}},
    {"result", vec4_a_pixel, {{gpu::kFilterColorOut, BindingKind::storage}}},
    {"edges",
     [](const BufferDimensions& e) { return e.options > 1 ? e.pixels * sizeof(gpu::uint) : 0; },
     {{gpu::kFilterEdges, BindingKind::storage}}},
};

} // namespace

FrameFilter::FrameFilter(Device& device, std::span<const KernelCode> passes, std::uint32_t width, std::uint32_t height,
                         const Buffer& gbuffer, const Buffer& color)
    : width_(width), height_(height), bands_(device, width, height), buffers_(device, kFrameFilterRules) {
  buffers_.fit({.pixels = std::uint64_t{width} * height, .options = static_cast<std::uint32_t>(passes.size())});
  std::vector<Binding> bindings = {{gpu::kFilterGbuffer, BindingKind::texels_rgba32ui, &gbuffer},
                                   {gpu::kFilterColorIn, BindingKind::texels_rgba32f, &color}};
  buffers_.add_bindings(bindings);
  set_ = std::make_unique<BindingSet>(device, bindings, static_cast<std::uint32_t>(sizeof(gpu::FilterBand)));
  for (const KernelCode& pass : passes)
    kernels_.emplace_back(device, pass.name, pass.spirv, *set_, std::span<const std::uint32_t>{});
}

void FrameFilter::record(Commands& commands) {
  const gpu::Reprojection frame = reproject({}, {}, false, width_, height_);
  commands.write(buffers_[kFrame], &frame, sizeof(frame));
  commands.bind(*set_);
  for (const Kernel& kernel : kernels_) bands_.run(commands, kernel);
}

} // namespace wavepath
