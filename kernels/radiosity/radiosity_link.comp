// Traces rays between points of the two faces of links, of which the share that nothing stops is the link's visibility.
// Each counts as much as the light that goes along it.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_COUNTERS
#define BIND_PATCHES
#define SEES_UNLIT false
#include "kernels/path/bindings.glsl"
#include "kernels/base/records.glsl"
#include "kernels/radiosity/patches.glsl"

Sampler path_sampler;
#define ALPHA_TEST(hit) is_hole(hit, path_sampler, kHashExtend)
#define ANY_HIT
#include "kernels/bvh/trace.glsl"

layout(set = 0, binding = kBindShotBlocks) uniform usamplerBuffer link_blocks;
layout(set = 0, binding = kBindShotHits, std430) writeonly buffer LinkLightBlock { uint link_light[]; };

layout(local_size_x = kWorkgroupSize) in;

// A point of a face, and the normal on its side.
Surface point_of_face(Hit at, uint face, out vec3 n) {
  Surface surface = fetch_surface(at);
  n = (face & 1u) != 0u ? -surface.geometric_normal : surface.geometric_normal;
  return surface;
}

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= wave.pixel_count) return;
  uvec4 words = texelFetch(link_blocks, int(index / kBlockRays));
  LinkBlock link = LinkBlock(words.x, words.y, words.z, words.w);
  link_light[index] = 0u;
  path_sampler = make_replicate_sampler(frame.seed, link.number, 3u, index % kBlockRays, kBlockRays);
  Hit from = point_of_patch(link.a / 2u, sample_2d(path_sampler, 0u));
  Hit to = point_of_patch(link.b / 2u, sample_2d(path_sampler, 1u));
  vec3 n_a, n_b;
  Surface a = point_of_face(from, link.a, n_a), b = point_of_face(to, link.b, n_b);
  vec3 apart = b.position - a.position;
  float cosine_a = dot(n_a, apart), cosine_b = -dot(n_b, apart), distance2 = dot(apart, apart);
  if (!(cosine_a > 0.0) || !(cosine_b > 0.0)) return;
  float light = cosine_a / distance2 * (cosine_b / distance2);
  vec3 origin = offset_ray_origin(a.position, a.position_error, a.geometric_normal, n_a);
  vec3 target = offset_ray_origin(b.position, b.position_error, b.geometric_normal, n_b);
  COUNT(counters.shadow_rays, 1u)
  uint id = floatBitsToUint(texelFetch(triangles, int(to.triangle * kTriangleTexels + 1u)).w);
  bool is_stopped = trace(origin, target - origin, 1.0, id, to.instance).triangle != kNone; // by another triangle
  link_light[index] = floatBitsToUint(is_stopped ? -light : light);
}
