// Training of the guiding field, in iterations of which each is guided by the one before.
//
// The training pass is a pilot: a small picture of the same view, whose samples are discarded. Records are read in the
// order of its paths, whatever the waves. So the field depends only on the scene, the view, the picture size, the seed
// and the number of iterations, and the parts of a render and resumed renders train the same field.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host/gpu/buffer.h"
#include "host/integrators/path/guide_field.h"
#include "host/render/loop/integrator.h"
#include "host/render/loop/render_result.h"

namespace wavepath {

inline constexpr std::uint32_t kGuideTrainingPixels = 1u << 15; // at most
inline constexpr std::uint64_t kGuideRecordBytes =
    std::uint64_t{kGuideTrainingPixels} * gpu::kGuideBounces * sizeof(gpu::GuideRecord);

inline constexpr std::uint64_t kGuideBytes = kGuideMapBytes + kGuideTreeBytes + kGuideRecordBytes; // at most

class GuideTraining {
public:
  // `width`, `height`: size of the training picture in pixels.
  GuideTraining(std::uint32_t width, std::uint32_t height, std::uint32_t most_iterations);

  Pilot next() const; // requests one sample of every pixel of the pilot
  // Takes in the records of that sample. Returns true if an iteration is complete, so that field() is new.
  bool take(const Buffer& records);
  bool is_done() const { return done_; }
  GuideReport report() const;
  const GuideField& field() const { return field_; }

private:
  std::uint32_t pixels() const { return width_ * height_; }
  std::uint32_t iteration_end(std::uint32_t iteration) const;
  double guidable_fraction() const;
  std::span<const GuideVertex> training_vertices() const;
  void forget_vertices();

  std::uint32_t width_, height_, most_iterations_;
  std::uint32_t sample_ = 0, iteration_ = 0;
  bool done_ = false;
  std::vector<GuideVertex> vertices_;               // of this iteration, preceded by those of some earlier ones
  std::vector<std::size_t> iteration_begins_ = {0}; // their offsets in `vertices_`; last: this iteration's
  struct Sample {
    float all, scattered; // luminance of the sample; the part from the first direction that could be guided
  };
  std::vector<Sample> samples_; // of this iteration, picture after picture
  std::vector<float> sums_;     // sums over all iterations, for each pixel
  double promise_ = 1.0;        // predicted variance of a sample, guided over unguided
  GuideField field_ = no_field();
};

} // namespace wavepath
