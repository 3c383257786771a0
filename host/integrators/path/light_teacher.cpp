#include "host/integrators/path/light_teacher.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "host/integrators/path/light_rows.h"
#include "host/render/loop/segments.h"

namespace wavepath {
namespace {

constexpr std::uint64_t kPilotPaths = 1u << 16; // of a small picture; of a larger one, a path a pixel
constexpr std::uint32_t kPilotSeed = 0x6c8e9cf5u;

bool chooses_by_shares(const PackedScene& scene, const RenderSettings& settings) {
  return (kernel_config(scene.features | features_of(settings), scene.stack_size, settings).features &
          gpu::kFeatureLightRows) != 0 &&
         !scene.light_tree.empty();
}

} // namespace

void LightTeacher::change(const RenderSettings& settings) {
  const bool by_shares = chooses_by_shares(workspace_.scene, settings);
  learns_ = by_shares && !settings.light_shares;
  taken_over_ = by_shares ? settings.light_shares : nullptr;
  report_ = {};
  if (by_shares) workspace_.frame.scene_features |= gpu::kFeatureLightRows;
  workspace_.frame.light_sum_scale = static_cast<float>(light_sum_scale(workspace_.scene));
}

void LightTeacher::start() {
  if (taken_over_) paths_.buffers[kLightShares].write(taken_over_->data(), kLightRowBytes);
  if (!learns_) return;
  need_ = {&kPathProgram, stage_bits({kAdvance, kConnect}), paths_.config()};
  need_.config.features |= gpu::kFeatureLearning;
  kernels_.start(need_);
}

Pilot LightTeacher::begin() {
  const std::vector<std::uint32_t> shares = unlearned_light_rows(workspace_.scene);
  paths_.buffers[kLightShares].write(shares.data(), kLightRowBytes);
  paths_.buffers[kLightSums].fill_zero();
  const std::uint64_t pixels = workspace_.film.pixels();
  const auto samples = static_cast<std::uint32_t>(std::max<std::uint64_t>(kPilotPaths / pixels, 1));
  report_.paths = samples * pixels;
  start_ = Clock::now();
  return {even_segments(workspace_.film.bands()), samples, kPilotSeed};
}

void LightTeacher::learn() {
  const auto sums = download<std::uint32_t>(paths_.buffers[kLightSums], kLightSumBytes / sizeof(std::uint32_t));
  LightLesson lesson = learn_light_rows(workspace_.scene, sums);
  paths_.buffers[kLightShares].write(lesson.ends.data(), kLightRowBytes);
  report_.shares = std::make_shared<const std::vector<std::uint32_t>>(std::move(lesson.ends));
  report_.rows = lesson.rows;
  report_.seconds = seconds_since(start_);
}

} // namespace wavepath
