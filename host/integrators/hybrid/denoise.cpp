#include "host/integrators/hybrid/denoise.h"

#include <span>

#include "kernels/hybrid/denoise_atrous.spv.h"
#include "kernels/hybrid/denoise_return.spv.h"
#include "kernels/hybrid/denoise_split.spv.h"
#include "kernels/hybrid/denoise_spread.spv.h"
#include "kernels/hybrid/denoise_temporal.spv.h"
#include "kernels/hybrid/denoise_variance.spv.h"
#include "kernels/hybrid/hybrid_types.h"

namespace wavepath {
namespace {

constexpr std::uint32_t kPushBytes = sizeof(gpu::FilterBand);

// Frames of a still camera after which rare bright samples are split no more: the mean over frames has fewer of them
// then, and the picture converges to the unfiltered one.
constexpr std::uint32_t kSplitFrames = 16;
// Iterations of the 3x3 filter that spreads them: 26 pixels of standard deviation.
constexpr std::uint32_t kSpreadIterations = 6;

std::uint64_t vec4_a_pixel_of_light(const BufferDimensions& e) {
  return e.options & gpu::kHybridLights ? vec4_a_pixel(e) : 0;
}

using enum BindingKind;

// By Denoiser::OwnBuffer. What has no view is bound by bindings(), because its role changes.
const std::vector<BufferRule> kDenoiserRules = {
    {"reprojection",
     [](const BufferDimensions&) { return std::uint64_t{sizeof(gpu::Reprojection)}; },
     {{gpu::kFilterReprojection, uniform}}},
    {"slopes",
     [](const BufferDimensions& e) { return e.pixels * sizeof(gpu::vec2); },
     {{gpu::kFilterSlopes, storage}, {gpu::kFilterSlopeTexels, texels_rg32ui}}},
    {"first output", vec4_a_pixel, {}},
    {"filtered", vec4_a_pixel, {}},
    {"past 0", vec4_a_pixel, {}},
    {"past 1", vec4_a_pixel, {}},
    {"moments 0", vec4_a_pixel, {}},
    {"moments 1", vec4_a_pixel, {}},
    {"history 0", vec4_a_pixel, {}},
    {"history 1", vec4_a_pixel, {}},
    {"guide 0", vec4_a_pixel, {}},
    {"guide 1", vec4_a_pixel, {}},
    {"excess", vec4_a_pixel_of_light, {}},
    {"excess being spread", vec4_a_pixel_of_light, {}},
};

} // namespace

std::uint64_t Denoiser::bytes_per_pixel() {
  std::uint64_t bytes = 0;
  for (const BufferRule& rule : kDenoiserRules)
    bytes += rule.bytes({.pixels = 1, .options = gpu::kHybridLights}) - rule.bytes({});
  return bytes;
}

Denoiser::Denoiser(Device& device, std::uint32_t width, std::uint32_t height, const Buffer& gbuffer,
                   const Buffer& signals, std::uint32_t wanted)
    : width_(width),
      height_(height),
      splits_((wanted & gpu::kHybridLights) != 0),
      bands_(device, width, height),
      gbuffer_(gbuffer),
      buffers_(device, kDenoiserRules) {
  buffers_.fit({.pixels = std::uint64_t{width} * height, .options = wanted});
  const Buffer *first = &buffers_[kFirstOutput], *filtered = &buffers_[kFiltered];
  const Buffer *a = &buffers_[kGuide], *b = &buffers_[kGuide + 1];
  const Buffer *excess = &buffers_[kExcess], *spreading = &buffers_[kSpreading];
  for (std::uint32_t parity = 0; parity < 2; ++parity) {
    const Buffer *plain = &buffers_[kHistory + parity], *plain_before = &buffers_[kHistory + 1 - parity];
    // In motion the history is the output of the first iteration, as in the paper; each frame counts for little then.
    // With a still camera it is the plain mean over frames, so that the picture converges to the unfiltered one.
    const std::array<Flow, kFlowCount> flows = {{{first, &signals, filtered, b, a},
                                                 {plain_before, &signals, filtered, b, a},
                                                 {plain_before, plain, first, a, b},
                                                 {plain_before, first, filtered, b, a},
                                                 {plain_before, filtered, &signals, a, b},
                                                 {plain_before, &signals, filtered, b, a},
                                                 {first, &signals, excess, a, b},
                                                 {first, excess, spreading, b, a},
                                                 {first, spreading, filtered, b, a},
                                                 {first, filtered, spreading, b, a},
                                                 {excess, filtered, &signals, b, a}}};
    for (std::size_t i = 0; i < (splits_ ? kFlowCount : kSplitFlow); ++i)
      sets_[parity][i] = std::make_unique<BindingSet>(device, bindings(parity, flows[i]), kPushBytes);
  }
  const auto add = [&](const char* name, std::span<const std::uint32_t> spirv) {
    kernels_.emplace_back(device, name, spirv, *sets_[0][kMoving], std::span(&wanted, 1));
  };
  add("denoise_temporal", wavepath_denoise_temporal_spv);
  add("denoise_variance", wavepath_denoise_variance_spv);
  add("denoise_atrous", wavepath_denoise_atrous_spv);
  if (!splits_) return;
  add("denoise_split", wavepath_denoise_split_spv);
  add("denoise_spread", wavepath_denoise_spread_spv);
  add("denoise_return", wavepath_denoise_return_spv);
}

std::vector<Binding> Denoiser::bindings(std::uint32_t parity, const Flow& flow) const {
  const auto now = [&](OwnBuffer pair) { return &buffers_[pair + parity]; };
  const auto before = [&](OwnBuffer pair) { return &buffers_[pair + 1 - parity]; };
  std::vector<Binding> bindings = {{gpu::kFilterGbuffer, texels_rgba32ui, &gbuffer_},
                                   {gpu::kFilterColorIn, texels_rgba32f, flow.color_in},
                                   {gpu::kFilterColorOut, storage, flow.color_out},
                                   {gpu::kFilterHistoryBefore, texels_rgba32f, flow.history_before},
                                   {gpu::kFilterHistoryNow, storage, now(kHistory)},
                                   {gpu::kFilterShapesBefore, texels_rgba32ui, before(kShapes)},
                                   {gpu::kFilterShapesNow, storage, now(kShapes)},
                                   {gpu::kFilterShapes, texels_rgba32ui, now(kShapes)},
                                   {gpu::kFilterMomentsBefore, texels_rgba32f, before(kMoments)},
                                   {gpu::kFilterMomentsNow, storage, now(kMoments)},
                                   {gpu::kFilterMomentsTexels, texels_rgba32f, now(kMoments)},
                                   {gpu::kFilterGuideIn, texels_rgba32ui, flow.guide_in},
                                   {gpu::kFilterGuideOut, storage, flow.guide_out}};
  buffers_.add_bindings(bindings);
  return bindings;
}

void Denoiser::record(Commands& commands, const gpu::CameraView& now) {
  const gpu::Reprojection frames = reproject(now, before_, remembers_, width_, height_);
  commands.write(buffers_[kReprojection], &frames, sizeof(frames));
  parity_ = 1 - parity_;
  const auto run = [&](Stage stage, FlowName flow, std::uint32_t step) {
    commands.bind(*sets_[parity_][flow]);
    bands_.run(commands, kernels_[stage], step);
  };
  still_frames_ = frames.still ? still_frames_ + 1 : 0;
  if (splits_ && still_frames_ < kSplitFrames) {
    run(kSplit, kSplitFlow, 0);
    for (std::uint32_t i = 0; i < kSpreadIterations; ++i)
      run(kSpread, i == 0 ? kSpreadFirst : i % 2 ? kSpreadForth : kSpreadBack, 1u << i);
    run(kReturn, kReturnFlow, 0);
  }
  const FlowName join = frames.still ? kStanding : kMoving;
  run(kTemporal, join, 0);
  run(kVariance, join, 0);
  for (std::uint32_t i = 0; i < kIterations.size(); ++i) run(kAtrous, kIterations[i], 1u << i);
  before_ = now;
  remembers_ = true;
}

void Denoiser::forget() { remembers_ = false; }

std::uint32_t Denoiser::dispatches() const {
  return static_cast<std::uint32_t>(2 + kIterations.size() + (splits_ ? 2 + kSpreadIterations : 0)) * bands_.count();
}

} // namespace wavepath
