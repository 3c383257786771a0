// Shadow maps: draws the views of lights into maps, filters them if the technique does, and looks shadow rays up in
// them.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "host/gpu/raster.h"
#include "host/integrators/hybrid/raster/culling.h"
#include "host/integrators/hybrid/raster/slices.h"
#include "host/integrators/hybrid/shadows/technique.h"
#include "host/integrators/hybrid/shadows/views.h"

namespace wavepath {

struct ShadowMapRecipe;

// A pass of a kernel over every view, in short submissions. Push constants: first_pixel = first item of the dispatch,
// pixel_count = number of items, sample_count = the view.
struct MapPass {
  std::size_t stage = 0;                                    // stage of the technique's program
  enum class Items { texels, lines } items = Items::texels; // lines: rows or columns
};

// Arguments for fitting views to the contents of a frame.
struct FrameFit {
  // Runs a stage of the technique's program over the pixels of the frame, and returns the words that it has changed.
  // `parts`: pushed as sample_count.
  std::function<std::vector<std::uint32_t>(std::size_t stage, const std::vector<std::uint32_t>& words,
                                           std::uint32_t parts)>
      reduce;
  const RenderPlan& settings;
  std::vector<gpu::ShadowView>& views; // views to fit; initially those of ShadowMapRecipe::views
  ShadowReport& report;
};

// Recipe of a technique of maps, besides its program. Stage 0 of the program answers shadow rays; the others belong to
// the filter. Their layout is shadow_layout().
struct ShadowMapRecipe {
  bool casters = false; // maps contain only surfaces outside of the scene's large planes, which look-ups know
  bool cookie = false;  // look-ups support --shadow-cookie
  bool ids = false;     // maps hold ids of triangles besides depths
  bool taps = false;    // look-ups use filter taps
  bool counts = false;  // look-ups count the rays that they answer
  double (*guard)(const RenderPlan& settings) = nullptr; // texels around its position that a look-up reads; null = 1
  // Makes the views of a source. Null = usual_views().
  std::vector<gpu::ShadowView> (*views)(const ShadowFit& fit, const ShadowSource& source, const View& view,
                                        const RenderPlan& settings) = nullptr;
  // Bytes for each texel of the filter's result, and of its temporary data. Null = no filter.
  std::uint64_t (*filtered_bytes)(const RenderPlan& settings) = nullptr;
  std::uint64_t (*scratch_bytes)(const RenderPlan& settings) = nullptr;
  std::span<const MapPass> passes{}; // passes of the filter, in order
  double exponent = 0.0;             // default of --shadow-exponent
  // Fits the views to every frame, from words to which the frame is reduced; frame_words() is the largest number of
  // these. Null = the views depend on the camera alone. Such a technique has no temporary filter data.
  std::uint32_t (*frame_words)(std::uint32_t views, const RenderPlan& settings) = nullptr;
  void (*fit_to_frame)(const FrameFit& fit) = nullptr;
  // Maps are virtual: only those pages exist that stage 1 of the program requests. Excludes ids and filters.
  bool pages = false;
};

// Program of one comparison with the nearest texel (map.cpp), for all techniques that differ in their views alone; and
// the settings of those without further ones.
extern const KernelProgram kCompareOnce;
inline constexpr std::array<std::string_view, 3> kMapSettings = {"shadow-size", "shadow-bias", "shadow-source"};

// Numbers and kinds of the bindings of kernels of shadow techniques, without buffers.
std::vector<Binding> shadow_layout();

// Makes the technique that ShadowKind::maps describes.
std::unique_ptr<ShadowTechnique> make_shadow_maps(const ShadowContext& context);

} // namespace wavepath
