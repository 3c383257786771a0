#include "host/integrators/path/path_tracer.h"

#include <algorithm>

namespace wavepath {

void PathTracer::change(const View&, const RenderSettings& settings, Past) {
  paths_.change(settings, kAllPathStages, 0);
}

std::uint32_t PathTracer::timed_dispatches() const { return std::min(2 + (workspace_.frame.max_depth + 1) * 5, 1024u); }

void PathTracer::record_wave(Commands& commands, std::size_t band, const gpu::Wave& wave) {
  const KernelSet& kernels = paths_.kernels();
  const std::uint32_t bounces = workspace_.frame.max_depth + 1;
  const bool connects = workspace_.frame.light_count > 0;
  commands.bind(paths_.bindings(band));
  commands.dispatch(kernels[kGenerate], groups_for(std::uint64_t{wave.pixel_count} * wave.sample_count), &wave);
  for (std::uint32_t bounce = 0; bounce < bounces; ++bounce) {
    paths_.extend(commands, kernels, wave, bounce);
    paths_.shade(commands, kernels, wave, bounce);
    if (connects && bounce + 1 < bounces)
      paths_.connect(commands, kernels, wave, bounce); // the last one only collects emission
  }
  commands.barrier();
  commands.dispatch(kernels[kAccumulate], groups_for(wave.pixel_count), &wave);
}

} // namespace wavepath
