#include "host/integrators/hybrid/shadows/look_up_technique.h"

#include <algorithm>

#include "kernels/hybrid/hybrid_types.h"

namespace wavepath {

std::vector<Binding> look_up_layout(std::span<const BufferRule> rules) {
  std::vector<Binding> layout = path_layout();
  add_layout(rules, layout);
  layout.push_back({gpu::kBindHybrid, BindingKind::uniform, nullptr});
  layout.push_back({gpu::kBindVisibility, BindingKind::texels_rg32ui, nullptr});
  return layout;
}

LookUpTechnique::LookUpTechnique(const ShadowContext& context, std::span<const BufferRule> rules)
    : kind_(context.kind),
      workspace_(context.workspace),
      kernels_(context.kernels),
      sources_(context.sources),
      buffers_(context.workspace.device, rules) {}

void LookUpTechnique::record_look_up(Commands& commands, std::size_t band, const gpu::Wave& wave) {
  commands.bind(*sets_[band]);
  commands.dispatch(kernels_.best(need_)[0], groups_for(std::uint64_t{wave.pixel_count} * wave.sample_count), &wave);
}

void LookUpTechnique::start_kernels(const View& view, const RenderPlan& settings) {
  need_ = whole_need(*kind_.program, kernel_config(needed_features(workspace_.scene, view, settings),
                                                   workspace_.scene.stack_size, settings));
  kernels_.start(need_);
}

void LookUpTechnique::upload_frame(const gpu::ShadowFrame& frame) {
  buffers_[0] = upload(workspace_.device, std::vector<gpu::ShadowFrame>{frame});
}

std::vector<glm::uvec2> LookUpTechnique::sources_of_lights() const {
  std::vector<glm::uvec2> sources(std::max<std::size_t>(workspace_.scene.lights.size(), 1), glm::uvec2(gpu::kNone, 0));
  for (std::uint32_t i = 0; i < sources_.size(); ++i)
    for (const std::uint32_t light : sources_[i].lights) sources[light] = glm::uvec2(i, 1);
  return sources;
}

void LookUpTechnique::bind(const std::vector<Binding>& shared) {
  std::vector<Binding> bindings = shared;
  buffers_.add_bindings(bindings);
  sets_ = bind_bands(workspace_, bindings);
}

void LookUpTechnique::bind_draws(const std::vector<Binding>& frame) {
  std::vector<Binding> bindings = workspace_.bindings(workspace_.film.bands().front());
  for (const Binding& binding : frame)
    if (binding.slot == gpu::kBindHybrid || binding.slot == gpu::kBindVisibility) bindings.push_back(binding);
  buffers_.add_bindings(bindings);
  raster_set_ = std::make_unique<BindingSet>(workspace_.device, bindings, sizeof(gpu::Wave), BindingSet::kRasterStages);
}

} // namespace wavepath
