#include "host/integrators/path/path_tracer.h"

#include <algorithm>

#include "host/integrators/path/light_rows.h"
#include "host/render/loop/segments.h"

namespace wavepath {
namespace {

constexpr std::uint64_t kPilotPaths = 1u << 16; // of a small picture; of a larger one, a path a pixel
constexpr std::uint32_t kLightPilotSeed = 0x6c8e9cf5u;

bool learns_lights(const PackedScene& scene, const RenderSettings& settings) {
  return (kernel_config(scene.features | features_of(settings), scene.stack_size, settings).features &
          gpu::kFeatureLightRows) != 0 && !scene.light_tree.empty();
}

} // namespace

void PathTracer::change(const View&, const RenderSettings& settings, Past) {
  learns_ = learns_lights(workspace_.scene, settings);
  if (learns_) workspace_.frame.scene_features |= gpu::kFeatureLightRows;
  workspace_.frame.light_sum_scale = static_cast<float>(light_sum_scale(workspace_.scene));
  paths_.change(settings, kAllPathStages, learns_ ? kRoomForLightSums : 0);
  exploring_ = false;
  pilot_ = {};
  if (!learns_) return;
  pilot_need_ = {&kPathProgram, stage_bits({kAdvance, kConnect}), paths_.config()};
  pilot_need_.config.features |= gpu::kFeatureLightPilot;
  kernels_.start(pilot_need_);
}

bool PathTracer::is_ready() {
  const bool paths = paths_.is_ready(); // asks for both, so that both are begun
  return (!learns_ || kernels_.ready(pilot_need_)) && paths;
}

double PathTracer::get_ready() {
  const double pilot = learns_ ? kernels_.best(pilot_need_).seconds() : 0.0;
  return pilot + paths_.get_ready();
}

std::optional<Pilot> PathTracer::pilot() {
  if (!learns_) return std::nullopt;
  exploring_ = true;
  const std::vector<std::uint32_t> shares = unlearned_light_rows(workspace_.scene);
  paths_.buffers[kLightShares].write(shares.data(), kLightRowBytes);
  paths_.buffers[kLightSums].fill_zero();
  const std::uint64_t pixels = workspace_.film.pixels();
  const auto samples = static_cast<std::uint32_t>(std::max<std::uint64_t>(kPilotPaths / pixels, 1));
  pilot_.paths = samples * pixels;
  pilot_start_ = Clock::now();
  return Pilot{even_segments(workspace_.film.bands()), samples, kLightPilotSeed};
}

void PathTracer::learn() {
  exploring_ = false;
  const auto sums = download<std::uint32_t>(paths_.buffers[kLightSums], kLightSumBytes / sizeof(std::uint32_t));
  const LightLesson lesson = learn_light_rows(workspace_.scene, sums);
  paths_.buffers[kLightShares].write(lesson.ends.data(), kLightRowBytes);
  pilot_.rows = lesson.rows;
  pilot_.seconds = seconds_since(pilot_start_);
}

void PathTracer::describe(RenderResult& result) const { result.light_pilot = pilot_; }

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
      paths_.connect(commands, exploring_ ? kernels_.best(pilot_need_) : kernels, wave, bounce); // the last one only collects emission
  }
  commands.barrier();
  commands.dispatch(kernels[kAccumulate], groups_for(wave.pixel_count), &wave);
}

} // namespace wavepath
