#include "host/integrators/path/path_tracer.h"

#include <algorithm>

namespace wavepath {

// The plain kernels as well: the pilot may find that guiding does not pay.
void PathTracer::change(const View&, const RenderSettings& settings, Past) {
  settings_ = settings;
  guide_report_.reset();
  guide_pilot_.reset();
  paths_.change(settings, kAllPathStages, settings.guide ? kRoomForGuide | kRoomForGuideRecords : 0);
  if (!settings.guide) return;
  guided_need_ = {&kPathProgram, stage_bits({kShade}), paths_.config()};
  guided_need_.config.features |= gpu::kFeatureGuide;
  pilot_need_ = {&kGuidePilotProgram, stage_bits({kShade, kGuideNote}), guided_need_.config};
  pilot_need_.config.features |= gpu::kFeatureGuideTraining;
  kernels_.start(pilot_need_);
  kernels_.start(guided_need_);
  guide_pilot_.emplace(settings.width, settings.height);
  use_field(guide_pilot_->field());
}

bool PathTracer::is_ready() {
  const bool plain = paths_.is_ready(); // asks for all, so that all are begun
  return (!settings_.guide || (kernels_.ready(pilot_need_) && kernels_.ready(guided_need_))) && plain;
}

double PathTracer::get_ready() {
  double seconds = paths_.get_ready();
  if (settings_.guide)
    for (const KernelNeed* need : {&pilot_need_, &guided_need_})
      seconds = std::max(seconds, kernels_.best(*need).seconds());
  return seconds;
}

std::optional<Pilot> PathTracer::pilot() { return guide_pilot_ ? std::optional(guide_pilot_->next()) : std::nullopt; }

void PathTracer::use_field(const GuideField& field) {
  paths_.buffers[kGuideTree].write(field.nodes.data(), field.nodes.size() * sizeof(gpu::GuideNode));
  paths_.buffers[kGuideMaps].write(field.maps.data(), field.maps.size() * sizeof(gpu::vec4));
}

bool PathTracer::learn() {
  if (guide_pilot_->take(paths_.buffers[kGuideRecords])) use_field(guide_pilot_->field());
  if (!guide_pilot_->is_done()) return true;
  guide_report_ = guide_pilot_->report();
  paths_.buffers[kGuideRecords] = Buffer(); // a place holder takes its place
  paths_.change(settings_, kAllPathStages, kRoomForGuide);
  guide_pilot_.reset();
  return false;
}

std::uint32_t PathTracer::timed_dispatches() const { return std::min(2 + (workspace_.frame.max_depth + 1) * 5, 1024u); }

void PathTracer::record_wave(Commands& commands, std::size_t band, const gpu::Wave& wave) {
  const KernelSet& kernels = paths_.kernels();
  const bool guided = guide_report_ && guide_report_->used;
  const KernelSet& shading = guide_pilot_ ? kernels_.best(pilot_need_) : guided ? kernels_.best(guided_need_) : kernels;
  const std::uint32_t bounces = workspace_.frame.max_depth + 1;
  const bool connects = workspace_.frame.light_count > 0;
  commands.bind(paths_.bindings(band));
  commands.dispatch(kernels[kGenerate], groups_for(std::uint64_t{wave.pixel_count} * wave.sample_count), &wave);
  for (std::uint32_t bounce = 0; bounce < bounces; ++bounce) {
    paths_.extend(commands, kernels, wave, bounce);
    paths_.shade(commands, shading, wave, bounce);
    if (connects && bounce + 1 < bounces)
      paths_.connect(commands, kernels, wave, bounce); // the last one only collects emission
  }
  commands.barrier();
  const Kernel& last = guide_pilot_ ? shading[kGuideNote] : kernels[kAccumulate];
  commands.dispatch(last, groups_for(wave.pixel_count), &wave);
}

} // namespace wavepath
