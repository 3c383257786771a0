// Weights of the ways to complete a path, by the power heuristic over all of them (Veach 1997), without looking back
// along the path: each end carries two sums of squared ratios of densities (Georgiev 2012, "Implementing vertex
// connection and merging"). Include bidirectional/bindings.glsl first.
//
// Densities enter without Russian roulette, without holes of alpha, and without the chance to pass single-sided
// surfaces, so that they are functions of the path alone, whichever end it was traced from: all that weights need to
// add up to 1.
#ifndef WAVEPATH_BIDIRECTIONAL_WEIGHTS_GLSL
#define WAVEPATH_BIDIRECTIONAL_WEIGHTS_GLSL

#include "kernels/bidirectional/bidirectional_types.h"
#include "kernels/base/camera.glsl"

bool uses_technique(uint technique) { return (bidirectional.techniques & technique) != 0u; }

float square(float x) { return x * x; }

// Squares reach beyond the float range near lamps and at grazing angles. A weight that met the bound is zero to all
// precision.
PathWeights bounded(PathWeights w) { return PathWeights(min(1e30, w.connect), min(1e30, w.others)); }

// Arrival at a surface. `distance_squared`: 1 where the path before was a direction from infinity.
PathWeights arrived(PathWeights w, float distance_squared, float cosine) {
  return bounded(PathWeights(w.connect * square(distance_squared / cosine), w.others / square(cosine)));
}

// Departure with density `forward`, where the other end would have scattered back with density `reverse`; `cosine` to
// the surface. `connects`: whether the latest vertex can be connected to the one before it.
PathWeights scattered(PathWeights w, float cosine, float forward, float reverse, bool connects) {
  float back = w.others * square(reverse) + (connects ? w.connect : 0.0);
  return bounded(PathWeights(1.0 / square(forward), square(cosine / forward) * back));
}

// Through a delta lobe; `ratio`: of the densities, back over forth.
PathWeights scattered_delta(PathWeights w, float cosine, float ratio) {
  return bounded(PathWeights(0.0, w.others * square(cosine * ratio)));
}

// Sum over the techniques that meet nearer to this end than the edge that leaves it, relative to meeting at that edge.
// `density`: per area, with which the other end would find the latest vertex. `reverse`: as above.
float nearer(PathWeights w, float density, float reverse, bool connects) {
  return square(density) * ((connects ? w.connect : 0.0) + w.others * square(reverse));
}

// Density per area at a surface that a camera path finds it with, at `offset` from the camera, for one path a pixel.
// With a lens, from its point that the path begins at: that has the same density whichever end found the path, and
// cancels.
float camera_pdf_area(vec3 offset, float cosine) {
  if (uses_camera_model()) {
    offset = unclipped(offset);
    if (MOVES_FAST) { // the camera sees it elsewhere, in a solid angle of 1/D^2
      vec3 towards = normalize(offset);
      float doppler = doppler_factor(towards);
      cosine /= doppler * doppler;
      offset = length(offset) * seen_direction(towards);
    }
    if (is_panorama())
      return cosine / (dot(offset, offset) * panorama_stretch(offset) * bidirectional.pixel_area);
  }
  if (is_orthographic() && kLens == kLensPinhole) return cosine / bidirectional.pixel_area;
  float depth = dot(offset, frame.camera_forward); // the density per solid angle is distance^3 / (depth^3 pixel_area)
  // An orthographic camera sees the surface by a slanted beam.
  if (is_orthographic()) return cosine * sqrt(dot(offset, offset)) / (depth * bidirectional.pixel_area);
  return cosine * sqrt(dot(offset, offset)) / (depth * depth * depth * bidirectional.pixel_area);
}

#endif
