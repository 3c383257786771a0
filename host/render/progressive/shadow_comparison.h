// Comparison of the shadows of a window's render with the same view under another technique, and with the same light
// without shadows.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "host/picture/metrics/shadow_score.h"
#include "host/picture/picture.h"
#include "host/render/progressive/progressive.h"

namespace wavepath {

// Scores of the current pictures. Fractions are free of noise if all three renders have the same samples.
struct ShadowVerdict {
  std::optional<ShadowScore> score; // empty where the scene has no light that a map covers
  Picture map;                      // falsely lit in orange, falsely dark in blue (false_shadow_map())
};

class ShadowComparison {
public:
  // Renders beside `shown`, of the same scene, which is on the device once: a further one with the shadow technique
  // `against` (RenderPlan::shadows), and one of unshadowed light. `shown` renders the AOV direct and outlives this.
  // Throws Error if the technique does not suit the scene, or the device cannot hold it.
  ShadowComparison(Progressive& shown, std::uint32_t against);

  // Steps the render that has the fewest samples of the three, so that they stay together. Returns false if none could
  // step.
  bool step();
  bool is_done() const;          // all but `shown`
  std::uint64_t samples() const; // a pixel, of all but `shown`
  // The same as in Progressive, for the renders beside `shown`.
  void move(const View& view);
  void rest();
  // Takes up the settings of `shown`. A render that they do not change goes on.
  void follow(const View& view);

  Progressive& truth() { return *truth_; }
  std::uint32_t against() const { return against_; }
  // Samples a pixel that all have, at full size; 0 while one of them is coarse.
  std::uint32_t common_spp() const;
  ShadowVerdict judge();

private:
  RenderPlan truth_settings() const;
  RenderPlan light_settings() const;

  Progressive& shown_;
  std::uint32_t against_;
  std::unique_ptr<Progressive> truth_, light_; // no light where no map covers any
};

// The column from which on a picture split at a fraction of its width shows the other render.
std::uint32_t split_column(double at, std::uint32_t width);
// `left` up to that column and `right` from there on, in the channels that both have. Both have one size.
Picture split_picture(Picture left, const Picture& right, double at);

} // namespace wavepath
