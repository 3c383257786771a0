// Fills texels of shadow maps by tracing one ray through the centre of each. Include bindings.glsl with BIND_GEOMETRY,
// BIND_SURFACES and BIND_SHADOW_MAP_WORDS first.
#ifndef WAVEPATH_TRACE_TEXEL_GLSL
#define WAVEPATH_TRACE_TEXEL_GLSL

#include "kernels/hybrid/shadows/view.glsl"
#include "kernels/surface/surface.glsl"

Sampler path_sampler;
#define ALPHA_TEST(hit) is_hole(hit, path_sampler, kHashConnect)
#include "kernels/bvh/trace.glsl"

// `word`: where it is kept.
void trace_texel(uint view, uvec2 texel, uint word, bool ids) {
  ShadowView v = fetch_shadow_view(view);
  vec3 origin, direction;
  ray_of_texel(v, vec2(texel) + 0.5, origin, direction);
  if (has(kFeatureAlpha))
    path_sampler = make_sampler(frame.seed, (view * shadow.size + texel.y) * shadow.size + texel.x, 0u, 1u);
  Hit hit = trace(origin, direction, kFar);
  bool found = hit.triangle != kNone;
  depth_words[word] = found ? view_depth(v, fetch_surface(hit).position) : kFar;
  if (ids) id_words[word] = uvec2(found ? hit.triangle : kNone, found ? hit.instance : kNone);
}

#endif
