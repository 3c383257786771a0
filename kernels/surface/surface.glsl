// From a hit to the surface there: position with its error bound, normals, texture coordinates, colour.
// Include bindings.glsl with BIND_GEOMETRY and BIND_SURFACES first.
#ifndef WAVEPATH_SURFACE_GLSL
#define WAVEPATH_SURFACE_GLSL

#include "kernels/base/config.glsl"
#include "kernels/base/dimensions.glsl"
#include "kernels/base/math.glsl"
#include "kernels/base/motion.glsl"
#include "kernels/base/sampler.glsl"
#include "kernels/surface/texture.glsl"

struct Surface {
  vec3 position;       // device world
  vec3 position_error; // bound on its absolute error, per axis (Pharr, Jakob, Humphreys, section 6.8)
  vec3 geometric_normal; // unit, of the front: counter-clockwise
  vec3 vertex_normal;    // unit, interpolated; the geometric one where a mesh is flat
  vec4 tangent;          // unit, w = handedness; zero if the mesh has none
  vec4 uv;               // TEXCOORD_0, TEXCOORD_1
  vec4 color;            // COLOR_0
  uint material;
  uint light; // see Triangle
  vec3 lift_front, lift_back; // offset to the smooth surface, for either side (lift_surface())
#ifdef LAYERED
  Hit hit;
#endif
};

// Compiled in, and there is data for it: generic kernels must not read streams that this scene left out.
#define uses(feature) (has(feature) && (frame.scene_features & (feature)) != 0u)
#define uses_lobe(lobe) (has_lobe(lobe) && (frame.scene_lobes & (lobe)) != 0u)
bool is_instanced() { return has(kFeatureInstances) && frame.root_is_top != 0u; }

// Inverse of pack_tangent in host/scene/pack/vertices.h. Zero where there is none.
vec4 unpack_tangent(float packed) {
  uint bits = floatBitsToUint(packed);
  if (bits == 0u) return vec4(0.0);
  vec2 octahedral = vec2(float(bits >> 16u) / 65535.0, float((bits >> 1u) & 32767u) / 32767.0) * 2.0 - 1.0;
  vec3 direction = vec3(octahedral, 1.0 - abs(octahedral.x) - abs(octahedral.y));
  if (direction.z < 0.0)
    direction.xy = (1.0 - abs(direction.yx)) * vec2(direction.x < 0.0 ? -1.0 : 1.0, direction.y < 0.0 ? -1.0 : 1.0);
  return vec4(normalize(direction), (bits & 1u) != 0u ? -1.0 : 1.0);
}

// A value of three corners at a point between them. Weights sum to 1 but for rounding, so that only a form in which the
// first of them does not enter gives back a value that is the same at all corners, to the last bit.
vec3 interpolated(vec3 v0, vec3 v1, vec3 v2, vec3 weights) {
  return v0 + weights.y * (v1 - v0) + weights.z * (v2 - v0);
}
vec4 interpolated(vec4 v0, vec4 v1, vec4 v2, vec3 weights) {
  return v0 + weights.y * (v1 - v0) + weights.z * (v2 - v0);
}

// uv of a point on a triangle, for tests that need nothing else.
vec4 surface_uv(uint triangle, vec3 weights) {
  uvec3 vertex = texelFetch(triangle_vertices, int(triangle)).xyz;
  return interpolated(texelFetch(vertex_uvs, int(vertex.x)), texelFetch(vertex_uvs, int(vertex.y)),
                      texelFetch(vertex_uvs, int(vertex.z)), weights);
}

// Never beyond those of the corners: host/scene/pack/alpha.cpp decides by them what needs no look-up.
vec4 surface_color(uint triangle, vec3 weights) {
  uvec3 vertex = texelFetch(triangle_vertices, int(triangle)).xyz;
  vec4 c0 = texelFetch(vertex_colors, int(vertex.x)), c1 = texelFetch(vertex_colors, int(vertex.y)),
       c2 = texelFetch(vertex_colors, int(vertex.z));
  return clamp(interpolated(c0, c1, c2, weights), min(c0, min(c1, c2)), max(c0, max(c1, c2)));
}

// Tangents go by the transform itself; where it mirrors, the handedness changes.
vec4 tangent_to_world(vec4 to0, vec4 to1, vec4 to2, bool flipped, vec4 tangent) {
  vec3 t = tangent.xyz;
  return vec4(dot(to0.xyz, t), dot(to1.xyz, t), dot(to2.xyz, t), flipped ? -tangent.w : tangent.w);
}
vec4 tangent_to_world(uint instance, vec4 tangent) {
  int texel = int(instance * kInstanceTexels);
  return tangent_to_world(texelFetch(instances, texel + 3), texelFetch(instances, texel + 4),
                          texelFetch(instances, texel + 5), floatBitsToUint(texelFetch(instances, texel + 6).y) != 0u,
                          tangent);
}

// Object to world: exact bounds on what the transform adds to the position's error.
void to_world(uint instance, inout Surface surface) {
  int texel = int(instance * kInstanceTexels);
  vec4 from0 = texelFetch(instances, texel), from1 = texelFetch(instances, texel + 1),
       from2 = texelFetch(instances, texel + 2);
  vec4 to0 = texelFetch(instances, texel + 3), to1 = texelFetch(instances, texel + 4),
       to2 = texelFetch(instances, texel + 5);
  bool flipped = floatBitsToUint(texelFetch(instances, texel + 6).y) != 0u;
  vec4 p = vec4(surface.position, 1.0);
  vec3 size = abs(surface.position), error = surface.position_error;
  surface.position_error =
      (1.0 + gamma_bound(3)) * vec3(dot(abs(to0.xyz), error), dot(abs(to1.xyz), error), dot(abs(to2.xyz), error)) +
      gamma_bound(4) * vec3(dot(abs(to0.xyz), size) + abs(to0.w), dot(abs(to1.xyz), size) + abs(to1.w),
                            dot(abs(to2.xyz), size) + abs(to2.w));
  surface.position = vec3(dot(to0, p), dot(to1, p), dot(to2, p));
  // Normals go by the inverse transpose, which also keeps the front of a mirrored object in front.
  vec3 n = surface.geometric_normal;
  surface.geometric_normal = normalize(from0.xyz * n.x + from1.xyz * n.y + from2.xyz * n.z);
  n = surface.vertex_normal;
  surface.vertex_normal = normalize(from0.xyz * n.x + from1.xyz * n.y + from2.xyz * n.z);
  if (kTerminator == kTerminatorSmooth) {
    vec3 a = surface.lift_front, b = surface.lift_back;
    surface.lift_front = vec3(dot(to0.xyz, a), dot(to1.xyz, a), dot(to2.xyz, a));
    surface.lift_back = vec3(dot(to0.xyz, b), dot(to1.xyz, b), dot(to2.xyz, b));
  }
  surface.tangent = tangent_to_world(to0, to1, to2, flipped, surface.tangent);
}

// Normal and tangent of a vertex at the moment of the path; the tangent only where there are normal maps.
void fetch_normal(uint vertex, out vec3 normal, out vec4 tangent) {
  vec4 texel = texelFetch(vertex_normals, int(vertex));
  normal = texel.xyz;
  tangent = uses(kFeatureNormalMaps) ? unpack_tangent(texel.w) : vec4(0.0);
  if (kMoves) {
    texel = texelFetch(vertex_normals, int(vertex + frame.end_normals));
    normal = mix(normal, texel.xyz, shutter_time);
    if (uses(kFeatureNormalMaps)) tangent.xyz = mix(tangent.xyz, unpack_tangent(texel.w).xyz, shutter_time);
  }
}

// ---- the shadow terminator ------------------------------------------------------------------------------------------
// A coarse mesh with smooth normals is lit as the surface that it stands for, but its facets throw shadows on each
// other where that surface is still lit. With --terminator smooth, rays leave from that surface (Hanika, "Hacking the
// Shadow Terminator", Ray Tracing Gems II): the point is projected onto the tangent planes of the vertices, by their
// weights, where those lie above it.

// Offset towards the tangent plane of one vertex, whose normal `n` is on the given side.
vec3 lift_towards(vec3 vertex, vec3 n, vec3 p) { return max(dot(vertex - p, n), 0.0) * n; }

void find_lifts(vec3 v0, vec3 v1, vec3 v2, vec3 n0, vec3 n1, vec3 n2, vec3 weights, inout Surface surface) {
  float side = dot(surface.vertex_normal, surface.geometric_normal) < 0.0 ? -1.0 : 1.0; // as bumped_normal() has it
  n0 *= side;
  n1 *= side;
  n2 *= side;
  vec3 p = surface.position;
  surface.lift_front =
      weights.x * lift_towards(v0, n0, p) + weights.y * lift_towards(v1, n1, p) + weights.z * lift_towards(v2, n2, p);
  surface.lift_back = weights.x * lift_towards(v0, -n0, p) + weights.y * lift_towards(v1, -n1, p) +
                      weights.z * lift_towards(v2, -n2, p);
}

// Moves the point onto the smooth surface on one side, with its normal, for all rays that leave to that side. Where the
// mesh is concave it stays on its facet, but outside, so that rays below the facet end at it.
void lift_surface(inout Surface surface, bool front) {
  if (kTerminator != kTerminatorSmooth || surface.vertex_normal == surface.geometric_normal) return;
  vec3 facing = front ? surface.geometric_normal : -surface.geometric_normal;
  vec3 outside = offset_ray_origin(surface.position, surface.position_error, surface.geometric_normal, facing);
  surface.position = outside + (front ? surface.lift_front : surface.lift_back);
  bool reversed = dot(surface.vertex_normal, surface.geometric_normal) < 0.0;
  surface.geometric_normal = reversed ? -surface.vertex_normal : surface.vertex_normal;
}

Surface fetch_surface(Hit hit) {
  int texel = int(hit.triangle * kTriangleTexels);
  vec4 v0 = texelFetch(triangles, texel), v1 = texelFetch(triangles, texel + 1), v2 = texelFetch(triangles, texel + 2);
  v0.xyz = moved(v0.xyz, texel);
  v1.xyz = moved(v1.xyz, texel + 1);
  v2.xyz = moved(v2.xyz, texel + 2);
  vec3 weights = vec3(1.0 - hit.b1 - hit.b2, hit.b1, hit.b2);
  Surface surface;
#ifdef LAYERED
  surface.hit = hit;
#endif
  surface.position = weights.x * v0.xyz + weights.y * v1.xyz + weights.z * v2.xyz;
  surface.position_error =
      gamma_bound(7) * (abs(weights.x * v0.xyz) + abs(weights.y * v1.xyz) + abs(weights.z * v2.xyz));
  surface.geometric_normal = safe_normalize(cross(v1.xyz - v0.xyz, v2.xyz - v0.xyz), vec3(0.0, 0.0, 1.0));
  surface.vertex_normal = surface.geometric_normal;
  surface.material = floatBitsToUint(v0.w) & kTriangleMaterialMask;
  surface.light = floatBitsToUint(v2.w);
  surface.tangent = vec4(0.0);
  surface.lift_front = surface.lift_back = vec3(0.0);
  surface.uv = vec4(0.0);
  surface.color = vec4(1.0);

  if (uses(kFeatureSmoothNormals | kFeatureNormalMaps)) {
    uvec3 vertex = texelFetch(triangle_vertices, int(hit.triangle)).xyz;
    vec3 n0, n1, n2;
    vec4 t0, t1, t2;
    fetch_normal(vertex.x, n0, t0);
    fetch_normal(vertex.y, n1, t1);
    fetch_normal(vertex.z, n2, t2);
    if ((floatBitsToUint(v0.w) & kTriangleSmooth) != 0u) {
      surface.vertex_normal =
          safe_normalize(interpolated(n0, n1, n2, weights), surface.geometric_normal);
      if (kTerminator == kTerminatorSmooth) find_lifts(v0.xyz, v1.xyz, v2.xyz, n0, n1, n2, weights, surface);
    }
    if (uses(kFeatureNormalMaps)) {
      surface.tangent = vec4(interpolated(t0.xyz, t1.xyz, t2.xyz, weights), t0.w);
    }
  }
  if (uses(kFeatureTextures)) surface.uv = surface_uv(hit.triangle, weights);
  if (uses(kFeatureVertexColors)) surface.color = surface_color(hit.triangle, weights);
  if (is_instanced()) to_world(hit.instance, surface);
  return surface;
}

// Base colour with alpha, everything multiplied in.
vec4 base_color(Material material, vec4 uv, vec4 color) {
  return material.base_color * color * sample_color_or_1(kFeatureBaseColorTextures, material.base_color_texture, uv);
}

// Fraction of light that the surface stops: 1 = opaque. MASK decides by its cutoff, BLEND is a probability.
float opacity(Material material, float alpha) {
  if ((material.flags & kMaterialMask) != 0u) return alpha >= material.alpha_cutoff ? 1.0 : 0.0;
  if ((material.flags & kMaterialBlend) != 0u) return clamp(alpha, 0.0, 1.0);
  return 1.0;
}

// True if the traced ray sees unlit surfaces; kernels whose rays may not see them define it.
#ifndef SEES_UNLIT
#define SEES_UNLIT true
#endif

// Opacity where a ray meets a triangle. Unlit surfaces are there for some rays only, see is_hole().
float hit_opacity(Hit hit, bool sees_unlit) {
  uint triangle = hit.triangle;
  vec3 weights = vec3(1.0 - hit.b1 - hit.b2, hit.b1, hit.b2);
  uint packed = floatBitsToUint(texelFetch(triangles, int(triangle * kTriangleTexels)).w);
  Material material = fetch_material(packed & kTriangleMaterialMask);
  if ((material.flags & kMaterialUnlit) != 0u && !sees_unlit) return 0.0;
  vec4 uv = uses(kFeatureTextures) ? surface_uv(triangle, weights) : vec4(0.0);
  vec4 color = uses(kFeatureVertexColors) ? surface_color(triangle, weights) : vec4(1.0);
  return opacity(material, base_color(material, uv, color).a);
}

// True if this path passes through the hit. A random number of its own decides for every placed triangle and kind of
// ray. Only the eye and mirrors see unlit surfaces (KHR_materials_unlit); like viewers of glTF and Blender's importer,
// the path tracer lets them neither give nor receive light.
bool is_hole(Hit hit, Sampler path_sampler, uint kind) {
  uint placed = floatBitsToUint(texelFetch(triangles, int(hit.triangle * kTriangleTexels + 1u)).w);
  if (is_instanced()) // golden ratio: spreads instances over the words
    placed += floatBitsToUint(texelFetch(instances, int(hit.instance * kInstanceTexels + 6u)).z) * 0x9e3779b9u;
  return hash_unit(path_sampler, alpha_key(wave.bounce, kind), placed) >=
         hit_opacity(hit, (kind & 1u) == kHashExtend && SEES_UNLIT);
}

// A normal that a map bends, in world space.
vec3 mapped_normal(Surface surface, vec4 tangent, vec3 n, uint texture_, float scale) {
  vec3 mapped = sample_texture(texture_, surface.uv, false).xyz * 2.0 - 1.0;
  mapped.xy *= scale;
  vec3 t = safe_normalize(tangent.xyz - n * dot(n, tangent.xyz), vec3(0.0));
  vec3 b = cross(n, t) * tangent.w;
  return safe_normalize(t * mapped.x + b * mapped.y + n * mapped.z, n);
}

bool has_tangent(Surface surface) { return dot(surface.tangent.xyz, surface.tangent.xyz) > 0.0; }

// Shading normal on one side of the surface: interpolated, and bent by the normal map. Which of its two signs is meant
// follows from the side, so that meshes whose normals disagree with their winding are shaded all the same.
vec3 bumped_normal(Surface surface, Material material, bool front) {
  vec3 facing = front ? surface.geometric_normal : -surface.geometric_normal;
  vec3 n = surface.vertex_normal;
  bool reversed = dot(n, facing) < 0.0;
  if (has(kFeatureNormalMaps) && material.normal_texture != kNone && has_tangent(surface))
    n = mapped_normal(surface, surface.tangent, n, material.normal_texture, material.normal_scale);
  return reversed ? -n : n;
}

// Bent back where it would face away from the viewer: such a direction cannot be seen on a real bumpy surface; leaving
// it would render black.
vec3 held_normal(vec3 n, vec3 wo) {
  const float kGrazing = 1e-3; // cosine at which the normal is held
  float cosine = dot(n, wo);
  return cosine < kGrazing ? normalize(n + wo * (kGrazing - cosine)) : n;
}

vec3 shading_normal(Surface surface, Material material, bool front, vec3 wo) {
  return held_normal(bumped_normal(surface, material, front), wo);
}

#endif
