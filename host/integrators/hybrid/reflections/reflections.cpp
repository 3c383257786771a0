#include "host/integrators/hybrid/reflections/reflections.h"

#include <algorithm>

#include "kernels/hybrid/hybrid_types.h"

namespace wavepath {

std::vector<Binding> reflection_layout() {
  using enum BindingKind;
  std::vector<Binding> layout = path_layout();
  layout.insert(layout.end(), {{gpu::kBindHybrid, uniform, nullptr},
                               {gpu::kBindVisibility, texels_rg32ui, nullptr},
                               {gpu::kBindGbuffer, storage, nullptr},
                               {gpu::kBindSignals, storage, nullptr},
                               {gpu::kBindReflections, storage, nullptr},
                               {gpu::kBindReflectionFrame, uniform, nullptr},
                               {gpu::kBindReflectionCounts, storage, nullptr}});
  return layout;
}

Reflections::Reflections(const ReflectionContext& context)
    : context_(context),
      frame_buffer_(context.workspace.device, sizeof(gpu::ReflectionFrame)),
      counts_(context.workspace.device, gpu::kReflectionCounts * sizeof(std::uint32_t)) {}

void Reflections::change(const View&, const RenderPlan& settings, const KernelConfig& config,
                         const std::vector<Binding>& shared) {
  need_ = reflection_need(context_.kind, config, nests_);
  context_.kernels.start(need_);
  frame_.threshold = static_cast<float>(settings.reflection_threshold);
  std::vector<Binding> own = shared;
  own.push_back({gpu::kBindReflectionFrame, BindingKind::uniform, &frame_buffer_});
  own.push_back({gpu::kBindReflectionCounts, BindingKind::storage, &counts_});
  add_bindings(own);
  frame_buffer_.write(&frame_, sizeof(frame_));
  counts_.fill_zero();
  sets_ = bind_bands(context_.workspace, own);
}

void Reflections::submit_pixels(WaveQueue& queue, std::size_t kernel, const char* stage, SliceLength& length) {
  const gpu::Frame& frame = context_.workspace.frame;
  const std::uint64_t most = length.next_frame(), pixels = std::uint64_t{frame.width} * frame.height;
  for (std::uint64_t first = 0; first < pixels; first += most) {
    gpu::Wave wave{};
    wave.first_pixel = static_cast<std::uint32_t>(first);
    wave.pixel_count = static_cast<std::uint32_t>(std::min(most, pixels - first));
    const auto record = [&](Commands& commands) {
      commands.bind(bindings(0));
      commands.dispatch(kernels()[kernel], groups_for(wave.pixel_count), &wave);
    };
    queue.submit(record,
                 {.stage = stage, .done = [&length](const Finished& finished) { length.note(finished.seconds); }});
  }
}

ReflectionReport Reflections::report() const {
  const auto counts = download<std::uint32_t>(counts_, gpu::kReflectionCounts);
  const auto total = [&](std::uint32_t first) { return std::uint64_t{counts[first + 1]} << 32 | counts[first]; };
  return {.asked = total(gpu::kCountAsked), .answered = total(gpu::kCountAnswered)};
}

} // namespace wavepath
