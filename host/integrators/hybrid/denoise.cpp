#include "host/integrators/hybrid/denoise.h"

#include <span>

#include "kernels/hybrid/denoise_atrous.spv.h"
#include "kernels/hybrid/denoise_temporal.spv.h"
#include "kernels/hybrid/denoise_variance.spv.h"

namespace wavepath {
namespace {

constexpr std::uint32_t kPushBytes = sizeof(gpu::FilterBand);

} // namespace

Denoiser::Denoiser(Device& device, std::uint32_t width, std::uint32_t height, const Buffer& gbuffer,
                   const Buffer& signals, std::uint32_t wanted)
    : width_(width), height_(height), bands_(device, width, height), gbuffer_(gbuffer) {
  const std::uint64_t pixels = std::uint64_t{width} * height, texel = sizeof(gpu::vec4);
  buffers_.reprojection = Buffer(device, sizeof(gpu::Reprojection));
  for (int i = 0; i < 2; ++i) {
    buffers_.past[i] = Buffer(device, pixels * texel);
    buffers_.moments[i] = Buffer(device, pixels * texel);
    buffers_.history[i] = Buffer(device, pixels * texel);
    buffers_.guide[i] = Buffer(device, pixels * texel);
  }
  buffers_.slopes = Buffer(device, pixels * sizeof(gpu::vec2));
  buffers_.first = Buffer(device, pixels * texel);
  buffers_.filtered = Buffer(device, pixels * texel);

  const Buffer *first = &buffers_.first, *filtered = &buffers_.filtered;
  const Buffer *a = &buffers_.guide[0], *b = &buffers_.guide[1];
  for (std::uint32_t turn = 0; turn < 2; ++turn) {
    const Buffer *plain = &buffers_.history[turn], *plain_before = &buffers_.history[1 - turn];
    // In motion the history is the output of the first iteration, as in the paper; each frame counts for little then.
    // With a still camera it is the plain mean over frames, so that the picture converges to the unfiltered one.
    const std::array<Flow, kFlowCount> flows = {{{first, &signals, filtered, b, a},
                                                 {plain_before, &signals, filtered, b, a},
                                                 {plain_before, plain, first, a, b},
                                                 {plain_before, first, filtered, b, a},
                                                 {plain_before, filtered, &signals, a, b},
                                                 {plain_before, &signals, filtered, b, a}}};
    for (std::size_t i = 0; i < kFlowCount; ++i)
      sets_[turn][i] = std::make_unique<BindingSet>(device, bindings(turn, flows[i]), kPushBytes);
  }
  const auto add = [&](const char* name, std::span<const std::uint32_t> spirv) {
    kernels_.emplace_back(device, name, spirv, *sets_[0][kMoving], std::span(&wanted, 1));
  };
  add("denoise_temporal", wavepath_denoise_temporal_spv);
  add("denoise_variance", wavepath_denoise_variance_spv);
  add("denoise_atrous", wavepath_denoise_atrous_spv);
}

std::vector<Binding> Denoiser::bindings(std::uint32_t turn, const Flow& flow) const {
  const std::uint32_t before = 1 - turn;
  return {{gpu::kFilterReprojection, BindingKind::uniform, &buffers_.reprojection},
          {gpu::kFilterGbuffer, BindingKind::texels_rgba32ui, &gbuffer_},
          {gpu::kFilterColorIn, BindingKind::texels_rgba32f, flow.color_in},
          {gpu::kFilterColorOut, BindingKind::storage, flow.color_out},
          {gpu::kFilterHistoryBefore, BindingKind::texels_rgba32f, flow.history_before},
          {gpu::kFilterHistoryNow, BindingKind::storage, &buffers_.history[turn]},
          {gpu::kFilterPastBefore, BindingKind::texels_rgba32ui, &buffers_.past[before]},
          {gpu::kFilterPastNow, BindingKind::storage, &buffers_.past[turn]},
          {gpu::kFilterPastTexels, BindingKind::texels_rgba32ui, &buffers_.past[turn]},
          {gpu::kFilterMomentsBefore, BindingKind::texels_rgba32f, &buffers_.moments[before]},
          {gpu::kFilterMomentsNow, BindingKind::storage, &buffers_.moments[turn]},
          {gpu::kFilterMomentsTexels, BindingKind::texels_rgba32f, &buffers_.moments[turn]},
          {gpu::kFilterGuideIn, BindingKind::texels_rgba32ui, flow.guide_in},
          {gpu::kFilterGuideOut, BindingKind::storage, flow.guide_out},
          {gpu::kFilterSlopes, BindingKind::storage, &buffers_.slopes},
          {gpu::kFilterSlopeTexels, BindingKind::texels_rg32ui, &buffers_.slopes}};
}

void Denoiser::record(Commands& commands, const gpu::CameraView& now) {
  const gpu::Reprojection frames = reproject(now, before_, remembers_, width_, height_);
  commands.write(buffers_.reprojection, &frames, sizeof(frames));
  turn_ = 1 - turn_;
  const auto run = [&](Stage stage, FlowName flow, std::uint32_t step) {
    commands.bind(*sets_[turn_][flow]);
    bands_.run(commands, kernels_[stage], step);
  };
  const FlowName join = frames.still ? kStanding : kMoving;
  run(kTemporal, join, 0);
  run(kVariance, join, 0);
  for (std::uint32_t i = 0; i < kIterations.size(); ++i) run(kAtrous, kIterations[i], 1u << i);
  before_ = now;
  remembers_ = true;
}

void Denoiser::forget() { remembers_ = false; }

std::uint64_t Denoiser::bytes() const {
  std::uint64_t sum =
      buffers_.reprojection.bytes() + buffers_.slopes.bytes() + buffers_.first.bytes() + buffers_.filtered.bytes();
  for (const auto* pair : {&buffers_.past, &buffers_.moments, &buffers_.history, &buffers_.guide})
    for (const Buffer& buffer : *pair) sum += buffer.bytes();
  return sum;
}

std::uint32_t Denoiser::dispatches() const {
  return static_cast<std::uint32_t>(2 + kIterations.size()) * bands_.count();
}

} // namespace wavepath
