// A render that a window steps: a wave at a time, coarse while the camera moves, begun anew when anything changes.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "host/film/film.h"
#include "host/render/loop/render_loop.h"

namespace wavepath {

// What a window tells about the render.
struct ProgressiveStatus {
  bool compiling = false;     // kernels are; until they are ready nothing new is rendered
  bool done = false;          // all samples are in, of the picture at rest
  std::uint32_t coarse = 1;   // a rendered pixel is this many pixels wide and high on screen
  std::uint32_t spp = 0;      // samples that every pixel has; at `coarse`
  std::uint32_t planned = 0;  // and is to get
  double fraction = 0.0;      // of the samples planned
  double seconds = 0.0;       // that the device has rendered since it was begun anew
  double frame_seconds = 0.0; // that one sample of every pixel takes, at `coarse`
  double mrays_per_second = 0.0;
  ErrorEstimate error;         // zero until known
  std::uint32_t error_spp = 0; // samples a pixel that it was estimated at
  double slope = -0.5;         // of log error against log time
  MemoryUse memory;
  glm::vec3 ambient{0.0f};             // radiance that hybrid frames use
  std::optional<ShadowReport> shadows; // of a shadow technique
};

class Progressive {
public:
  // Uploads the scene, unless it is there. `scene` and `kernels` outlive it. The picture has settings.width times
  // height pixels, which is what `view` is resolved for, and is done at settings.last_sample. Settings of time, error
  // and adaptive sampling play no part. Throws Error if the device cannot hold it.
  Progressive(Device& device, const PackedScene& scene, const View& view, const RenderPlan& settings,
              KernelCompiler& kernels, std::shared_ptr<const DeviceScene> uploaded = nullptr);
  // Another render of the same scene and view, which shares what is on the device of the scene.
  std::unique_ptr<Progressive> beside(const RenderPlan& settings) const;

  // Hands over one wave of about 15 ms and waits for an older one; of a hybrid frame the first one also draws it and
  // the last one finishes it. False if there was nothing to do: the kernels are not ready, or all samples are in.
  bool step();

  // Each begins anew. move(): coarse, so that there is a picture about every 100 ms, until rest(), which goes on in
  // full. A picture that a move has begun is completed first, even if others follow at once; view() tells whose it is.
  void move(const View& view);
  void rest();
  void set_view(const View& view); // in full at once
  // Anything but the scene, the size and the AOVs included; `view` is resolved for the new size. Keeps what it can of
  // what is on the device; the scene always. settings.direct may be any, whatever the scene was packed for but
  // kDirectBsdf.
  void set_settings(const RenderPlan& settings, const View& view);
  // Another scene, or the same one packed anew; uploads it.
  void set_scene(const PackedScene& scene, const View& view);

  const RenderPlan& settings() const { return settings_; }
  const View& view() const { return view_; }
  bool moving() const { return moving_; }
  ProgressiveStatus status() const;
  std::uint32_t spp() const { return loop_->spp(); } // these three as the status tells them
  std::uint32_t coarse() const { return coarse_; }
  // Not while the picture is temporary, even where that one has all its samples.
  bool is_done() const { return loop_->is_done() && !moving_ && !is_for_motion(); }
  // Rendering seconds until the estimated error is `target`; infinite while that cannot be told.
  double seconds_to(double target) const;

  // The exact sums so far and the picture that they make, as render() develops it: of `coarse` size while it moves.
  Film film() { return loop_->film(); }
  Picture picture();

  const FilmTarget& film_target() const { return loop_->workspace().film; } // for Display
  const DeviceScene& device_scene() const { return *loop_->workspace().on_device; }
  const PackedScene& scene() const { return *scene_; }
  const Nonfinite& nonfinite() const { return loop_->totals().nonfinite; }

private:
  void begin_anew(std::uint32_t coarse);
  void end_pass();
  // Whether the picture is temporary: coarse, or joined to frames of other views.
  bool is_for_motion() const { return coarse_ > 1 || rendered_.antialias_over_time; }
  std::uint32_t choose_coarse() const;
  void make_loop(std::shared_ptr<const DeviceScene> uploaded);

  Device& device_;
  const PackedScene* scene_;
  KernelCompiler& kernels_;
  RenderPlan settings_; // as asked for
  RenderPlan rendered_; // and as they are rendered: smaller while the camera moves
  View view_;
  std::optional<View> next_view_; // moved to while a picture was not complete
  std::unique_ptr<RenderLoop> loop_;
  std::uint32_t motion_frames_ = 0; // frames while the camera moved
  bool moving_ = false, compiling_ = false;
  std::uint32_t coarse_ = 1;
};

} // namespace wavepath
