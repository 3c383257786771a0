#include "host/integrators/whitted/whitted.h"

#include <array>

#include "kernels/whitted/whitted.spv.h"

namespace wavepath {
namespace {

const std::array<KernelCode, 1> kStages = {{{"whitted", wavepath_whitted_spv}}};
constexpr std::array<std::size_t, 1> kCompileOrder = {0};
const std::vector<BufferRule> kRules = {
    {"frame", [](const Extent&) { return std::uint64_t{sizeof(gpu::WhittedFrame)}; },
     {{gpu::kBindWhitted, BindingKind::uniform}}},
};

std::vector<Binding> layout() {
  std::vector<Binding> layout = path_layout();
  add_layout(kRules, layout);
  return layout;
}

} // namespace

const KernelProgram kWhittedProgram = {kStages, kCompileOrder, layout};

Whitted::Whitted(Workspace& workspace, KernelCompiler& kernels)
    : workspace_(workspace), kernels_(kernels), paths_(workspace, kernels), buffers_(workspace.device, kRules) {}

void Whitted::change(const View& view, const RenderSettings& settings, Past) {
  const PackedScene& scene = workspace_.scene;
  need_ = {&kWhittedProgram, 1, kernel_config(needed_features(scene, view, settings), scene.stack_size, settings)};
  kernels_.start(need_);
  const std::uint32_t features = kernels_.features(kWhittedProgram);
  bool moved = paths_.change(settings, stage_bits({kAccumulate}), kStatesAlone, features);
  moved |= buffers_.fit({});
  const gpu::WhittedFrame frame{.ambient = settings.ambient.value_or(glm::vec3(0.0f)),
                                .cutoff = static_cast<float>(settings.cutoff),
                                .choice = settings.branching == kBranchingChoice ? 1u : 0u};
  buffers_[0].write(&frame, sizeof(frame));
  if (!moved && !sets_.empty()) return;
  std::vector<Binding> own;
  paths_.buffers.add_bindings(own);
  buffers_.add_bindings(own);
  sets_ = bind_bands(workspace_, own);
}

bool Whitted::is_ready() {
  const bool film = paths_.is_ready(); // asks for both, so that both are begun
  return kernels_.ready(need_) && film;
}

double Whitted::get_ready() { return kernels_.best(need_).seconds() + paths_.get_ready(); }

std::uint32_t Whitted::most_samples() const {
  return 4096; // accumulate loops over them; Mesa 22.3 ends loops at 65,535 trips
}

gpu::Wave Whitted::wave(const FilmBand& band, std::uint32_t first_place, std::uint32_t pixel_count,
                        std::uint32_t first_sample, std::uint32_t count) const {
  return {first_place, pixel_count, first_sample, count, 0, band.first_pixel};
}

void Whitted::record_wave(Commands& commands, std::size_t band, const gpu::Wave& wave) {
  commands.bind(*sets_[band]);
  commands.dispatch(kernels_.best(need_)[0], groups_for(std::uint64_t{wave.pixel_count} * wave.sample_count), &wave);
  commands.barrier();
  commands.bind(paths_.bindings(band));
  commands.dispatch(paths_.kernels()[kAccumulate], groups_for(wave.pixel_count), &wave);
}

} // namespace wavepath
