// Where points are in a light's view, and which points a position in the view shows. Include bindings.glsl first.
#ifndef WAVEPATH_SHADOW_VIEW_GLSL
#define WAVEPATH_SHADOW_VIEW_GLSL

#include "kernels/base/math.glsl"

ShadowView fetch_shadow_view(uint index) {
  int texel = int(index * kShadowViewTexels);
  ShadowView v;
  v.x = texelFetch(shadow_views, texel);
  v.y = texelFetch(shadow_views, texel + 1);
  v.z = texelFetch(shadow_views, texel + 2);
  v.w = texelFetch(shadow_views, texel + 3);
  v.depth = texelFetch(shadow_views, texel + 4);
  vec4 light_kind = texelFetch(shadow_views, texel + 5), scales = texelFetch(shadow_views, texel + 6);
  v.light = light_kind.xyz;
  v.kind = floatBitsToUint(light_kind.w);
  v.texel = scales.x;
  v.near = scales.y;
  v.far = scales.z;
  v.radius = scales.w;
  vec4 words = texelFetch(shadow_views, texel + 7);
  v.first_texel = floatBitsToUint(words.x);
  v.is_part = floatBitsToUint(words.y);
  return v;
}

// Homogeneous, as gl_Position has it.
vec4 view_position(ShadowView v, vec3 p) {
  vec4 q = vec4(p, 1.0);
  vec4 position = vec4(dot(v.x, q), dot(v.y, q), dot(v.z, q), dot(v.w, q));
  if (v.kind != kViewParaboloid) return position;
  // The paraboloid that reflects every direction of a half-space along its axis (Brabec, Annen and Seidel 2002).
  vec3 direction = vec3(position.xy, dot(v.depth, q));
  float distance_ = length(direction);
  return vec4(direction.xy / max(distance_ + direction.z, 1e-6 * distance_), 1.0 - distance_ / v.far, 1.0);
}

// Depth that maps hold for a point.
float view_depth(ShadowView v, vec3 p) {
  return v.kind == kViewParaboloid ? distance(p, v.light) : dot(v.depth, vec4(p, 1.0));
}

// Position of a point of the device's world in texels from the top left. False if the view does not show it.
bool project_to_view(ShadowView v, vec3 p, out vec2 position) {
  vec4 h = view_position(v, p);
  position = (0.5 * h.xy / h.w + 0.5) * float(shadow.size);
  if (v.kind == kViewParaboloid && dot(v.depth, vec4(p, 1.0)) < 0.0) return false;
  return h.w > 0.0 && all(lessThanEqual(abs(h.xy), vec2(h.w)));
}

// Pages along a side of a view of a virtual map, and the one that holds a texel, the nearest one of the view.
uint pages_across() { return (shadow.size + kShadowPage - 1u) / kShadowPage; }
uvec2 page_of(ivec2 texel) { return uvec2(clamp(texel, ivec2(0), ivec2(shadow.size) - 1)) / kShadowPage; }

// Metres across a texel at a depth, of a view that is not warped.
float texel_width(ShadowView v, float depth) { return v.kind == kViewParallel ? v.texel : v.texel * depth; }

// Metres across a texel of a warped view at a point, across the light: the longer side or, of those that are askew,
// what a square of the same diagonal has.
float warped_texel(ShadowView v, vec3 p) {
  vec4 h = view_position(v, p);
  vec3 x = (v.x.xyz - h.x / h.w * v.w.xyz) / h.w, y = (v.y.xyz - h.y / h.w * v.w.xyz) / h.w; // gradients
  vec3 n = cross(x, y);
  vec3 a = cross(y, n) / dot(n, n), b = cross(n, x) / dot(n, n); // to the next position across, and down
  float diagonal = sqrt(max(dot(a + b, a + b), dot(a - b, a - b)));
  return 2.0 / float(shadow.size) * max(max(length(a), length(b)), 0.70710678 * diagonal);
}

// The point that three planes have in common, each dot(plane, (p, 1)) = 0, by Cramer's rule; infinite where they have
// none.
vec3 common_point(vec4 a, vec4 b, vec4 c) {
  vec3 bc = cross(b.xyz, c.xyz), ca = cross(c.xyz, a.xyz), ab = cross(a.xyz, b.xyz);
  return -(a.w * bc + b.w * ca + c.w * ab) / dot(a.xyz, bc);
}

// The two planes through the light that meet in the ray through a position. Not for paraboloids.
void planes_of_texel(ShadowView v, vec2 position, out vec4 a, out vec4 b) {
  vec2 at = 2.0 * position / float(shadow.size) - 1.0;
  a = v.x - at.x * v.w;
  b = v.y - at.y * v.w;
}

// The ray from the light through a position, from the near end on; `direction` of unit length.
void ray_of_texel(ShadowView v, vec2 position, out vec3 origin, out vec3 direction) {
  if (v.kind == kViewParaboloid) {
    vec2 at = 2.0 * position / float(shadow.size) - 1.0;
    vec3 local = vec3(2.0 * at, 1.0 - dot(at, at)) / (1.0 + dot(at, at));
    direction = normalize(local.x * v.x.xyz + local.y * v.y.xyz + local.z * v.depth.xyz);
    origin = v.light + v.near * direction;
    return;
  }
  vec4 a, b;
  planes_of_texel(v, position, a, b);
  direction = normalize(cross(a.xyz, b.xyz));
  if (dot(direction, v.depth.xyz) < 0.0) direction = -direction;
  origin = common_point(a, b, vec4(v.depth.xyz, v.depth.w - v.near));
}

#endif
