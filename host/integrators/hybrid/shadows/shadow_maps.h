// Techniques that draw what lights see into maps, filter these perhaps, and look shadow rays up in them.
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

// A kernel that goes over every view, in submissions as short as they have to be. Push constant: first_pixel = first of
// the items of this dispatch, pixel_count = how many, sample_count = the view.
struct MapPass {
  std::size_t stage = 0;                                    // of the technique's program
  enum class Items { texels, lines } items = Items::texels; // lines: rows or columns
};

// For views that are fitted to what a frame shows.
struct FrameFit {
  // Runs a stage of the technique's program over the pixels of the frame and returns what becomes of these words.
  // `parts` is pushed as sample_count.
  std::function<std::vector<std::uint32_t>(std::size_t stage, const std::vector<std::uint32_t>& words,
                                           std::uint32_t parts)>
      reduce;
  const RenderPlan& settings;
  std::vector<gpu::ShadowView>& views; // to be fitted; those of `views` at first
  ShadowReport& report;
};

// What a technique of maps consists of, besides its program: stage 0 of that answers shadow rays, the others are the
// filter's; their layout is shadow_layout().
struct ShadowMapRecipe {
  bool casters = false; // maps hold what lies in none of the scene's large planes; look-ups know these planes
  bool cookie = false;  // look-ups take --shadow-cookie
  bool ids = false;     // maps hold triangles, besides depths
  bool taps = false;    // look-ups take filter taps
  bool counts = false;  // look-ups count what they answer
  double (*guard)(const RenderPlan& settings) = nullptr; // texels that look-ups reach beyond their position; null = 1
  // Views of a source; null = usual_views().
  std::vector<gpu::ShadowView> (*views)(const ShadowFit& fit, const ShadowSource& source, const View& view,
                                        const RenderPlan& settings) = nullptr;
  // Bytes a texel of what the filter makes of the depths, and of what it needs meanwhile; null = there is none.
  std::uint64_t (*filtered_bytes)(const RenderPlan& settings) = nullptr;
  std::uint64_t (*scratch_bytes)(const RenderPlan& settings) = nullptr;
  std::span<const MapPass> passes{}; // of a filter, one after the other
  double exponent = 0.0;             // --shadow-exponent unless that is given
  // Fits the views to every frame anew, from words that it reduces the frame to; how many at most. Null = the views
  // follow from the camera alone. Such a technique has no scratch of its own.
  std::uint32_t (*frame_words)(std::uint32_t views, const RenderPlan& settings) = nullptr;
  void (*fit_to_frame)(const FrameFit& fit) = nullptr;
  // Maps are virtual: only pages are there that stage 1 of the program asks for. Neither ids, nor filters.
  bool pages = false;
};

// One comparison with the nearest texel (map.cpp): of all techniques that differ by their views alone, and the settings
// of those that have no others.
extern const KernelProgram kCompareOnce;
inline constexpr std::array<std::string_view, 3> kMapSettings = {"shadow-size", "shadow-bias", "shadow-source"};

// Numbers and kinds of the bindings of kernels of shadow techniques, without buffers.
std::vector<Binding> shadow_layout();

// The technique of ShadowKind::maps.
std::unique_ptr<ShadowTechnique> make_shadow_maps(const ShadowContext& context);

} // namespace wavepath
