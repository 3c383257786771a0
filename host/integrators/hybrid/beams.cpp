#include "host/integrators/hybrid/beams.h"

#include <algorithm>
#include <array>

#include "host/base/error.h"
#include "host/integrators/path/paths.h"
#include "kernels/hybrid/antialias/beam_cover.spv.h"
#include "kernels/hybrid/antialias/beam_find.spv.h"
#include "kernels/hybrid/antialias/beam_pick.spv.h"
#include "kernels/hybrid/antialias/beam_show.spv.h"
#include "kernels/hybrid/hybrid_types.h"

namespace wavepath {
namespace {

enum BeamStage : std::size_t { kBeamFind, kBeamCover, kBeamPick, kBeamShow, kBeamStageCount };
const std::array<KernelCode, kBeamStageCount> kBeamStages = {{{"find beams", wavepath_beam_find_spv},
                                                              {"cover beams", wavepath_beam_cover_spv},
                                                              {"pick parts", wavepath_beam_pick_spv},
                                                              {"show parts", wavepath_beam_show_spv}}};
constexpr std::array<std::size_t, kBeamStageCount> kBeamOrder = {kBeamFind, kBeamCover, kBeamPick, kBeamShow};

constexpr std::uint64_t kFirstWork = 1u << 15, kMostBeams = 1u << 15; // of a slice; the first is a guess
constexpr std::uint64_t kWorkOfABeam = 16;       // in the units of SliceLength: one takes as long as many rays
constexpr std::uint32_t kShownPixels = 1u << 18; // of a dispatch, which copies eight bytes each

std::vector<Binding> beam_layout() {
  using enum BindingKind;
  std::vector<Binding> layout = workspace_layout();
  layout.insert(layout.end(), {{gpu::kBindHybrid, uniform, nullptr},
                               {gpu::kBindVisibility, storage, nullptr},
                               {gpu::kBindFractions, storage, nullptr},
                               {gpu::kBindBeamTriangles, storage, nullptr},
                               {gpu::kBindBeamAreas, storage, nullptr},
                               {gpu::kBindBeamIds, storage, nullptr}});
  return layout;
}

} // namespace

const KernelProgram kBeamProgram = {kBeamStages, kBeamOrder, beam_layout};

std::uint64_t Beams::most_list_bytes() {
  return kMostBeams * (gpu::kBeamStride * sizeof(glm::uvec2) + gpu::kBeamTriangles * sizeof(float));
}

Beams::Beams(Workspace& workspace, KernelCompiler& kernels, std::uint32_t shape)
    : workspace_(workspace), kernels_(kernels), shape_(shape), work_a_slice_(kFirstWork) {}

void Beams::change(const KernelConfig& config, const Buffer& hybrid, const Buffer& fractions, const Buffer& visible) {
  Device& device = workspace_.device;
  if (workspace_.on_device->queries)
    throw Error(device.info().name, "traces rays by its own means, which find no beams", "add --traversal compute");
  need_ = whole_need(kBeamProgram, config);
  kernels_.start(need_);
  const std::uint64_t pixels = workspace_.film.pixels(), beams = std::min(pixels, kMostBeams);
  reserve(device, triangles_, beams * gpu::kBeamStride * sizeof(glm::uvec2));
  reserve(device, areas_, beams * gpu::kBeamTriangles * sizeof(float));
  reserve(device, ids_, pixels * gpu::kFractions * sizeof(glm::uvec2));
  std::vector<Binding> bindings = workspace_.bindings(workspace_.film.bands().front()); // it reads no film
  using enum BindingKind;
  bindings.insert(bindings.end(), {{gpu::kBindHybrid, uniform, &hybrid},
                                   {gpu::kBindVisibility, storage, &visible},
                                   {gpu::kBindFractions, storage, &fractions},
                                   {gpu::kBindBeamTriangles, storage, &triangles_},
                                   {gpu::kBindBeamAreas, storage, &areas_},
                                   {gpu::kBindBeamIds, storage, &ids_}});
  set_ = std::make_unique<BindingSet>(device, bindings, static_cast<std::uint32_t>(sizeof(gpu::Wave)));
}

void Beams::find(WaveQueue& queue, const char* stage, const std::function<void(Commands&)>& prepare) {
  const std::uint64_t most = std::min(work_a_slice_.next_frame() / kWorkOfABeam, kMostBeams),
                      pixels = workspace_.film.pixels();
  for (std::uint64_t first = 0; first < pixels; first += most) {
    gpu::Wave wave{};
    wave.first_pixel = static_cast<std::uint32_t>(first);
    wave.pixel_count = static_cast<std::uint32_t>(std::min(most, pixels - first));
    wave.bounce = shape_;
    const auto record = [&](Commands& commands) {
      const KernelSet& kernels = kernels_.best(need_);
      if (first == 0) prepare(commands);
      commands.bind(*set_);
      commands.dispatch(kernels[kBeamFind], groups_for(wave.pixel_count), &wave);
      commands.barrier();
      commands.dispatch(kernels[kBeamCover], groups_for(std::uint64_t{wave.pixel_count} * gpu::kBeamTriangles), &wave);
      commands.barrier();
      commands.dispatch(kernels[kBeamPick], groups_for(wave.pixel_count), &wave);
    };
    queue.submit(record,
                 {.stage = stage, .done = [this](const Finished& finished) { work_a_slice_.note(finished.seconds); }});
  }
}

void Beams::show(WaveQueue& queue, std::uint32_t part, const std::function<void(Commands&)>& prepare) {
  const auto pixels = static_cast<std::uint32_t>(workspace_.film.pixels());
  const auto record = [&](Commands& commands) {
    prepare(commands);
    commands.bind(*set_);
    for (std::uint32_t first = 0; first < pixels; first += kShownPixels) {
      gpu::Wave wave{};
      wave.first_pixel = first;
      wave.pixel_count = std::min(kShownPixels, pixels - first);
      wave.first_sample = part;
      commands.dispatch(kernels_.best(need_)[kBeamShow], groups_for(wave.pixel_count), &wave);
    }
  };
  queue.submit(record, {});
}

} // namespace wavepath
