// A shadow map by tracing one ray through the centre of every texel: what rasterization is held against.
// Push constant: first_pixel = first texel within the view, pixel_count = how many, sample_count = the view, first_sample = 1 where
// ids are wanted.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_SHADOW_MAP_WORDS
#include "kernels/shadows/bindings.glsl"
#include "kernels/shadows/view.glsl"
#include "kernels/surface.glsl"

Sampler path_sampler;
#define ALPHA_TEST(hit) is_hole(hit, path_sampler, kHashConnect)
#include "kernels/bvh.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  uint texel = wave.first_pixel + gl_GlobalInvocationID.x;
  if (gl_GlobalInvocationID.x >= wave.pixel_count) return;
  ShadowView v = fetch_shadow_view(wave.sample_count);
  vec3 origin, direction;
  ray_of_place(v, vec2(texel % shadow.size, texel / shadow.size) + 0.5, origin, direction);
  if (has(kFeatureAlpha)) path_sampler = make_sampler(frame.seed, wave.sample_count * shadow.size * shadow.size + texel, 0u, 1u);
  Hit hit = trace(origin, direction, kFar);
  bool found = hit.triangle != kNone;
  depth_words[v.first_texel + texel] = found ? view_depth(v, fetch_surface(hit).position) : kFar;
  if (wave.first_sample != 0u) id_words[v.first_texel + texel] = uvec2(found ? hit.triangle : kNone, found ? hit.instance : kNone);
}
