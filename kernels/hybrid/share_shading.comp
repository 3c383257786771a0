// Gives a pixel the light that a frame before found for the triangle that this one sees, or keeps what this one found.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_HYBRID
#define BIND_VISIBILITY
#define BIND_SIGNALS
#define BIND_SEEN
#define BIND_PLACES
#include "kernels/hybrid/bindings.glsl"
#include "kernels/path/bindings.glsl"
#include "kernels/hybrid/covered_places.glsl"
#include "kernels/hybrid/frame_terms.glsl"

layout(local_size_x = kWorkgroupSize) in;

// Push constant: first_pixel = the first one, row by row from the top left, pixel_count = how many.
void main() {
  if (gl_GlobalInvocationID.x >= wave.pixel_count) return;
  uint place = wave.first_pixel + gl_GlobalInvocationID.x;
  uint entry = place_entry(shading_place(place), place), own = place_entry(hybrid.sample_place, place);
  place_ids[own] = texelFetch(visibility, int(place)).xy;
  if (entry != own) {
    signals[place] = place_signals[entry];
    if (wants_lights()) seen[place] = place_seen[entry];
    return;
  }
  place_signals[own] = signals[place];
  if (wants_lights()) place_seen[own] = seen[place]; // otherwise nothing has a place in `seen`
}
