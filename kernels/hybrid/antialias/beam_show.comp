// A frame sees one of the pictures of beams. Push constant: first_pixel = the first pixel, pixel_count = how many,
// first_sample = the picture.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/bindings.glsl"
#include "kernels/base/config.glsl"
#include "kernels/hybrid/antialias/beam_types.h"

layout(set = 0, binding = kBindBeamIds, std430) readonly buffer BeamIdBlock { uvec2 beam_ids[]; };
layout(set = 0, binding = kBindVisibility, std430) writeonly buffer VisibilityBlock { uvec2 seen[]; };

layout(local_size_x = kWorkgroupSize) in;

void main() {
  if (gl_GlobalInvocationID.x >= wave.pixel_count) return;
  uint pixel_index = wave.first_pixel + gl_GlobalInvocationID.x;
  seen[pixel_index] = beam_ids[wave.first_sample * frame.width * frame.height + pixel_index];
}
