#include "host/integrators/hybrid/taa.h"

#include "kernels/hybrid/taa.spv.h"

namespace wavepath {

Taa::Taa(Device& device, std::uint32_t width, std::uint32_t height, const Buffer& gbuffer, const Buffer& color)
    : width_(width),
      height_(height),
      bands_(device, width, height),
      reprojection_(device, sizeof(gpu::Reprojection)),
      result_(device, std::uint64_t{width} * height * sizeof(gpu::vec4)) {
  for (Buffer& history : history_) history = Buffer(device, result_.bytes());
  for (std::uint32_t turn = 0; turn < 2; ++turn) {
    const std::array<Binding, 6> bindings = {
        {{gpu::kFilterReprojection, BindingKind::uniform, &reprojection_},
         {gpu::kFilterGbuffer, BindingKind::texels_rgba32ui, &gbuffer},
         {gpu::kFilterColorIn, BindingKind::texels_rgba32f, &color},
         {gpu::kFilterColorOut, BindingKind::storage, &result_},
         {gpu::kFilterHistoryBefore, BindingKind::texels_rgba32f, &history_[1 - turn]},
         {gpu::kFilterHistoryNow, BindingKind::storage, &history_[turn]}}};
    sets_[turn] = std::make_unique<BindingSet>(device, bindings, static_cast<std::uint32_t>(sizeof(gpu::FilterBand)));
  }
  kernel_ = std::make_unique<Kernel>(device, "taa", wavepath_taa_spv, *sets_[0], std::span<const std::uint32_t>{});
}

void Taa::record(Commands& commands, const gpu::CameraView& now) {
  const gpu::Reprojection frames = reproject(now, before_, remembers_, width_, height_);
  commands.write(reprojection_, &frames, sizeof(frames));
  turn_ = 1 - turn_;
  commands.bind(*sets_[turn_]);
  bands_.run(commands, *kernel_);
  before_ = now;
  remembers_ = true;
}

void Taa::forget() { remembers_ = false; }

std::uint64_t Taa::bytes() const {
  return reprojection_.bytes() + result_.bytes() + history_[0].bytes() + history_[1].bytes();
}

std::uint32_t Taa::dispatches() const { return bands_.count(); }

} // namespace wavepath
