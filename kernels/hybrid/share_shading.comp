// Gives a pixel the light that a frame before found for the triangle that this one sees, or keeps what this one found.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_HYBRID
#define BIND_VISIBILITY
#define BIND_SIGNALS
#define BIND_SEEN
#define BIND_POSITIONS
#include "kernels/hybrid/bindings.glsl"
#include "kernels/path/bindings.glsl"
#include "kernels/hybrid/covered_positions.glsl"
#include "kernels/hybrid/frame_terms.glsl"

layout(local_size_x = kWorkgroupSize) in;

// Push constant: first_pixel = the first one, row by row from the top left, pixel_count = how many.
void main() {
  if (gl_GlobalInvocationID.x >= wave.pixel_count) return;
  uint pixel_index = wave.first_pixel + gl_GlobalInvocationID.x;
  uint other = position_index(shading_position(pixel_index), pixel_index),
       own = position_index(hybrid.sample_position, pixel_index);
  position_ids[own] = texelFetch(visibility, int(pixel_index)).xy;
  if (other != own) {
    signals[pixel_index] = position_signals[other];
    if (wants_lights()) seen[pixel_index] = position_seen[other];
    return;
  }
  position_signals[own] = signals[pixel_index];
  if (wants_lights()) position_seen[own] = seen[pixel_index]; // otherwise nothing has a place in `seen`
}
