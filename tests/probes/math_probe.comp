// Evaluates kernels/base/math.glsl: one function by mode, on one element of four vectors.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernels/base/math.glsl"

layout(local_size_x = 64) in;
layout(push_constant) uniform Push { uint invocations; };
struct Element {
  vec4 a, b, c, d;
};
layout(set = 0, binding = 0, std430) readonly buffer Mode { uint mode; };
layout(set = 0, binding = 1, std430) buffer Elements { Element elements[]; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= invocations) return;
  Element e = elements[i];
  if (mode == 0u) { // angles
    e.b.xy = cos_sin_turns(e.a.x);
    e.b.z = atan2_exact(e.a.y, e.a.x);
    e.b.w = acos_exact(e.a.x);
  } else if (mode == 1u) { // floats by their bits
    e.b = vec4(is_finite(e.a.x) ? 1.0 : 0.0, next_float_up(e.a.x), next_float_down(e.a.x), gamma_bound(e.a.y));
  } else if (mode == 2u) { // warps of a.xy by kind a.z, with the density at the result
    int kind = int(e.a.z);
    if (kind == 0) e.b = vec4(warp_disk(e.a.xy), 0.0, warp_disk_pdf());
    if (kind == 1) e.b.xyz = warp_cosine_hemisphere(e.a.xy), e.b.w = warp_cosine_hemisphere_pdf(e.b.z);
    if (kind == 2) e.b = vec4(warp_uniform_hemisphere(e.a.xy), warp_uniform_hemisphere_pdf());
    if (kind == 3) e.b = vec4(warp_uniform_sphere(e.a.xy), warp_uniform_sphere_pdf());
    if (kind == 4) e.b = vec4(warp_triangle(e.a.xy), 0.0, warp_triangle_pdf(0.5));
  } else if (mode == 3u) { // basis around a
    vec3 tangent, bitangent;
    make_basis(e.a.xyz, tangent, bitangent);
    e.b.xyz = tangent;
    e.c.xyz = bitangent;
    e.d.xyz = to_world(to_local(e.d.xyz, tangent, bitangent, e.a.xyz), tangent, bitangent, e.a.xyz);
  } else if (mode == 4u) {
    e.a.xyz = offset_ray_origin(e.a.xyz, e.b.xyz, e.c.xyz, e.d.xyz);
  } else {
    e.b.xyz = safe_normalize(e.a.xyz, vec3(0.0, 0.0, 1.0));
  }
  elements[i] = e;
}
