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
          gpu::kFeatureLightRows) != 0 &&
         !scene.light_tree.empty();
}

} // namespace

std::uint32_t PathTracer::rooms() const {
  return (learns_lights_ ? kRoomForLightSums : 0) | (settings_.guide ? kRoomForGuide : 0) |
         (guide_pilot_ ? kRoomForGuideRecords : 0);
}

// The plain kernels as well where guiding is asked for: the pilot may find that it does not pay.
void PathTracer::change(const View&, const RenderSettings& settings, Past) {
  settings_ = settings;
  learns_lights_ = learns_lights(workspace_.scene, settings);
  light_pilot_ = {};
  guide_report_.reset();
  guide_pilot_.reset();
  if (settings.guide) guide_pilot_.emplace(settings.width, settings.height, settings.guide_iterations);
  lesson_ = learns_lights_ ? Lesson::lights : settings.guide ? Lesson::guide : Lesson::none;
  if (learns_lights_) workspace_.frame.scene_features |= gpu::kFeatureLightRows;
  workspace_.frame.light_sum_scale = static_cast<float>(light_sum_scale(workspace_.scene));
  paths_.change(settings, kAllPathStages, rooms());
  if (learns_lights_) {
    light_pilot_need_ = {&kPathProgram, stage_bits({kAdvance, kConnect}), paths_.config()};
    light_pilot_need_.config.features |= gpu::kFeatureLearning;
    kernels_.start(light_pilot_need_);
  }
  if (settings.guide) {
    guided_need_ = path_need(kPathProgram, stage_bits({kShade, kEscape}), paths_.config());
    guided_need_.config.features |= gpu::kFeatureGuide;
    guide_pilot_need_ = path_need(kGuidePilotProgram, stage_bits({kShade, kEscape, kGuideNote}), guided_need_.config);
    guide_pilot_need_.config.features |= gpu::kFeatureLearning;
    kernels_.start(guide_pilot_need_);
    kernels_.start(guided_need_);
    use_field(guide_pilot_->field());
  }
}

bool PathTracer::is_ready() {
  bool ready = paths_.is_ready(); // asks for all, so that all are begun
  if (learns_lights_) ready = kernels_.ready(light_pilot_need_) && ready;
  if (settings_.guide) ready = kernels_.ready(guide_pilot_need_) && kernels_.ready(guided_need_) && ready;
  return ready;
}

double PathTracer::get_ready() {
  double seconds = paths_.get_ready();
  if (learns_lights_) seconds = std::max(seconds, kernels_.best(light_pilot_need_).seconds());
  if (settings_.guide)
    for (const KernelNeed* need : {&guide_pilot_need_, &guided_need_})
      seconds = std::max(seconds, kernels_.best(*need).seconds());
  return seconds;
}

std::optional<Pilot> PathTracer::pilot() {
  switch (lesson_) {
    case Lesson::lights:
      return begin_light_pilot();
    case Lesson::guide:
      return guide_pilot_->next();
    default:
      return std::nullopt;
  }
}

bool PathTracer::learn() {
  if (lesson_ == Lesson::lights) {
    learn_lights();
    lesson_ = guide_pilot_ ? Lesson::guide : Lesson::none;
  } else {
    learn_guide();
  }
  return lesson_ != Lesson::none;
}

Pilot PathTracer::begin_light_pilot() {
  const std::vector<std::uint32_t> shares = unlearned_light_rows(workspace_.scene);
  paths_.buffers[kLightShares].write(shares.data(), kLightRowBytes);
  paths_.buffers[kLightSums].fill_zero();
  const std::uint64_t pixels = workspace_.film.pixels();
  const auto samples = static_cast<std::uint32_t>(std::max<std::uint64_t>(kPilotPaths / pixels, 1));
  light_pilot_.paths = samples * pixels;
  light_pilot_start_ = Clock::now();
  return {even_segments(workspace_.film.bands()), samples, kLightPilotSeed};
}

void PathTracer::learn_lights() {
  const auto sums = download<std::uint32_t>(paths_.buffers[kLightSums], kLightSumBytes / sizeof(std::uint32_t));
  const LightLesson lesson = learn_light_rows(workspace_.scene, sums);
  paths_.buffers[kLightShares].write(lesson.ends.data(), kLightRowBytes);
  light_pilot_.rows = lesson.rows;
  light_pilot_.seconds = seconds_since(light_pilot_start_);
}

void PathTracer::learn_guide() {
  if (guide_pilot_->take(paths_.buffers[kGuideRecords])) use_field(guide_pilot_->field());
  if (!guide_pilot_->is_done()) return;
  guide_report_ = guide_pilot_->report();
  guide_pilot_.reset();
  lesson_ = Lesson::none;
  paths_.buffers[kGuideRecords] = Buffer(); // a place holder takes its place
  paths_.change(settings_, kAllPathStages, rooms());
}

void PathTracer::use_field(const GuideField& field) {
  paths_.buffers[kGuideTree].write(field.nodes.data(), field.nodes.size() * sizeof(gpu::GuideNode));
  paths_.buffers[kGuideMaps].write(field.maps.data(), field.maps.size() * sizeof(gpu::vec4));
}

void PathTracer::describe(RenderResult& result) const {
  result.light_pilot = light_pilot_;
  result.guide = guide_report_;
}

std::uint32_t PathTracer::timed_dispatches() const { return std::min(2 + (workspace_.frame.max_depth + 1) * 7, 1024u); }

void PathTracer::record_wave(Commands& commands, std::size_t band, const gpu::Wave& wave) {
  const KernelSet& kernels = paths_.kernels();
  const bool notes = lesson_ == Lesson::guide, guided = guide_report_ && guide_report_->used;
  const KernelSet& shading = notes ? kernels_.best(guide_pilot_need_) : guided ? kernels_.best(guided_need_) : kernels;
  const KernelSet& connecting = lesson_ == Lesson::lights ? kernels_.best(light_pilot_need_) : kernels;
  const std::uint32_t bounces = workspace_.frame.max_depth + 1;
  const bool connects = workspace_.frame.light_count > 0;
  commands.bind(paths_.bindings(band));
  commands.dispatch(kernels[kGenerate], groups_for(std::uint64_t{wave.pixel_count} * wave.sample_count), &wave);
  for (std::uint32_t bounce = 0; bounce < bounces; ++bounce) {
    paths_.extend(commands, kernels, wave, bounce);
    paths_.shade(commands, kernels, shading, wave, bounce);
    if (connects && bounce + 1 < bounces)
      paths_.connect(commands, connecting, wave, bounce); // the last one only collects emission
  }
  if (lesson_ == Lesson::lights) return; // its samples do not reach the film
  commands.barrier();
  const Kernel& last = notes ? shading[kGuideNote] : kernels[kAccumulate];
  commands.dispatch(last, groups_for(wave.pixel_count), &wave);
}

} // namespace wavepath
