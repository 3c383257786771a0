#include "host/integrators/hybrid/shading/local_shading.h"

namespace wavepath {
namespace {

gpu::ShadingFrame shading_frame(const RenderPlan& settings) {
  gpu::ShadingFrame frame{};
  if (settings.attenuation) {
    frame.attenuation = *settings.attenuation;
    frame.flags |= gpu::kShadingAttenuates;
  }
  if (settings.depth_cue) {
    frame.cue = *settings.depth_cue;
    frame.flags |= gpu::kShadingCues;
  }
  frame.shininess = static_cast<float>(settings.shininess.value_or(-1.0));
  frame.interpolation = settings.interpolation;
  return frame;
}

} // namespace

std::vector<Binding> local_layout() {
  std::vector<Binding> layout = path_layout();
  layout.push_back({gpu::kBindShading, BindingKind::uniform, nullptr});
  return layout;
}

LocalShading::LocalShading(Workspace& workspace, KernelCompiler& kernels, const ShadingKind& kind)
    : workspace_(workspace),
      kernels_(kernels),
      kind_(kind),
      frame_buffer_(workspace.device, sizeof(gpu::ShadingFrame)) {}

void LocalShading::change(const RenderPlan& settings, const KernelConfig& config, const std::vector<Binding>& paths) {
  need_ = whole_need(*kind_.program, config);
  kernels_.start(need_);
  const gpu::ShadingFrame frame = shading_frame(settings);
  frame_buffer_.write(&frame, sizeof(frame));
  std::vector<Binding> own = paths;
  own.push_back({gpu::kBindShading, BindingKind::uniform, &frame_buffer_});
  sets_ = bind_bands(workspace_, own);
}

void LocalShading::record(Commands& commands, std::size_t band, const gpu::Wave& wave) {
  commands.bind(*sets_[band]);
  commands.dispatch(kernels_.best(need_)[0], groups_for(std::uint64_t{wave.pixel_count} * wave.sample_count), &wave);
}

} // namespace wavepath
