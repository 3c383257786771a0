// Sums up a line of a map. Push constant: first_pixel = first line, pixel_count = how many, sample_count = the view.
#ifndef WAVEPATH_SHADOW_SAT_LINES_GLSL
#define WAVEPATH_SHADOW_SAT_LINES_GLSL

#define BIND_SHADOW_DEPTHS
#define BIND_SHADOW_SCRATCH
#include "kernels/hybrid/shadows/bindings.glsl"
#include "kernels/hybrid/shadows/view.glsl"
#include "kernels/hybrid/shadows/sat_depth.glsl"

layout(local_size_x = kWorkgroupSize) in;

bool find_line(out ShadowView v, out uint line) {
  line = wave.first_pixel + gl_GlobalInvocationID.x;
  v = fetch_shadow_view(wave.sample_count);
  return gl_GlobalInvocationID.x < wave.pixel_count;
}

#endif
