// How wrong the shadows of a picture are, beside those of another: what kind of error, not only how much.
#pragma once

#include <optional>

#include "host/picture/picture.h"

namespace wavepath {

struct ShadowScore {
  // Error of direct light, over the same pixels: the root mean square of (s - t) l / sqrt((t l)^2 + (0.1 max(l, m))^2),
  // where s and t are the fractions of light that arrive, l is the true light without shadows, summed over R, G and B,
  // and m its median where there is any. The root of relMSE (see metrics.h) where light is even and 1; but brighter
  // lamps change nothing, and a pixel next to a lamp weighs no more than any other.
  double relative_rms = 0.0;
  // Fractions of the pixels that lights reach or could reach whose light is off by more than a quarter of what it would
  // be without shadows.
  double falsely_lit = 0.0, falsely_dark = 0.0;
  // Pixels, on average over the picture's edges of shadows: to the nearest edge of the truth, edges being where half of
  // the light arrives. Empty where one of the two has no edge.
  std::optional<double> edge_displacement;
  // Area that is partly lit (a tenth to nine tenths) over that of the truth. Empty where the truth has none.
  std::optional<double> penumbra_ratio;
};

// Light with shadows, and the same light without them: the same samples of the same lights, so that what is left of the
// light does not depend on where these happened to be.
struct ShadowedPicture {
  const Picture &shadowed, &unshadowed; // channels direct.R, .G, .B
};

// Empty where a picture lacks the channels.
std::optional<ShadowScore> score_shadows(const ShadowedPicture& picture, const ShadowedPicture& truth);

// Map of falsely lit pixels in orange and falsely dark ones in blue, the stronger the more, over the true fractions of
// light in grey. Empty if a picture lacks the channels.
Picture false_shadow_map(const ShadowedPicture& picture, const ShadowedPicture& truth);

} // namespace wavepath
