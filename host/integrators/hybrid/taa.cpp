#include "host/integrators/hybrid/taa.h"

#include "kernels/hybrid/taa.spv.h"

namespace wavepath {
namespace {

// By Taa::OwnBuffer. The histories are bound by hand, because they swap roles every turn.
const std::vector<BufferRule> kTaaRules = {
    {"reprojection",
     [](const BufferDimensions&) { return std::uint64_t{sizeof(gpu::Reprojection)}; },
     {{gpu::kFilterReprojection, BindingKind::uniform}}},
    {"result", vec4_a_pixel, {{gpu::kFilterColorOut, BindingKind::storage}}},
    {"history 0", vec4_a_pixel, {}},
    {"history 1", vec4_a_pixel, {}},
};

} // namespace

Taa::Taa(Device& device, std::uint32_t width, std::uint32_t height, const Buffer& gbuffer, const Buffer& color,
         std::span<const KernelCode> joining)
    : width_(width), height_(height), bands_(device, width, height), buffers_(device, kTaaRules) {
  buffers_.fit({.pixels = std::uint64_t{width} * height});
  for (std::uint32_t parity = 0; parity < 2; ++parity) {
    std::vector<Binding> bindings = {
        {gpu::kFilterGbuffer, BindingKind::texels_rgba32ui, &gbuffer},
        {gpu::kFilterColorIn, BindingKind::texels_rgba32f, &color},
        {gpu::kFilterHistoryBefore, BindingKind::texels_rgba32f, &buffers_[kHistory + 1 - parity]},
        {gpu::kFilterHistoryNow, BindingKind::storage, &buffers_[kHistory + parity]}};
    buffers_.add_bindings(bindings);
    sets_[parity] = std::make_unique<BindingSet>(device, bindings, static_cast<std::uint32_t>(sizeof(gpu::FilterBand)));
  }
  const KernelCode code = joining.empty() ? KernelCode{"taa", wavepath_taa_spv} : joining.front();
  kernel_ = std::make_unique<Kernel>(device, code.name, code.spirv, *sets_[0], std::span<const std::uint32_t>{});
}

void Taa::record(Commands& commands, const gpu::CameraView& now, std::uint32_t place) {
  const gpu::Reprojection frames = reproject(now, before_, remembers_, width_, height_);
  commands.write(buffers_[kReprojection], &frames, sizeof(frames));
  parity_ = 1 - parity_;
  commands.bind(*sets_[parity_]);
  bands_.run(commands, *kernel_, place);
  before_ = now;
  remembers_ = true;
}

void Taa::forget() { remembers_ = false; }

} // namespace wavepath
