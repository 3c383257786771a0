// The light that the rays of a reflection map brought becomes its texels.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_PATHS
#include "kernels/path/bindings.glsl"
#include "kernels/hybrid/reflections/bindings.glsl"
#include "kernels/base/math.glsl"
#include "kernels/hybrid/reflections/map.glsl"
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
  reflection_map[wave.first_pixel + local] = vec4(sum / float(max(count, 1u)), 0.0);
}
