// Draws the positions in the pixel filter through which later frames are seen, as camera rays draw theirs.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_HYBRID
#define BIND_JITTERS
#include "kernels/hybrid/bindings.glsl"
#include "kernels/base/config.glsl"
#include "kernels/base/dimensions.glsl"
#include "kernels/base/filter.glsl"
#include "kernels/hybrid/frame_terms.glsl"
#include "kernels/base/sampler.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= kJitters) return;
  // kNone is no pixel's index: the frame as a whole draws from a sequence of its own.
  Sampler frames = make_sampler(frame.seed, kNone, wave.first_sample + i, frame_total());
  jitters[i] = sample_filter(sample_2d(frames, kDimensionFilter));
}
