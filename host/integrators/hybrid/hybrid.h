// The hybrid integrators: a rasterized first hit, shaded by the path tracer's own kernels, and ambient occlusion.
//
// A frame is one sample of the film: all pixels are seen through the same place of the pixel filter. Direct light is
// what the path tracer finds with --max-depth 1, by the same kernels. All light of more than one bounce is an ambient
// term: albedo * (1 - metallic) * ambient radiance * unoccluded share (after Zhukov et al. 1998; Landis 2002).
#pragma once

#include <array>
#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "host/integrators/path/path_tracer.h"
#include "kernels/frame_types.h"
#include "kernels/hybrid/filter_types.h"
#include "kernels/hybrid/hybrid_types.h"

namespace wavepath {

class Denoiser; // host/render/denoise.h
class Taa;      // host/render/taa.h

class Hybrid {
public:
  // Renders into the film of `tracer`, which was made with the same settings and outlives it. Begins compiling its
  // kernels. Throws Error if the device cannot rasterize.
  Hybrid(Device& device, PathTracer& tracer, const PackedScene& scene, const View& view,
         const RenderSettings& settings);
  ~Hybrid();

  // Goes on with another view and other settings, to which the tracer has been changed. With Past::keep the ambient
  // radiance stays what it was, and filters over time still know the frames before if their size is the same; what
  // comes out then depends on them.
  enum class Past { forget, keep };
  void change(const PackedScene& scene, const View& view, const RenderSettings& settings, Past past = Past::forget);

  // Whether the kernels are compiled, so that get_ready() will not wait.
  bool is_ready() const;
  // Comes before the first frame and after every change. Returns the seconds that compiling took. Throws what compiling
  // threw.
  double get_ready();

  // Rasterizes the frame that is sample `sample` of the film. Returns the longest submission in seconds.
  double begin_frame(std::uint32_t sample);
  // Lights pixels [first_pixel, first_pixel + pixel_count) of a band, at most slots() / samples_per_pixel(). Returns
  // the longest dispatch.
  double render_wave(const FilmBand& band, std::uint32_t first_pixel, std::uint32_t pixel_count);
  // Filters the frame if that is asked for, and adds it to the film. Returns the longest dispatch.
  double end_frame();

  // What a pixel counts for in a wave: its light samples, which take slots, or its occlusion rays if those are more.
  std::uint32_t samples_per_pixel() const;
  std::uint64_t bytes() const; // of what it has besides the tracer's memory
  glm::vec3 ambient() const { return frame_.ambient; }

  // Estimates the ambient radiance from a frame that is thrown away, unless the settings name it or there is no need.
  // It depends on scene, view and settings alone, and takes the light of some thousand pixels.
  void estimate_ambient();

private:
  enum Stage : std::size_t { kJitter, kResolve, kOcclusion, kGather, kComposite, kFrameStageCount };

  struct Kernels {
    std::array<std::optional<Kernel>, kFrameStageCount> by_stage;
    double seconds = 0.0; // that compiling took
  };
  struct Needs { // of kernels
    KernelConfig config;
    std::uint32_t flags = 0;
    bool operator==(const Needs&) const = default;
  };
  const Kernel& kernel(Stage stage) const { return *kernels_->by_stage[stage]; }
  static Kernels compile(Device& device, const Needs& needs);
  void remake_filters(Past past);
  double composite(std::uint32_t flags);
  double antialias();
  glm::vec2 jitter(std::uint32_t sample);
  void light(Commands& commands, gpu::Wave wave, std::uint32_t groups);
  std::vector<std::uint32_t> light_pilot();
  glm::vec3 enclosed_light(std::span<const std::uint32_t> places) const;

  Device& device_;
  PathTracer& tracer_;
  RenderSettings settings_;
  gpu::CameraView camera_;
  gpu::HybridFrame frame_{};
  bool edges_hold_ = true; // otherwise frames are traced
  Needs needs_;
  std::future<Kernels> compiling_; // valid until the kernels are in use
  std::unique_ptr<Kernels> kernels_;
  std::unique_ptr<Denoiser> denoiser_;
  std::unique_ptr<Taa> taa_;
  glm::uvec4 filters_made_for_{0}; // size, flags, and which
  const BindingSet* filters_bound_ = nullptr;
  std::vector<glm::vec2> jitters_; // of frames from first_jitter_ on
  std::uint32_t first_jitter_ = 0;
};

} // namespace wavepath
