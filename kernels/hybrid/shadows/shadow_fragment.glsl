// Contents of a texel of a shadow map, for fragment shaders that declare the varyings of shadow_map.vert. Include
// bindings.glsl with BIND_GEOMETRY and BIND_SURFACES first.
#ifndef WAVEPATH_SHADOW_FRAGMENT_GLSL
#define WAVEPATH_SHADOW_FRAGMENT_GLSL

#include "kernels/bvh/known_triangle.glsl"
#include "kernels/base/sampler.glsl"
#include "kernels/hybrid/shadows/view.glsl"
#include "kernels/surface/surface.glsl"

layout(location = 0) flat in uint triangle;
layout(location = 1) flat in uint instance;
layout(location = 2) in vec3 position;

// Random numbers of a texel: BLEND is there by chance (Enderton et al. 2010, section 3.3), which filters average.
Sampler texel_sampler(uint view, uvec2 texel) {
  return make_sampler(frame.seed, (view * shadow.size + texel.y) * shadow.size + texel.x, 0u, 1u);
}

// True for points of the other half of all directions, which a paraboloid shows beyond the texels at its rim.
bool is_behind(ShadowView v) {
  return v.kind == kViewParaboloid && dot(v.depth, vec4(position, 1.0)) < -v.texel * distance(position, v.light);
}

// MASK and BLEND, decided where the texel's centre shows the surface; unlit surfaces cast no shadow.
bool is_passed_through(ShadowView v) {
  if (!has(kFeatureAlpha)) return false;
  uint flags = floatBitsToUint(texelFetch(triangles, int(triangle * kTriangleTexels)).w);
  if ((flags & kTriangleAlpha) == 0u) return false;
  vec3 direction = v.kind == kViewParallel ? -v.light : position - v.light;
  vec3 origin = v.kind == kViewParallel ? position - v.far * direction : v.light;
  Hit hit = hit_of_triangle(triangle, instance, origin, direction);
  return is_hole(hit, texel_sampler(wave.first_pixel, uvec2(gl_FragCoord.xy)), kHashConnect);
}

#endif
