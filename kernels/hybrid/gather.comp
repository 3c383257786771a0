// Reduces the light samples of a frame to one value a pixel: their mean, relative to the surface's colour, as filters
// need it.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_PATHS
#define BIND_HYBRID
#define BIND_GBUFFER
#define BIND_SIGNALS
#include "kernels/hybrid/bindings.glsl"
#include "kernels/path/bindings.glsl"
#include "kernels/hybrid/frame_terms.glsl"
#include "kernels/base/math.glsl"
#include "kernels/path/records.glsl"
#include "kernels/base/pixel.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  uint local = gl_GlobalInvocationID.x;
  if (local >= wave.pixel_count) return;
  vec3 sum = vec3(0.0);
  uint count = 0u;
  for (uint s = 0u; s < wave.sample_count; ++s) {
    vec3 radiance = fetch_path(s * wave.pixel_count + local).radiance;
    if (!is_finite(radiance)) continue; // the kernel that made it so has counted it
    sum += radiance;
    ++count;
  }
  uvec2 pixel = slot_pixel(local);
  uint pixel_index = pixel.y * frame.width + pixel.x;
  // A place that nothing is known of is NaN, which the film leaves out.
  vec3 mean = count > 0u ? sum / float(count) : uintBitsToFloat(uvec3(0x7fc00000u));
  signals[pixel_index].xyz = mean / demodulation(gbuffer[pixel_index].albedo);
}
