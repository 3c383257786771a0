// Patches of the radiosity mesh: from a point of a triangle to its patch, and the reflectance of a surface that is
// taken for diffuse. Include bindings.glsl with BIND_GEOMETRY and BIND_SURFACES first.
#ifndef WAVEPATH_PATCHES_GLSL
#define WAVEPATH_PATCHES_GLSL

#include "kernels/radiosity/radiosity_types.h"
#include "kernels/surface/vertex.glsl"

#ifdef BIND_PATCH_TREE
layout(set = 0, binding = kBindPatchRoots) uniform usamplerBuffer patch_roots;
layout(set = 0, binding = kBindPatchNodes) uniform usamplerBuffer patch_nodes;

// The patch that a hit is on. `weights`: its barycentric weights there.
uint patch_at(Hit hit, out vec3 weights) {
  uint first = texelFetch(patch_roots, is_instanced() ? int(hit.instance) : 0).x;
  uint node = texelFetch(patch_nodes, int(texelFetch(patch_roots, int(first + hit.triangle)).x)).x;
  weights = vec3(1.0 - hit.b1 - hit.b2, hit.b1, hit.b2);
  for (uint level = 0u; level < kDeepestPatch && (node & kPatchLeaf) == 0u; ++level) {
    uint child = weights.x >= 0.5 ? 0u : weights.y >= 0.5 ? 1u : weights.z >= 0.5 ? 2u : 3u;
    if (child == 3u) {
      weights = 1.0 - 2.0 * weights;
    } else {
      weights *= 2.0;
      weights[child] -= 1.0;
    }
    node = texelFetch(patch_nodes, int(node + child)).x;
  }
  return node & ~kPatchLeaf;
}

uint face_at(Hit hit, bool back, out vec3 weights) { return 2u * patch_at(hit, weights) + (back ? 1u : 0u); }
#endif

#ifdef BIND_CORNER_LIGHT
layout(set = 0, binding = kBindCornerLight) uniform samplerBuffer corner_light;

// Irradiance between the corners of the face (Gouraud 1971).
vec3 interpolated_light(Hit hit, bool back) {
  vec3 weights;
  int texel = int(3u * face_at(hit, back, weights));
  return weights.x * texelFetch(corner_light, texel).rgb + weights.y * texelFetch(corner_light, texel + 1).rgb +
         weights.z * texelFetch(corner_light, texel + 2).rgb;
}
#endif

#ifdef BIND_PATCHES
layout(set = 0, binding = kBindPatches) uniform usamplerBuffer patches;

// The point of a patch with these barycentric weights.
Hit point_of_patch(uint index, vec3 weights) {
  uvec4 first = texelFetch(patches, int(kPatchTexels * index)),
        second = texelFetch(patches, int(kPatchTexels * index + 1u));
  vec2 at = weights.x * uintBitsToFloat(first.zw) + weights.y * uintBitsToFloat(second.xy) +
            weights.z * uintBitsToFloat(second.zw);
  return Hit(first.x, first.y, at.x, at.y);
}

Hit point_of_patch(uint index, vec2 u) {
  vec2 weights = warp_triangle(u);
  return point_of_patch(index, vec3(1.0 - weights.x - weights.y, weights));
}
#endif

// All that the surface reflects, as if it went everywhere alike: the diffuse base and what the interface over it
// mirrors.
vec3 diffuse_reflectance(Vertex v) {
  if ((v.material.flags & kMaterialUnlit) != 0u) return vec3(0.0);
  vec3 base = clamp(v.bsdf.base_color, 0.0, 1.0);
  if (!kMicrofacets) return base;
  float mirrored = (1.0 - v.bsdf.metallic) * interface_mean(surface_of(v.bsdf), v.bsdf.alpha);
  return base + mirrored * (1.0 - base);
}

// Adds to a total of 64 bits.
#define COUNT(total, n)                                                      \
  {                                                                          \
    uint before_ = atomicAdd(total[0], n);                                   \
    if (before_ + n < before_) atomicAdd(total[1], 1u);                      \
  }

#endif
