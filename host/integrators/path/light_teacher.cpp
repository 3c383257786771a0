#include "host/integrators/path/light_teacher.h"

#include <algorithm>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "host/integrators/path/light_rows.h"
#include "host/integrators/path/sky_rows.h"
#include "host/render/loop/segments.h"

namespace wavepath {
namespace {

constexpr std::uint64_t kPilotPaths = 1u << 16; // of a small picture; of a larger one, a path a pixel
constexpr std::uint32_t kPilotSeed = 0x6c8e9cf5u;

void append(std::vector<std::uint32_t>& words, std::span<const std::uint32_t> more) {
  words.insert(words.end(), more.begin(), more.end());
}

gpu::Feature features_for(const PackedScene& scene, const RenderSettings& settings) {
  return kernel_config(scene.features | features_of(settings), scene.stack_size, settings).features;
}

bool chooses_by_shares(const PackedScene& scene, const RenderSettings& settings) {
  return (features_for(scene, settings) & gpu::kFeatureLightRows) != 0 && !scene.light_tree.empty();
}

bool chooses_parts_of_sky(const PackedScene& scene, const RenderSettings& settings) {
  return (features_for(scene, settings) & gpu::kFeatureLearnedSky) != 0 && !scene.environment_ends.empty() &&
         scene.environment_probability > 0.0f;
}

} // namespace

void LightTeacher::change(const RenderSettings& settings) {
  of_lights_ = chooses_by_shares(workspace_.scene, settings);
  of_sky_ = chooses_parts_of_sky(workspace_.scene, settings);
  const bool by_shares = of_lights_ || of_sky_;
  learns_ = by_shares && !settings.light_shares;
  taken_over_ = by_shares ? settings.light_shares : nullptr;
  report_ = {};
  if (of_lights_) workspace_.frame.scene_features |= gpu::kFeatureLightRows;
  if (of_sky_) workspace_.frame.scene_lobes |= static_cast<std::uint32_t>(gpu::kFeatureLearnedSky >> 32);
  workspace_.frame.light_sum_scale = static_cast<float>(light_sum_scale(workspace_.scene));
}

void LightTeacher::use(const std::vector<std::uint32_t>& shares) {
  paths_.buffers[kLightShares].write(shares.data(), shares.size() * sizeof(shares[0]));
}

void LightTeacher::start() {
  if (taken_over_) use(*taken_over_);
  if (!learns_) return;
  need_ = {&kPathProgram, stage_bits({kAdvance, kConnect}), paths_.config()};
  need_.config.features |= gpu::kFeatureLearning;
  kernels_.start(need_);
}

Pilot LightTeacher::begin() {
  std::vector<std::uint32_t> shares;
  if (of_lights_) shares = unlearned_light_rows(workspace_.scene);
  if (of_sky_) append(shares, unlearned_sky_rows());
  use(shares);
  paths_.buffers[kLightSums].fill_zero();
  const std::uint64_t pixels = workspace_.film.pixels();
  const auto samples = static_cast<std::uint32_t>(std::max<std::uint64_t>(kPilotPaths / pixels, 1));
  report_.paths = samples * pixels;
  start_ = Clock::now();
  return {even_segments(workspace_.film.bands()), samples, kPilotSeed};
}

void LightTeacher::learn() {
  const std::uint64_t of_lights = of_lights_ ? kLightSumBytes : 0, of_sky = of_sky_ ? kSkySumBytes : 0;
  const auto words = download<std::uint32_t>(paths_.buffers[kLightSums], (of_lights + of_sky) / sizeof(std::uint32_t));
  const std::span sums(words);
  std::vector<std::uint32_t> shares;
  if (of_lights_) {
    LightLesson lesson = learn_light_rows(workspace_.scene, sums.first(of_lights / sizeof(std::uint32_t)));
    report_.rows = lesson.rows;
    shares = std::move(lesson.ends);
  }
  if (of_sky_) {
    const SkyLesson lesson = learn_sky_rows(sums.last(of_sky / sizeof(std::uint32_t)));
    report_.sky_rows = lesson.rows;
    append(shares, lesson.ends);
  }
  use(shares);
  report_.shares = std::make_shared<const std::vector<std::uint32_t>>(std::move(shares));
  report_.seconds = seconds_since(start_);
}

} // namespace wavepath
