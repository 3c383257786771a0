// A render that a window drives step by step: one wave at a time, coarse while the camera moves, started over after any
// change.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "host/film/film.h"
#include "host/render/loop/render_loop.h"

namespace wavepath {

// Status of the render, for the window.
struct ProgressiveStatus {
  bool compiling = false;     // kernels are being compiled; until they are ready nothing new is rendered
  bool done = false;          // the picture at rest has all its samples
  std::uint32_t coarse = 1;   // a rendered pixel is this many pixels wide and high on screen
  std::uint32_t spp = 0;      // samples a pixel so far, at the size of `coarse`
  std::uint32_t planned = 0;  // samples a pixel planned
  double fraction = 0.0;      // fraction of the planned samples that are done
  double seconds = 0.0;       // device time since it was started over
  double frame_seconds = 0.0; // device time of one sample of every pixel, at the size of `coarse`
  double mrays_per_second = 0.0;
  ErrorEstimate error;         // zero until known
  std::uint32_t error_spp = 0; // samples a pixel at the time of the estimate
  double slope = -0.5;         // d log(error) / d log(time)
  MemoryUse memory;
  glm::vec3 ambient{0.0f};             // ambient radiance of hybrid frames
  std::optional<ShadowReport> shadows; // empty without a shadow technique
};

class Progressive {
public:
  // Uploads the scene unless `uploaded` holds it. `scene` and `kernels` must outlive this object. The picture has
  // settings.width times settings.height pixels, for which `view` must be resolved, and ends at settings.last_sample.
  // Settings of time, error and adaptive sampling are ignored. Throws Error if the device cannot hold the scene.
  Progressive(Device& device, const PackedScene& scene, const View& view, const RenderPlan& settings,
              KernelCompiler& kernels, std::shared_ptr<const DeviceScene> uploaded = nullptr);
  // Another render of the same scene and view, which uses the same copy of the scene on the device.
  std::unique_ptr<Progressive> beside(const RenderPlan& settings) const;

  // Submits one wave of about 15 ms and waits for an older one. The first wave of a hybrid frame also draws it, and the
  // last one finishes it. Returns false if there was nothing to do: kernels are not ready, or all samples are done.
  bool step();

  // The next six start over. move(): coarse, so that there is a picture about every 100 ms, until rest(), which
  // continues in full. A picture begun by a move is completed first, even if further moves follow at once; view() tells
  // whose it is.
  void move(const View& view);
  void rest();
  void set_view(const View& view); // in full at once
  // Changes any setting, size and AOVs included. `view` must be resolved for the new size. Keeps data on the device
  // where possible, and always the scene. settings.direct may have any value if the scene was not packed for
  // kDirectBsdf.
  void set_settings(const RenderPlan& settings, const View& view);
  // Changes to another scene, or to the same scene packed anew, and uploads it.
  void set_scene(const PackedScene& scene, const View& view) { set_scene(scene, view, settings_, nullptr); }
  // The same with other settings; `uploaded` holds the scene unless it is null.
  void set_scene(const PackedScene& scene, const View& view, const RenderPlan& settings,
                 std::shared_ptr<const DeviceScene> uploaded);
  // Lets go of the scene and of all that it has on the device; until the next set_scene() it can do nothing else.
  void release() { loop_.reset(); }

  // How long a picture may take while the camera moves. A move is shown by the picture after the one that is on its
  // way.
  void set_coarse_seconds(double seconds) { coarse_seconds_ = seconds; }

  const RenderPlan& settings() const { return settings_; }
  const View& view() const { return view_; }
  bool moving() const { return moving_; }
  ProgressiveStatus status() const;
  std::uint32_t spp() const { return loop_->spp(); } // as in the status, and the next two
  std::uint32_t coarse() const { return coarse_; }
  // True if all samples are done. False while the picture is a temporary one, even if that has all its samples.
  bool is_done() const { return loop_->is_done() && !moving_ && !is_for_motion(); }
  // Predicted rendering seconds until the estimated error is `target`; infinite if there is no prediction.
  double seconds_to(double target) const;

  // The exact sums so far, and the picture developed from them as render() does; of the coarse size while the camera
  // moves.
  Film film() { return loop_->film(); }
  Picture picture();

  const FilmTarget& film_target() const { return loop_->workspace().film; } // for Display
  const DeviceScene& device_scene() const { return *loop_->workspace().on_device; }
  const PackedScene& scene() const { return *scene_; }
  const Nonfinite& nonfinite() const { return loop_->totals().nonfinite; }

private:
  void begin_anew(std::uint32_t coarse);
  void end_pass();
  // True if the picture is temporary: coarse, or blended with frames of other views.
  bool is_for_motion() const { return coarse_ > 1 || rendered_.antialias_over_time; }
  std::uint32_t choose_coarse() const;
  void make_loop(std::shared_ptr<const DeviceScene> uploaded);

  Device& device_;
  const PackedScene* scene_;
  KernelCompiler& kernels_;
  RenderPlan settings_; // settings as requested
  RenderPlan rendered_; // settings of the current render: smaller while the camera moves
  View view_;
  std::optional<View> next_view_; // moved to while a picture was not complete
  std::unique_ptr<RenderLoop> loop_;
  std::uint32_t motion_frames_ = 0; // frames while the camera moved
  bool moving_ = false, compiling_ = false;
  std::uint32_t coarse_ = 1;
  double coarse_seconds_ = 0.1;
};

} // namespace wavepath
