#include "host/integrators/path/path_tracer.h"

#include <algorithm>

namespace wavepath {

std::uint32_t PathTracer::capacity() const {
  return trainer_.capacity() | (settings_.guide ? kCapacityForGuide : 0) |
         (guide_training_ ? kCapacityForGuideRecords : 0);
}

// Compiles the unguided kernels even if guiding is asked for, since training may find that it does not pay.
void PathTracer::change(const View&, const RenderPlan& settings, TemporalHistory) {
  settings_ = settings;
  trainer_.change(settings);
  guide_report_.reset();
  guide_training_.reset();
  if (settings.guide) guide_training_.emplace(settings.width, settings.height, settings.training.guide_iterations);
  training_ = trainer_.trains() ? Training::lights : settings.guide ? Training::guide : Training::none;
  paths_.change(settings, kAllPathStages, capacity());
  trainer_.start();
  if (settings.guide) {
    guided_need_ = path_need(kPathProgram, stage_bits({kShade, kEscape}), paths_.config());
    guided_need_.config.features |= gpu::kFeatureGuide;
    guide_training_need_ =
        path_need(kGuideTrainingProgram, stage_bits({kCollide, kShade, kEscape, kGuideNote}), guided_need_.config);
    guide_training_need_.config.features |= gpu::kFeatureTraining;
    guide_training_need_.config.sky = gpu::kSkyByPaths; // it trains on the light that paths find themselves
    kernels_.start(guide_training_need_);
    kernels_.start(guided_need_);
    use_field(guide_training_->field());
  }
}

bool PathTracer::is_ready() {
  bool ready = paths_.is_ready(); // every set is asked for, so that all are begun
  ready = trainer_.is_ready() && ready;
  if (settings_.guide) ready = kernels_.ready(guide_training_need_) && kernels_.ready(guided_need_) && ready;
  return ready;
}

double PathTracer::get_ready() {
  double seconds = std::max(paths_.get_ready(), trainer_.get_ready());
  if (settings_.guide)
    for (const KernelNeed* need : {&guide_training_need_, &guided_need_})
      seconds = std::max(seconds, kernels_.best(*need).seconds());
  return seconds;
}

std::optional<Pilot> PathTracer::pilot() {
  switch (training_) {
    case Training::lights:
      return trainer_.begin();
    case Training::guide:
      return guide_training_->next();
    default:
      return std::nullopt;
  }
}

bool PathTracer::end_pilot() {
  if (training_ == Training::lights) {
    trainer_.finish();
    training_ = guide_training_ ? Training::guide : Training::none;
  } else {
    train_guide();
  }
  return training_ != Training::none;
}

void PathTracer::train_guide() {
  if (guide_training_->take(paths_.buffers[kRecords])) use_field(guide_training_->field());
  if (!guide_training_->is_done()) return;
  guide_report_ = guide_training_->report();
  guide_training_.reset();
  training_ = Training::none;
  paths_.buffers[kRecords] = Buffer(); // a dummy replaces it in its binding
  paths_.change(settings_, kAllPathStages, capacity());
}

void PathTracer::use_field(const GuideField& field) {
  paths_.buffers[kGuideTree].write(field.nodes.data(), field.nodes.size() * sizeof(gpu::GuideNode));
  paths_.buffers[kGuideMaps].write(field.maps.data(), field.maps.size() * sizeof(glm::uvec4));
}

void PathTracer::describe(RenderResult& result) const {
  result.light_training = trainer_.report();
  result.guide = guide_report_;
}

std::uint32_t PathTracer::timed_dispatches() const {
  const std::uint32_t bounces = workspace_.frame.max_depth + 1;
  return std::min(2 + bounces * 8 + 2 * paths_.sampling().most_rays(bounces), 1024u); // upper bound for all bounces
}

void PathTracer::record_wave(Commands& commands, std::size_t band, const gpu::Wave& wave) {
  const KernelSet& kernels = paths_.kernels();
  const bool notes = training_ == Training::guide, guided = guide_report_ && guide_report_->used;
  const KernelSet& shading = notes    ? kernels_.best(guide_training_need_)
                             : guided ? kernels_.best(guided_need_)
                                      : kernels;
  const KernelSet& connecting = training_ == Training::lights ? trainer_.kernels() : kernels;
  const std::uint32_t bounces = workspace_.frame.max_depth + 1;
  const bool connects = workspace_.frame.light_count > 0 || paths_.config().sky == gpu::kSkyByShadowRays;
  commands.bind(paths_.bindings(band));
  commands.dispatch(kernels[kGenerate], groups_for(gpu::level_slots(wave)), &wave);
  const bool sorts = shading.config().sort != gpu::kSortNone;
  bool is_prepared = false;
  for (std::uint32_t bounce = 0; bounce < bounces; ++bounce) {
    paths_.extend(commands, kernels, wave, bounce, is_prepared);
    paths_.shade(commands, kernels, shading, wave, bounce);
    is_prepared = connects && bounce + 1 < bounces && // the last one only collects emission
                  paths_.connect(commands, connecting, wave, bounce, sorts);
  }
  if (training_ == Training::lights) return; // its samples do not reach the film
  if (workspace_.frame.reuses_paths && !notes) {
    commands.barrier();
    commands.dispatch(kernels[kReuse], groups_for(gpu::level_slots(wave)), &wave);
  }
  commands.barrier();
  const Kernel& last = notes ? shading[kGuideNote] : kernels[kAccumulate];
  commands.dispatch(last, groups_for(wave.pixel_count), &wave);
}

} // namespace wavepath
