// The hybrid integrators: first hits are rasterized, or traced for all pixels; the path tracer's kernels shade them;
// ambient occlusion dims the rest.
//
// A frame is one sample of the film: all pixels are seen through the same position of the pixel filter. Direct light is
// that of the path tracer with --max-depth 1, found by the same kernels. Light of more than one bounce is an ambient
// term: albedo * (1 - metallic) * ambient radiance * unoccluded fraction (after Zhukov et al. 1998; Landis 2002).
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "host/integrators/hybrid/kept.h"
#include "host/integrators/hybrid/reflections/technique.h"
#include "host/integrators/hybrid/shading/local_shading.h"
#include "host/integrators/hybrid/shadows/technique.h"
#include "host/integrators/hybrid/shadows/times.h"
#include "host/integrators/hybrid/transparency/layers.h"
#include "host/integrators/hybrid/visibility.h"
#include "host/integrators/path/paths.h"
#include "host/render/loop/render_result.h"
#include "kernels/hybrid/filter_types.h"
#include "kernels/hybrid/hybrid_types.h"

namespace wavepath {

inline constexpr gpu::Feature kHybridLacks = gpu::kFeatureVoxels; // what no frame can show of a scene

class Beams;                // host/integrators/hybrid/beams.h
class Denoiser;             // host/integrators/hybrid/denoise.h
class FrameFilter;          // host/integrators/hybrid/frame_filter.h
class ScreenSpaceOcclusion; // host/integrators/hybrid/occlusion/screen_space.h
struct OcclusionKind;       // host/integrators/hybrid/occlusion/technique.h
class SurfaceVoxels;        // host/integrators/hybrid/voxels/surface_voxels.h
class Taa;                  // host/integrators/hybrid/taa.h

// True if frames have an ambient term, or show occlusion alone.
bool has_ambient(const RenderPlan& settings);

// True if first hits are rasterized, where settings leave it open: the faster way on this device. A CPU driver takes
// half a microsecond and more to draw a triangle, wherever it is, and 0.1 to 0.3 microseconds for a ray.
bool rasterizes_first_hits(const RenderPlan& settings, std::uint64_t triangles, const DeviceInfo& device);

// The kernels of frames with these settings, without those that shade, in the configuration of the paths' kernels.
KernelNeed hybrid_need(const RenderPlan& settings, const KernelConfig& config);

class Hybrid : public Integrator {
public:
  Hybrid(Workspace& workspace, KernelCompiler& kernels);
  ~Hybrid() override;

  // With TemporalHistory::keep the ambient radiance stays the same, and filters over time keep earlier frames of the
  // same size; the result then depends on them. Throws Error if the device cannot rasterize but must.
  void change(const View& view, const RenderPlan& settings, TemporalHistory history) override;
  bool is_ready() override;
  double get_ready() override;

  // Some thousand pixels, from whose light the ambient radiance is estimated. None if the settings give that radiance
  // or there is no ambient term.
  std::optional<Pilot> pilot() override;
  bool end_pilot() override;

  std::uint32_t paths_per_pixel(std::uint32_t samples) const override;
  std::uint32_t most_samples(std::uint32_t) const override { return 1; }
  void begin_pass(WaveQueue& queue, std::uint32_t first_sample) override;
  gpu::Wave wave(const FilmBand& band, std::uint32_t first_entry, std::uint32_t pixel_count, std::uint32_t first_sample,
                 std::uint32_t count) const override;
  void record_wave(Commands& commands, std::size_t band, const gpu::Wave& film_wave) override;
  // Filters the frame if that is asked for, and adds it to the film.
  void end_pass(WaveQueue& queue) override;
  // A wave and the mirrored ones, two of each dispatch that traces.
  std::uint32_t timed_dispatches() const override { return reflections_ ? 48 : 16; }
  std::uint64_t bytes() const override;
  void describe(RenderResult& result) const override;

private:
  bool lights() const { return frame_.flags & gpu::kHybridLights; }
  bool ambient() const { return frame_.flags & gpu::kHybridAmbient; }
  bool refracts() const { return frame_.flags & gpu::kHybridRefractive; }
  bool reflects() const { return frame_.flags & gpu::kHybridReflections; }
  bool multisamples() const { return frame_.flags & gpu::kHybridMultisample; }
  bool sees_parts() const { return frame_.flags & gpu::kHybridFractions; }
  struct Filters; // filters of finished frames
  void make_frame(const View& view, const RenderPlan& settings, TemporalHistory history);
  void allocate(const View& view, TemporalHistory history);
  void remake_filters(bool moved, TemporalHistory history);
  Filters make_filters();
  void remake_voxels();
  void remake_shadows(const View& view, const std::vector<Binding>& own);
  void remake_beams();
  void remake_occlusion();
  void remake_shading(const std::vector<Binding>& own);
  void remake_layers(bool moved);
  void remake_reflections(const View& view, const std::vector<Binding>& own);
  glm::vec2 jitter(WaveQueue& queue, std::uint32_t sample);
  glm::vec2 jitter_of_half(glm::vec2 jitter, std::uint32_t sample);
  std::uint32_t frame_index(std::uint32_t film_index) const;
  gpu::Wave wave_of_frame(gpu::Wave wave) const;
  void see(WaveQueue& queue);
  // `shadows`: null = all shadows are traced.
  void light(Commands& commands, std::size_t band, const gpu::Wave& wave, ShadowTechnique* shadows);
  // Submits a kernel that has one lane for each pixel, row by row.
  void for_all_pixels(WaveQueue& queue, std::size_t stage, const WaveQueue::Work& work);
  void composite(WaveQueue& queue, std::uint32_t flags);
  // `stage`: kComposite, or of the upscaled frame. `flags`: of HybridFrame.
  void add_to_film(WaveQueue& queue, std::size_t stage, std::uint32_t flags);
  bool filters_frames() const;         // true if each frame is filtered by itself, for smooth edges
  void spread_spots(WaveQueue& queue); // of a lens
  void blur_motion(WaveQueue& queue);  // while the shutter is open
  void antialias(WaveQueue& queue);
  glm::vec3 enclosed_light() const;

  Workspace& workspace_;
  KernelCompiler& kernels_;
  Paths paths_;
  BufferSet buffers_;
  // Settings and camera of frames, which have half the picture's size where they are upscaled.
  RenderPlan settings_;
  gpu::CameraView camera_;
  ShownPart shown_;
  glm::uvec2 shown_size_{0};     // of the picture
  gpu::CameraView shown_camera_; // of the picture, for upscaling
  std::uint32_t place_ = 0;      // of the frame's pixels among the picture's, for upscaling: see FilterBand::step
  gpu::HybridFrame frame_{};
  bool rasterizes_ = true;     // false: first hits are traced
  bool knows_ambient_ = false; // from earlier frames
  KernelNeed need_;
  Kept<Visibility, glm::u64vec4> visibility_;     // key: width, height, features, and the options of Visibility
  std::vector<std::unique_ptr<BindingSet>> sets_; // one for each band
  Kept<Beams, std::uint32_t> beams_;              // key: their shape; null if frames see whole pixels
  FrameTimes antialias_times_;
  Kept<SurfaceVoxels, std::uint32_t> voxels_;        // null if nothing traces cones; key: voxels along a side
  Kept<ShadowTechnique, const ShadowKind*> shadows_; // null if shadow rays are traced
  ShadowTimes shadow_times_;
  Kept<ScreenSpaceOcclusion, const OcclusionKind*> occlusion_; // null if occlusion rays are traced
  bool piloting_ = false;                                      // until end_pilot()
  Kept<LocalShading, const ShadingKind*> shading_;             // null if glTF's own BSDF shades
  struct LayersMadeFor {
    const LayerRecipe* recipe = nullptr;
    KernelConfig config;
    std::uint32_t width = 0, height = 0, layers = 0;
    bool operator==(const LayersMadeFor&) const = default;
  };
  Kept<Layers, LayersMadeFor> layers_; // null if no technique draws BLEND surfaces in layers
  // The technique of mirrors, or of a bounce; null if there is neither. Key: kind, and voxels along a side if it looks
  // at them.
  Kept<ReflectionTechnique, std::pair<const ReflectionKind*, std::uint32_t>> reflections_;
  Kept<Filters, glm::uvec4> filters_; // key: size, flags, kinds of filters
  std::vector<glm::vec2> jitters_;    // positions in the pixel of the frames from first_jitter_ on
  std::uint32_t first_jitter_ = 0;
  std::uint32_t next_sample_ = 0;           // sample whose frame may use the shading, or the beams, of earlier ones
  std::vector<std::uint32_t> pilot_pixels_; // pixels of the pilot, row-major
};

} // namespace wavepath
