// Score of the shadows of a picture against those of another: the kind of error, not only its size.
#pragma once

#include <optional>

#include "host/picture/picture.h"

namespace wavepath {

struct ShadowScore {
  // Error of direct light: the root mean square, over the same pixels, of (s - t) l / sqrt((t l)^2 + (0.1 max(l,
  // m))^2). s and t are the fractions of light that arrive; l is the true light without shadows, summed over R, G and
  // B; m is its median over lit pixels. It equals the square root of relMSE (metrics.h) where the light is 1
  // everywhere. But brighter lamps do not change it, and a pixel next to a lamp weighs no more than any other.
  double relative_rms = 0.0;
  // Fractions of the pixels within reach of a light whose light is too large, or too small, by more than a quarter of
  // the unshadowed light.
  double falsely_lit = 0.0, falsely_dark = 0.0;
  // Mean distance, in pixels, from the picture's shadow edges to the nearest true edge. An edge is where half of the
  // light arrives. Empty if one of the two has no edge.
  std::optional<double> edge_displacement;
  // Area that is partly lit (0.1 to 0.9), relative to that of the truth. Empty if the truth has none.
  std::optional<double> penumbra_ratio;
};

// Light with shadows, and the same light without. Both must have the same samples of the same lights, so that their
// ratio does not depend on the random positions.
struct ShadowedPicture {
  const Picture &shadowed, &unshadowed; // channels direct.R, .G, .B
};

// Compares shadows; empty if a picture lacks the channels.
std::optional<ShadowScore> score_shadows(const ShadowedPicture& picture, const ShadowedPicture& truth);

// Picture that shows falsely lit pixels in orange and falsely dark ones in blue, by strength, over the true fraction of
// light in grey. Empty if a picture lacks the channels.
Picture false_shadow_map(const ShadowedPicture& picture, const ShadowedPicture& truth);

} // namespace wavepath
