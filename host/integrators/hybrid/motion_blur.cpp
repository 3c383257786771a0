#include "host/integrators/hybrid/motion_blur.h"

#include "host/base/error.h"
#include "host/integrators/hybrid/bounce/catalogue.h"
#include "host/integrators/hybrid/reflections/catalogue.h"
#include "host/integrators/hybrid/shadows/catalogue.h"
#include "host/integrators/hybrid/transparency/catalogue.h"
#include "host/integrators/hybrid/voxel_settings.h"
#include "host/render/settings/integrator_kind.h"
#include "kernels/hybrid/motion_blur.spv.h"
#include "kernels/hybrid/motion_blur_tiles.spv.h"

namespace wavepath {
namespace {

// Pixels that a pixel may look at, over the 50 of other filters: two lines of kLongestBlur, of three texels each.
constexpr std::uint32_t kBlurCost = 16;

// Indexed by MotionBlur::OwnBuffer.
const std::vector<BufferRule> kMotionBlurRules = {
    {"frame",
     [](const BufferDimensions&) { return std::uint64_t{sizeof(gpu::Reprojection)}; },
     {{gpu::kFilterReprojection, BindingKind::uniform}}},
    {"result", vec4_a_pixel, {{gpu::kFilterColorOut, BindingKind::storage}}},
    {"longest velocities of tiles",
     [](const BufferDimensions& e) { return e.pixels * sizeof(gpu::vec2); }, // more than there are tiles
     {{gpu::kFilterTileVelocities, BindingKind::storage},
      {gpu::kFilterTileVelocityTexels, BindingKind::texels_rg32ui}}},
};

} // namespace

bool blurs_motion(const RenderPlan& settings) { return settings.moving && supports(*settings.integrator, "shutter"); }

void check_motion_settings(const RenderPlan& settings) {
  if (!blurs_motion(settings)) return;
  const auto refuse = [](const char* flag) {
    throw UsageError(flag,
                     "draws surfaces where they are as the shutter opens, and frames with --shutter are of its middle",
                     "leave out one of them");
  };
  if (settings.first_hit == kFirstHitRaster) refuse("--first-hit raster");
  if (kShadowTechniques.find(settings)) refuse("--shadows");
  if (kTransparencyTechniques.find(settings)) refuse("--transparency");
  if (kReflectionTechniques.find(settings)) refuse("--reflections");
  if (kBounceTechniques.find(settings)) refuse("--bounce");
  if (uses_voxels(settings)) refuse("--occlusion cones");
}

MotionBlur::MotionBlur(Device& device, std::uint32_t width, std::uint32_t height, const Buffer& gbuffer,
                       const Buffer& velocities, const Buffer& color)
    : width_(width),
      height_(height),
      tile_bands_(device, width, height),
      bands_(device, width, height, kBlurCost),
      buffers_(device, kMotionBlurRules) {
  buffers_.fit({.pixels = std::uint64_t{width} * height});
  std::vector<Binding> bindings = {{gpu::kFilterGbuffer, BindingKind::texels_rgba32ui, &gbuffer},
                                   {gpu::kFilterVelocities, BindingKind::texels_rg32ui, &velocities},
                                   {gpu::kFilterColorIn, BindingKind::texels_rgba32f, &color}};
  buffers_.add_bindings(bindings);
  set_ = std::make_unique<BindingSet>(device, bindings, static_cast<std::uint32_t>(sizeof(gpu::FilterBand)));
  const auto compile = [&](const char* name, std::span<const std::uint32_t> spirv) {
    return std::make_unique<Kernel>(device, name, spirv, *set_, std::span<const std::uint32_t>{});
  };
  tiles_ = compile("motion blur tiles", wavepath_motion_blur_tiles_spv);
  blur_ = compile("motion blur", wavepath_motion_blur_spv);
}

void MotionBlur::record_tiles(Commands& commands) {
  const gpu::Reprojection frame = reproject({}, {}, false, width_, height_);
  commands.write(buffers_[kFrame], &frame, sizeof(frame));
  commands.bind(*set_);
  tile_bands_.run(commands, *tiles_);
}

void MotionBlur::record_blur(Commands& commands, std::uint32_t band) {
  commands.bind(*set_);
  bands_.run_band(commands, *blur_, band);
}

} // namespace wavepath
