// Reflections of plane mirrors by pictures that mirrored cameras draw; only the triangle of each pixel is drawn, what
// it shows is computed and shaded as for a ray.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "host/gpu/raster.h"
#include "host/integrators/hybrid/raster/culling.h"
#include "host/integrators/hybrid/raster/slices.h"
#include "host/integrators/hybrid/reflections/mirror_planes.h"
#include "host/integrators/hybrid/reflections/rays.h"

namespace wavepath {

// Numbers and kinds of the bindings of its kernels, without buffers.
std::vector<Binding> pictured_layout();

// Behind the stages of RayStage in the program of such a technique: the one that finds hits in ids().
inline constexpr std::size_t kPictured = kRayStageCount;

// Shaders that draw triangles as a mirrored camera sees them, in front of its mirror. Push constant: gpu::Wave, whose
// first_sample is the mirror.
extern const RasterCode kMirroredCode;

class PicturedReflections : public RayReflections {
public:
  explicit PicturedReflections(const ReflectionContext& context);

  void change(const View& view, const RenderPlan& settings, const KernelConfig& config,
              const std::vector<Binding>& shared) override;
  std::uint64_t bytes() const override;
  ReflectionReport report() const override { return Reflections::report(); }

protected:
  using Constants = std::array<std::uint32_t, gpu::kSpecCount>;

  // Makes target_ and pipelines; there is at least one mirror.
  virtual void make_target(std::uint32_t width, std::uint32_t height, const Constants& constants) = 0;

  void find(Commands& commands, std::size_t band, const gpu::Wave& wave) override;
  std::uint32_t mirrors() const override { return gpu::kMirrorsIdeal; }
  void add_bindings(std::vector<Binding>& bindings) override;

  std::uint32_t mirror_count() const { return static_cast<std::uint32_t>(planes_.size()); }
  const BindingSet& drawn_with(std::uint32_t mirror) const { return pictures_[mirror]->bindings; }
  const Buffer& frame_of(std::uint32_t mirror) const { return pictures_[mirror]->frame; } // gpu::Frame of its shaders
  // Submits what a mirror shows; `clear`: attachments to clear first; `before` and `after` are recorded around it.
  void draw(WaveQueue& queue, std::uint32_t mirror, const RasterPipeline& pipeline, std::uint32_t clear,
            const std::function<void(Commands&)>& before, const std::function<void(Commands&)>& after);

  std::unique_ptr<RasterTarget> target_; // of all mirrors in turn; null if there are none
  Buffer ids_;                           // kBindMirrorIds

private:
  struct MadeFor {
    std::uint32_t width = 0, height = 0;
    double threshold = 0.0;
    KernelConfig config;
    bool operator==(const MadeFor&) const = default;
  };
  struct Picture { // `own`: bindings of its shaders, but for kBindFrame
    Picture(Device& device, std::vector<Binding> own);
    Buffer frame; // the frame's constants, with the mirrored camera
    BindingSet bindings;
  };
  void turn_to_eye();

  std::vector<Chunk> chunks_;
  SliceLength triangles_a_slice_;
  MadeFor made_for_;
  std::vector<MirrorPlane> planes_;
  std::vector<std::unique_ptr<Picture>> pictures_; // of each plane
  Buffer unused_;
};

} // namespace wavepath
