// A render that a window steps: a wave at a time, coarse while the camera moves, begun anew when anything changes.
#pragma once

#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/film/film.h"
#include "host/render/governor.h"
#include "host/integrators/hybrid/hybrid.h"
#include "host/integrators/path/path_tracer.h"
#include "host/render/render.h"

namespace wavepath {

// What a window tells about the render.
struct ProgressiveStatus {
  bool compiling = false;     // kernels are; until they are ready nothing new is rendered
  bool done = false;          // all samples are in
  std::uint32_t coarse = 1;   // a rendered pixel is this many pixels wide and high on screen
  std::uint32_t spp = 0;      // samples that every pixel has; at `coarse`
  std::uint32_t planned = 0;  // and is to get
  double fraction = 0.0;      // of the samples planned
  double seconds = 0.0;       // rendering since it was begun anew
  double frame_seconds = 0.0; // that one sample of every pixel takes, at `coarse`
  double mrays_per_second = 0.0;
  ErrorEstimate error;         // zero until known
  std::uint32_t error_spp = 0; // samples a pixel that it was estimated at
  double slope = -0.5;         // of log error against log time
  MemoryUse memory;
  glm::vec3 ambient{0.0f}; // radiance that hybrid frames use
};

class Progressive {
public:
  // Uploads the scene. `scene` and `kernels` outlive it. The picture has settings.width times height pixels, which is
  // what `view` is resolved for, and is done at settings.last_sample. Settings of time, error and adaptive sampling
  // play no part. Throws Error if the device cannot hold it.
  Progressive(Device& device, const PackedScene& scene, const View& view, const RenderSettings& settings,
              KernelCompiler& kernels);
  ~Progressive(); // waits for an estimate in progress

  // Renders one wave, in about 30 ms; of a hybrid frame the first one also draws it and the last one finishes it. False
  // if there was nothing to do: the kernels are not ready, or all samples are in.
  bool step();

  // Each begins anew. move(): coarse, so that there is a picture about every 100 ms, until rest(), which goes on in
  // full. A picture that a move has begun is completed first, however fast others follow; view() tells whose it is.
  void move(const View& view);
  void rest();
  void set_view(const View& view); // in full at once
  // Anything but the scene, the size and the AOVs included; `view` is resolved for the new size. Keeps what it can of
  // what is on the device; the scene always. settings.direct may be any, whatever the scene was packed for but
  // kDirectBsdf.
  void set_settings(const RenderSettings& settings, const View& view);
  // Another scene, or the same one packed anew; uploads it.
  void set_scene(const PackedScene& scene, const View& view);

  const RenderSettings& settings() const { return settings_; }
  const View& view() const { return view_; }
  bool moving() const { return moving_; }
  ProgressiveStatus status() const;
  // Rendering seconds until the estimated error is `target`; infinite while that cannot be told.
  double seconds_to(double target) const;

  // The exact sums so far and the picture that they make, as render() develops it: of `coarse` size while it moves.
  Film film() const;
  Picture picture() const;

  const PathTracer& tracer() const { return *tracer_; } // for Display
  const PackedScene& scene() const { return *scene_; }
  std::uint32_t film_width() const { return rendered_.width; }
  std::uint32_t film_height() const { return rendered_.height; }

private:
  struct Estimate {
    Checkpoint point;
    double seconds = 0.0; // that it took
  };

  std::uint32_t spp() const { return sample_ - settings_.first_sample; }
  bool is_done() const { return sample_ >= settings_.last_sample; }
  void begin_anew(std::uint32_t coarse);
  // Whether what is rendered is for the time being: coarse, or joined to frames of other views.
  bool is_for_motion() const { return coarse_ > 1 || rendered_.antialias_over_time; }
  void reset_pass();
  std::uint32_t choose_coarse() const;
  void begin_pass();
  void render_wave();
  void end_pass();
  void estimate();
  void collect_estimate();

  Device& device_;
  const PackedScene* scene_;
  KernelCompiler& kernels_;
  RenderSettings settings_; // as asked for
  RenderSettings rendered_; // and as they are rendered: smaller while the camera moves
  View view_;
  std::optional<View> next_view_; // moved to while a picture was not complete
  std::unique_ptr<PathTracer> tracer_;
  std::unique_ptr<Hybrid> hybrid_; // of the hybrid integrators
  Governor governor_;

  std::uint32_t motion_frames_ = 0; // hybrid frames while the camera moved
  bool moving_ = false, compiling_ = false;
  std::uint32_t coarse_ = 1;
  std::uint32_t sample_ = 0, pass_samples_ = 0; // the pass in progress adds [sample_, sample_ + pass_samples_)
  std::size_t band_ = 0;                        // where in the film it is
  std::uint32_t pixels_done_ = 0;
  double seconds_ = 0.0, pass_seconds_ = 0.0; // of whole passes, and of this one
  RayCounts rays_;
  double pixel_sample_seconds_ = 0.0; // of the last pass; 0 = unknown
  std::vector<Checkpoint> checkpoints_;
  std::future<Estimate> estimating_;
  bool estimate_is_stale_ = false;                               // was begun for what is no longer on the film
  double estimate_seconds_ = 0.0, estimate_pixel_seconds_ = 0.0; // in all since begun anew, and a pixel of the last one
};

} // namespace wavepath
