// The hybrid integrators: first hits, rasterized or traced for all pixels alike, shaded by the path tracer's own
// kernels, and ambient occlusion.
//
// A frame is one sample of the film: all pixels are seen through the same position of the pixel filter. Direct light is
// what the path tracer finds with --max-depth 1, by the same kernels. All light of more than one bounce is an ambient
// term: albedo * (1 - metallic) * ambient radiance * unoccluded fraction (after Zhukov et al. 1998; Landis 2002).
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "host/integrators/hybrid/kept.h"
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

class Denoiser;             // host/integrators/hybrid/denoise.h
class FrameFilter;          // host/integrators/hybrid/frame_filter.h
class ScreenSpaceOcclusion; // host/integrators/hybrid/occlusion/screen_space.h
struct OcclusionKind;       // host/integrators/hybrid/occlusion/technique.h
class Taa;                  // host/integrators/hybrid/taa.h

// Whether frames have light beyond the direct one, or are nothing but occlusion.
bool has_ambient(const RenderPlan& settings);

// How first hits are found where nothing else decides it: what takes this device less time. A CPU driver takes half a
// microsecond and more for a triangle that it draws, wherever that is, and a tenth to a third for a ray.
bool rasterizes_first_hits(const RenderPlan& settings, std::uint64_t triangles, const DeviceInfo& device);

// The kernels of frames under these settings, those of light left out, in the configuration that paths have.
KernelNeed hybrid_need(const RenderPlan& settings, const KernelConfig& config);

class Hybrid : public Integrator {
public:
  Hybrid(Workspace& workspace, KernelCompiler& kernels);
  ~Hybrid() override;

  // With TemporalHistory::keep the ambient radiance stays what it was, and filters over time still know the frames
  // before if their size is the same; what comes out then depends on them. Throws Error if the device cannot rasterize.
  void change(const View& view, const RenderPlan& settings, TemporalHistory history) override;
  bool is_ready() override;
  double get_ready() override;

  // Some thousand pixels, from whose light the ambient radiance is estimated, unless the settings give it or no ambient
  // term is wanted.
  std::optional<Pilot> pilot() override;
  bool end_pilot() override;

  std::uint32_t paths_per_pixel(std::uint32_t samples) const override;
  std::uint32_t most_samples(std::uint32_t) const override { return 1; }
  void begin_pass(WaveQueue& queue, std::uint32_t first_sample) override;
  gpu::Wave wave(const FilmBand& band, std::uint32_t first_entry, std::uint32_t pixel_count, std::uint32_t first_sample,
                 std::uint32_t count) const override;
  void record_wave(Commands& commands, std::size_t band, const gpu::Wave& wave) override;
  // Filters the frame if that is asked for, and adds it to the film.
  void end_pass(WaveQueue& queue) override;
  std::uint32_t timed_dispatches() const override { return 16; }
  std::uint64_t bytes() const override;
  void describe(RenderResult& result) const override;

private:
  bool lights() const { return frame_.flags & gpu::kHybridLights; }
  bool ambient() const { return frame_.flags & gpu::kHybridAmbient; }
  bool refracts() const { return frame_.flags & gpu::kHybridRefractive; }
  bool multisamples() const { return frame_.flags & gpu::kHybridMultisample; }
  struct Filters; // over frames
  void make_frame(const View& view, const RenderPlan& settings, TemporalHistory history);
  void allocate(const View& view, TemporalHistory history);
  void remake_filters(bool moved, TemporalHistory history);
  Filters make_filters();
  void remake_shadows(const View& view, const std::vector<Binding>& own);
  void remake_occlusion();
  void remake_shading(const std::vector<Binding>& own);
  void remake_layers(bool moved);
  glm::vec2 jitter(WaveQueue& queue, std::uint32_t sample);
  void light(Commands& commands, std::size_t band, const gpu::Wave& wave);
  void share_shading(WaveQueue& queue);
  void composite(WaveQueue& queue, std::uint32_t flags);
  bool filters_frames() const; // each by itself, for smooth edges
  void antialias(WaveQueue& queue);
  glm::vec3 enclosed_light() const;

  Workspace& workspace_;
  KernelCompiler& kernels_;
  Paths paths_;
  BufferSet buffers_;
  RenderPlan settings_;
  gpu::CameraView camera_;
  gpu::HybridFrame frame_{};
  bool rasterizes_ = true;     // otherwise frames are traced
  bool knows_ambient_ = false; // of frames before
  KernelNeed need_;
  Kept<Visibility, glm::u64vec4> visibility_;     // by width, height, features, sides and way
  std::vector<std::unique_ptr<BindingSet>> sets_; // by band
  FrameTimes antialias_times_;
  Kept<ShadowTechnique, const ShadowKind*> shadows_; // none where rays are traced
  ShadowTimes shadow_times_;
  Kept<ScreenSpaceOcclusion, const OcclusionKind*> occlusion_; // none where rays are traced
  bool piloting_ = false;                                      // until end_pilot()
  Kept<LocalShading, const ShadingKind*> shading_;             // none where materials are glTF's own
  struct LayersMadeFor {
    const LayerRecipe* recipe = nullptr;
    KernelConfig config;
    std::uint32_t width = 0, height = 0, layers = 0;
    bool operator==(const LayersMadeFor&) const = default;
  };
  Kept<Layers, LayersMadeFor> layers_; // none where BLEND surfaces are seen through otherwise
  Kept<Filters, glm::uvec4> filters_;  // by size, flags, and which
  std::vector<glm::vec2> jitters_;     // of frames from first_jitter_ on
  std::uint32_t first_jitter_ = 0;
  std::uint32_t next_sample_ = 0;           // whose frame may share the shading of those before it
  std::vector<std::uint32_t> pilot_pixels_; // pixels of the pilot, row-major
};

} // namespace wavepath
