// The light that the mirrored rays of a wave brought becomes what its pixels reflect, and what the frame has seen is
// put back.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_PATHS
#define BIND_HYBRID
#define BIND_SEEN
#define BIND_REFLECTIONS
#include "kernels/hybrid/bindings.glsl"
#include "kernels/path/bindings.glsl"
#include "kernels/base/math.glsl"
#include "kernels/base/pixel.glsl"
#include "kernels/path/records.glsl"

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
  seen[pixel_index] = reflections[pixel_index];
  reflections[pixel_index] = vec4(count > 0u ? sum / float(count) : uintBitsToFloat(uvec3(0x7fc00000u)), 0.0);
}
