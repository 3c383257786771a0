// `wavepath study`: renders a grid of configurations and measures each against one converged reference.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/gpu/device.h"
#include "host/picture/metrics/metrics.h"
#include "host/picture/metrics/shadow_score.h"
#include "host/render/render.h"
#include "host/render/settings/denoising.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/shadow_settings.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"
#include "host/study/grid.h"

namespace wavepath {

// Fraction of the rendering time for the reference, so that the best of nine configurations still ends at several times
// its error.
inline constexpr double kReferenceFraction = 0.5;
// The same where shadows vary, since techniques have a truth of their own.
inline constexpr double kShadowReferenceFraction = 0.2;
// Fraction of the rendering time for the reference of ambient occlusion, if the grid has any. It is taken from the
// rest.
inline constexpr double kOcclusionFraction = 0.1;
// Below this multiple of the reference's own error, that error is more than a tenth of the MSE measured.
inline constexpr double kFloor = 3.0;

struct StudySettings {
  RenderPlan render; // settings common to all configurations
  std::vector<std::string> vary;
  double budget = 60.0;            // seconds of rendering in all
  std::uint32_t reference_spp = 0; // 0 = what fits into a fraction of the budget
};

// The scene as each light strategy and each way to filter textures want it packed.
struct StudyScene {
  // kDirect... and kTextures... constants.
  using Key = std::pair<std::uint32_t, std::uint32_t>;
  static Key key_of(const RenderPlan& settings) { return {direct_of(settings), settings.textures}; }

  std::map<Key, PackedScene> packed;
  View view;

  // For settings of the grid, or for its common ones.
  const PackedScene& packed_for(const RenderPlan& settings) const { return packed.at(key_of(settings)); }
};

// The setting that the grid varies and that has a truth of its own, its value `traced`: reflections or the bounce of
// hybrid frames. A reference of paths would show the errors of light that all of them leave out. Empty = none.
std::string_view traced_setting(const StudySettings& settings);

struct StudyReference {
  Picture picture;
  std::string file;            // empty if rendered here
  std::optional<double> error; // its own relative RMS error
  std::uint32_t seed = 0, spp = 0;
  double seconds = 0.0;
};

struct StudyPoint {
  std::uint32_t spp = 0, seed = 0;
  double seconds = 0.0, gpu_seconds = 0.0;
  std::uint64_t rays = 0;
  PictureMetrics metrics; // against the reference of what the picture shows
  double flip = 0.0;      // mean
  std::optional<double> estimated_error;
  // Metrics of direct light and of occlusion alone, if the grid has rasterized frames.
  std::optional<PictureMetrics> direct, occlusion;
  std::optional<ShadowScore> shadows;      // if the grid varies shadows
  std::optional<ShadowReport> shadow_work; // reports of shadow techniques

  double relative_rms() const;
  double efficiency() const { return 1.0 / (metrics.mse * seconds); }
  double ms_per_frame() const { return 1000.0 * seconds / spp; } // a frame is a sample of every pixel
};

// Pictures of a configuration; of its last point only, because pictures are large.
struct StudyPicture {
  std::size_t point = 0;
  Picture picture;
  std::vector<float> flip;
  std::optional<Picture> false_shadows; // if the grid varies shadows
};

struct Series {
  Configuration configuration;
  std::vector<StudyPoint> points; // 1, 2, 4, ... samples a pixel, each a render of its own
  std::vector<StudyPicture> pictures;

  bool shows_occlusion() const { return !configuration.settings.integrator->finds_light; }
  // True if it converges to something other than the reference.
  bool is_biased() const {
    return configuration.settings.integrator->is_biased(configuration.settings) ||
           denoises_film(configuration.settings);
  }
};

// Cost of finding first hits, in milliseconds a frame on the device: rasterized and resolved; traced.
struct FirstHits {
  double rasterized = 0.0, traced = 0.0;
  std::uint32_t frames = 0;
};

// A configuration that cannot render this scene.
struct Unsupported {
  std::string name, why;
};

struct Study {
  StudyReference reference;
  std::optional<StudyReference> occlusion; // reference of ambient occlusion alone, if the grid has any
  std::optional<FirstHits> first_hits;     // if the grid has hybrid configurations
  std::vector<Series> series;              // the naive configuration first
  std::vector<Unsupported> unsupported;
  bool interrupted = false;
  std::string lost; // reason of the end, if the device was lost

  const StudyReference& reference_of(const Series& one) const { return one.shows_occlusion() ? *occlusion : reference; }
  bool at_floor(const Series& one, double relative_rms) const {
    const std::optional<double>& error = reference_of(one).error;
    return error && relative_rms < kFloor * *error;
  }
};

struct StudyProgress {
  std::string what;
  double seconds = 0.0; // rendering so far
};
using StudyCallback = std::function<bool(const StudyProgress&)>; // false = stop with what there is

// `scene` holds every light strategy of the grid and MIS. `reference`: one that is there already. Throws as render()
// does.
Study run_study(Device& device, const StudyScene& scene, const StudySettings& settings,
                std::optional<StudyReference> reference, const StudyCallback& progress);

} // namespace wavepath
