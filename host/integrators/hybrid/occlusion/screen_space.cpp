#include "host/integrators/hybrid/occlusion/screen_space.h"

#include <algorithm>

#include "host/integrators/path/paths.h"
#include "kernels/hybrid/hybrid_types.h"

namespace wavepath {
namespace {

constexpr std::uint64_t kFirstPixels = 1 << 13; // of a slice: a guess

} // namespace

std::vector<Binding> screen_space_layout() {
  std::vector<Binding> layout = workspace_layout();
  layout.push_back({gpu::kBindHybrid, BindingKind::uniform, nullptr});
  layout.push_back({gpu::kBindGbuffer, BindingKind::storage, nullptr});
  layout.push_back({gpu::kBindSignals, BindingKind::storage, nullptr});
  return layout;
}

ScreenSpaceOcclusion::ScreenSpaceOcclusion(Workspace& workspace, KernelCompiler& kernels, const OcclusionKind& kind)
    : workspace_(workspace), kernels_(kernels), kind_(kind), pixels_a_slice_(kFirstPixels), times_(stage()) {}

void ScreenSpaceOcclusion::change(const KernelConfig& config, const std::vector<Binding>& frame) {
  need_ = whole_need(*kind_.program, config);
  kernels_.start(need_);
  std::vector<Binding> bindings = workspace_.bindings(workspace_.film.bands().front()); // it reads no film
  bindings.insert(bindings.end(), frame.begin(), frame.end());
  set_ = std::make_unique<BindingSet>(workspace_.device, bindings, static_cast<std::uint32_t>(sizeof(gpu::Wave)));
}

void ScreenSpaceOcclusion::submit(WaveQueue& queue) {
  const std::uint64_t most = pixels_a_slice_.next_frame();
  const std::uint64_t pixels = std::uint64_t{workspace_.frame.width} * workspace_.frame.height;
  for (std::uint64_t first = 0; first < pixels; first += most) {
    gpu::Wave wave{};
    wave.first_pixel = static_cast<std::uint32_t>(first);
    wave.pixel_count = static_cast<std::uint32_t>(std::min(most, pixels - first));
    const auto record = [&](Commands& commands) {
      commands.bind(*set_);
      commands.dispatch(kernels_.best(need_)[0], groups_for(wave.pixel_count), &wave);
    };
    queue.submit(record, {.stage = stage(),
                          .done = [this](const Finished& finished) { pixels_a_slice_.note(finished.seconds); }});
  }
  queue.afterwards([this, &queue] { times_.note_frame(queue.totals); });
}

} // namespace wavepath
