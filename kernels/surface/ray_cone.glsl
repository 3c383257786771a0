// Footprint of a pixel on a surface, for look-ups at mip levels, by ray cones (Akenine-Moeller et al. 2021), whose
// width is the side of the pixel at the depth of the hit. Include bindings.glsl with BIND_GEOMETRY and BIND_SURFACES
// first.
#ifndef WAVEPATH_RAY_CONE_GLSL
#define WAVEPATH_RAY_CONE_GLSL

#include "kernels/base/camera.glsl"
#include "kernels/bvh/instance.glsl"
#include "kernels/surface/surface.glsl"

// Sets the footprint of look-ups at the hit of a camera ray, `offset` from its origin. The cone's section of the
// surface is an ellipse, 1 / cosine as long as it is wide; its area decides. (Its length is as good by error, and blurs
// more: relMSE 0.00314 either way on Sponza, 0.0041 without levels; from 0.5x to 1.4x the width it stays within 3 %.)
void open_cone(Hit hit, vec3 offset) {
  if (!has_mips() || !uses(kFeatureTextures)) return;
  int texel = int(hit.triangle * kTriangleTexels);
  vec3 v0 = texelFetch(triangles, texel).xyz;
  vec3 side1 = texelFetch(triangles, texel + 1).xyz - v0, side2 = texelFetch(triangles, texel + 2).xyz - v0;
  if (is_instanced()) {
    side1 = transform_vector(hit.instance * kInstanceTexels + 3u, side1);
    side2 = transform_vector(hit.instance * kInstanceTexels + 3u, side2);
  }
  vec4 uv0 = surface_uv(hit.triangle, vec3(1.0, 0.0, 0.0));
  vec4 uv1 = surface_uv(hit.triangle, vec3(0.0, 1.0, 0.0)) - uv0,
       uv2 = surface_uv(hit.triangle, vec3(0.0, 0.0, 1.0)) - uv0;
  vec2 uv_area = abs(uv1.xz * uv2.yw - uv1.yw * uv2.xz);
  float depth = uses_camera_model() && measures_from_eye() ? length(offset) : dot(offset, frame.camera_forward);
  float side = frame.pixel_spread * (is_orthographic() ? 1.0 : depth);
  float seen_area = abs(dot(cross(side1, side2), normalize(offset))); // twice the triangle's area, as uv_area is
  footprint = seen_area > 0.0 ? side * side * (uv_area / seen_area) : vec2(0.0);
}

// Look-ups at other positions are exact again.
void close_cone() {
  if (has_mips()) footprint = vec2(0.0);
}

#endif
