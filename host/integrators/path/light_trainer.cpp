#include "host/integrators/path/light_trainer.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "host/integrators/path/light_histograms.h"
#include "host/integrators/path/sky_histograms.h"
#include "host/render/loop/segments.h"
#include "host/render/workspace/light_training.h"

namespace wavepath {
namespace {

constexpr std::uint32_t kTrainingSeed = 0x6c8e9cf5u;

// Pilot with about that many paths, of the render's size or smaller. 0: that of parts, at the render's size: as many
// whole samples as fit into kPartTrainingPaths, at least one.
Pilot training_picture(const FilmTarget& film, std::uint64_t paths) {
  const gpu::FilmArea whole = film.shape().area();
  const std::uint64_t pixels = std::uint64_t{whole.whole_width} * whole.whole_height;
  if (paths == 0) paths = pixels * std::max<std::uint64_t>(kPartTrainingPaths / pixels, 1);
  const auto samples = static_cast<std::uint32_t>((paths + pixels - 1) / pixels);
  const double scale = std::sqrt(static_cast<double>(paths) / (static_cast<double>(pixels) * samples));
  const auto scaled = [&](std::uint32_t side) { return std::max(1u, static_cast<std::uint32_t>(scale * side + 0.5)); };
  Pilot pilot{.samples = samples,
              .seed = kTrainingSeed,
              .width = scaled(whole.whole_width),
              .height = scaled(whole.whole_height)};
  pilot.reuses_paths = false; // training measures the value of a light for the whole path
  pilot.segments = pilot.width == film.shape().width && pilot.height == film.shape().height
                       ? even_segments(film.bands())
                       : std::vector<Segment>{{.pixel_count = pilot.width * pilot.height}};
  return pilot;
}

} // namespace

void LightTrainer::change(const RenderPlan& settings) {
  of_lights_ = trains_lights(workspace_.scene, settings);
  of_sky_ = trains_sky(workspace_.scene, settings);
  taken_over_ = {of_lights_ ? settings.training.found.lights : nullptr,
                 of_sky_ ? settings.training.found.sky : nullptr};
  trains_ = (of_lights_ && !taken_over_.lights) || (of_sky_ && !taken_over_.sky); // trains all if one is missing
  training_paths_ = settings.training.paths;
  report_ = {};
  if (of_lights_) workspace_.frame.scene_features |= gpu::kFeatureLightCells;
  if (of_sky_) workspace_.frame.scene_lobes |= static_cast<std::uint32_t>(gpu::kFeatureLearnedSky >> 32);
  workspace_.frame.light_sum_scale =
      static_cast<float>(light_sum_scale(workspace_.scene, trains_one_colour(workspace_.scene, settings)));
}

// Words of the sky lie behind those of lights.
void LightTrainer::use(std::span<const std::uint32_t> lights, std::span<const std::uint32_t> sky) {
  Buffer& buffer = paths_.buffers[kLightProbabilities];
  if (of_lights_) buffer.write(lights.data(), lights.size_bytes());
  if (of_sky_) buffer.write(sky.data(), sky.size_bytes(), of_lights_ ? kLightCellBytes : 0);
}

// Work that takes the host some milliseconds is done here, while kernels compile.
void LightTrainer::start() {
  if (!trains_) {
    const auto words = [](const auto& probabilities) {
      return probabilities ? std::span(*probabilities) : std::span<const std::uint32_t>();
    };
    use(words(taken_over_.lights), words(taken_over_.sky));
    return;
  }
  need_ = {&kPathProgram, stage_bits({kAdvance, kConnect}), paths_.config()};
  need_.config.features |= gpu::kFeatureTraining;
  kernels_.start(need_);
  std::vector<std::uint32_t> lights, sky;
  if (of_lights_) lights = prior_light_cells(workspace_.scene);
  if (of_sky_) sky = prior_sky_cells();
  use(lights, sky);
  paths_.buffers[kLightSums].fill_zero();
}

Pilot LightTrainer::begin() {
  const Pilot pilot = training_picture(workspace_.film, training_paths_);
  report_.paths = std::uint64_t{pilot.width} * pilot.height * pilot.samples;
  start_ = Clock::now();
  return pilot;
}

void LightTrainer::finish() {
  const std::uint64_t of_lights = of_lights_ ? kLightSumBytes : 0, of_sky = of_sky_ ? kSkySumBytes : 0;
  std::vector<std::uint32_t> copy; // most cells were never visited: not worth copying on a CPU device
  const auto sums = look_at(paths_.buffers[kLightSums], (of_lights + of_sky) / sizeof(std::uint32_t), copy);
  TrainedLights lights;
  TrainedSky sky;
  if (of_lights_) lights = train_light_cells(workspace_.scene, sums.first(of_lights / sizeof(std::uint32_t)));
  if (of_sky_) sky = train_sky_cells(sums.last(of_sky / sizeof(std::uint32_t)));
  use(lights.ends, sky.ends);
  report_.cells = lights.cells, report_.sky_cells = sky.cells;
  const auto probability = [](bool is_trained, std::vector<std::uint32_t>& ends) {
    return is_trained ? std::make_shared<const std::vector<std::uint32_t>>(std::move(ends)) : nullptr;
  };
  report_.probabilities = {probability(of_lights_, lights.ends), probability(of_sky_, sky.ends)};
  report_.seconds = seconds_since(start_);
}

} // namespace wavepath
