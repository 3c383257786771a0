// A shadow map by tracing one ray through the centre of every texel: what rasterization is held against.
// Push constant: first_pixel = first texel within the view, pixel_count = how many, sample_count = the view,
// first_sample = 1 where ids are wanted.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_SHADOW_MAP_WORDS
#include "kernels/hybrid/shadows/bindings.glsl"
#include "kernels/hybrid/shadows/trace_texel.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  uint texel = wave.first_pixel + gl_GlobalInvocationID.x;
  if (gl_GlobalInvocationID.x >= wave.pixel_count) return;
  uint first = fetch_shadow_view(wave.sample_count).first_texel;
  trace_texel(wave.sample_count, uvec2(texel % shadow.size, texel / shadow.size), first + texel,
              wave.first_sample != 0u);
}
