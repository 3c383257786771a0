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
// first_sample is the picture.
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

  void find(Commands& commands, std::size_t band, const gpu::Wave& wave, std::uint32_t depth) override;
  std::uint32_t mirrors() const override { return gpu::kMirrorsIdeal; }
  bool sees_nested(const RenderPlan&) override;
  void add_bindings(std::vector<Binding>& bindings) override;

  // What a mirror shows: of the frame, or of what another mirror shows of the frame.
  struct Picture {
    // `own`: bindings of its shaders, but for kBindFrame.
    Picture(Device& device, std::vector<Binding> own, std::uint32_t mirror, std::uint32_t first);
    bool is_nested() const { return first != gpu::kNone; }

    std::uint32_t mirror; // that shows it, among all planes
    std::uint32_t first;  // mirror that shows this one; kNone: the frame does
    Buffer frame;         // gpu::Frame of its shaders
    BindingSet bindings;
  };

  // Those of all mirrors, in their order, then those of mirrors in mirrors.
  std::uint32_t picture_count() const { return static_cast<std::uint32_t>(pictures_.size()); }
  std::uint32_t mirror_count() const { return static_cast<std::uint32_t>(planes_.size()); }
  const Picture& picture(std::uint32_t index) const { return *pictures_[index]; }
  // True for the first and the last one of mirrors, and of mirrors in mirrors.
  bool is_first_of_kind(std::uint32_t index) const { return index == 0 || index == mirror_count(); }
  bool is_last_of_kind(std::uint32_t index) const {
    return index + 1 == mirror_count() || index + 1 == picture_count();
  }
  // The frame's constants with the camera of those who see the picture's mirror.
  gpu::Frame seen_by(const Picture& picture) const;
  // Submits what a mirror shows; `clear`: attachments to clear first; `before` and `after` are recorded around it.
  void draw(WaveQueue& queue, std::uint32_t index, const RasterPipeline& pipeline, std::uint32_t clear,
            const std::function<void(Commands&)>& before, const std::function<void(Commands&)>& after);

  std::unique_ptr<RasterTarget> target_; // of all pictures in turn; null if there are none
  Buffer ids_;                           // kBindMirrorIds

private:
  struct MadeFor {
    std::uint32_t width = 0, height = 0;
    double threshold = 0.0;
    KernelConfig config;
    bool operator==(const MadeFor&) const = default;
  };
  struct Pair { // of mirrors
    std::uint32_t first, second;
  };
  void turn_to_eye();
  void find_pairs();
  void make_pictures(const std::vector<Binding>& shared);

  std::vector<Chunk> chunks_;
  SliceLength triangles_a_slice_;
  MadeFor made_for_;
  std::vector<MirrorPlane> planes_;
  std::vector<Pair> pairs_; // mirrors and others that they may show in this view
  std::vector<std::unique_ptr<Picture>> pictures_;
  Buffer unused_;
};

} // namespace wavepath
