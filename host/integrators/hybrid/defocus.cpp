#include "host/integrators/hybrid/defocus.h"

#include "host/render/settings/integrator_kind.h"
#include "kernels/hybrid/defocus.spv.h"
#include "kernels/hybrid/defocus_spots.spv.h"

namespace wavepath {
namespace {

// Pixels that a pixel may look at, over the 50 of other filters: a disc of radius kLargestSpot has 7,238.
constexpr std::uint32_t kSpreadCost = 128, kSpotCost = 32;

// Indexed by Defocus::OwnBuffer.
const std::vector<BufferRule> kDefocusRules = {
    {"frame",
     [](const BufferDimensions&) { return std::uint64_t{sizeof(gpu::Reprojection)}; },
     {{gpu::kFilterReprojection, BindingKind::uniform}}},
    {"lens",
     [](const BufferDimensions&) { return std::uint64_t{sizeof(gpu::DefocusLens)}; },
     {{gpu::kFilterLens, BindingKind::uniform}}},
    {"result", vec4_a_pixel, {{gpu::kFilterColorOut, BindingKind::storage}}},
    {"spots",
     vec4_a_pixel,
     {{gpu::kFilterSpots, BindingKind::storage}, {gpu::kFilterSpotTexels, BindingKind::texels_rgba32f}}},
    {"largest spots of tiles",
     [](const BufferDimensions& e) { return e.pixels * sizeof(float); }, // more than there are tiles
     {{gpu::kFilterTileSpots, BindingKind::storage}, {gpu::kFilterTileSpotTexels, BindingKind::texels_r32f}}},
};

} // namespace

bool has_lens(const RenderPlan& settings) {
  return settings.lens.aperture > 0.0 && supports(*settings.integrator, "aperture");
}

gpu::DefocusLens defocus_lens(const gpu::Frame& frame) {
  const float pixel = 2.0f * glm::length(frame.camera_right) / static_cast<float>(frame.width); // at unit distance
  const float radius = frame.lens_radius / pixel;
  const bool parallel = frame.orthographic != 0;
  return {frame.focus_distance, parallel ? radius : radius / frame.focus_distance, parallel ? 1u : 0u, 0.0f};
}

Defocus::Defocus(Device& device, std::uint32_t width, std::uint32_t height, const Buffer& gbuffer, const Buffer& color)
    : width_(width),
      height_(height),
      spot_bands_(device, width, height, kSpotCost),
      bands_(device, width, height, kSpreadCost),
      buffers_(device, kDefocusRules) {
  buffers_.fit({.pixels = std::uint64_t{width} * height});
  std::vector<Binding> bindings = {{gpu::kFilterGbuffer, BindingKind::texels_rgba32ui, &gbuffer},
                                   {gpu::kFilterColorIn, BindingKind::texels_rgba32f, &color}};
  buffers_.add_bindings(bindings);
  set_ = std::make_unique<BindingSet>(device, bindings, static_cast<std::uint32_t>(sizeof(gpu::FilterBand)));
  const auto compile = [&](const char* name, std::span<const std::uint32_t> spirv) {
    return std::make_unique<Kernel>(device, name, spirv, *set_, std::span<const std::uint32_t>{});
  };
  spots_ = compile("defocus spots", wavepath_defocus_spots_spv);
  spread_ = compile("defocus", wavepath_defocus_spv);
}

void Defocus::record_spots(Commands& commands, const gpu::DefocusLens& lens) {
  const gpu::Reprojection frame = reproject({}, {}, false, width_, height_);
  commands.write(buffers_[kFrame], &frame, sizeof(frame));
  commands.write(buffers_[kLens], &lens, sizeof(lens));
  commands.bind(*set_);
  spot_bands_.run(commands, *spots_);
}

void Defocus::record_spread(Commands& commands, std::uint32_t band) {
  commands.bind(*set_);
  bands_.run_band(commands, *spread_, band);
}

} // namespace wavepath
