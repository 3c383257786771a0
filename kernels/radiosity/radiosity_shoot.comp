// Traces the rays of shots, of which the share that hits a face is its form factor. A shot leaves all of its patch,
// cosine-weighted; or its middle, through the pixels of a hemicube (Cohen and Greenberg 1985), whose weights the host
// knows.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_COUNTERS
#define BIND_PATCH_TREE
#define BIND_PATCHES
#define SEES_UNLIT false
#include "kernels/path/bindings.glsl"
#include "kernels/base/records.glsl"
#include "kernels/radiosity/patches.glsl"

Sampler path_sampler;
#define ALPHA_TEST(hit) is_hole(hit, path_sampler, kHashExtend)
#include "kernels/bvh/trace.glsl"

layout(set = 0, binding = kBindShotBlocks) uniform usamplerBuffer shot_blocks;
layout(set = 0, binding = kBindShotHits, std430) writeonly buffer ShotHitBlock { uint shot_hits[]; };

layout(local_size_x = kWorkgroupSize) in;

// Middle of a pixel of a hemicube: first those of the top face, then of the upper halves of the four others.
vec3 hemicube_direction(uint pixel, uint side) {
  float step_ = 2.0 / float(side);
  uint half_face = side * side / 2u, beyond = pixel - side * side;
  if (pixel < side * side) return vec3((vec2(pixel % side, pixel / side) + 0.5) * step_ - 1.0, 1.0);
  uint face = beyond / half_face, at = beyond % half_face;
  float across = (float(at % side) + 0.5) * step_ - 1.0, up = (float(at / side) + 0.5) * step_;
  if (face == 0u) return vec3(1.0, across, up);
  if (face == 1u) return vec3(-1.0, across, up);
  return vec3(across, face == 2u ? 1.0 : -1.0, up);
}

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= wave.pixel_count) return;
  uvec4 words = texelFetch(shot_blocks, int(index / kBlockRays));
  ShotBlock block = ShotBlock(words.x, words.y, words.z, words.w);
  uint ray = block.first + index % kBlockRays, side = block.rays & ~kHemicube;
  bool by_hemicube = (block.rays & kHemicube) != 0u;
  shot_hits[index] = kNone;
  if (block.face == kNone || ray >= (by_hemicube ? 3u * side * side : side)) return;
  path_sampler = make_replicate_sampler(frame.seed, block.shot, 2u, ray, side);
  Hit from = by_hemicube ? point_of_patch(block.face / 2u, vec3(1.0 / 3.0))
                         : point_of_patch(block.face / 2u, sample_2d(path_sampler, 0u));
  Surface surface = fetch_surface(from);
  vec3 n = (block.face & 1u) != 0u ? -surface.geometric_normal : surface.geometric_normal;
  vec3 local = by_hemicube ? normalize(hemicube_direction(ray, side))
                           : warp_cosine_hemisphere(sample_2d(path_sampler, 1u));
  vec3 tangent, bitangent;
  make_basis(n, tangent, bitangent);
  vec3 direction = normalize(to_world(local, tangent, bitangent, n));
  vec3 origin = offset_ray_origin(surface.position, surface.position_error, surface.geometric_normal, n);
  Hit hit = trace(origin, direction, kFar);
  COUNT(counters.bounce_rays, 1u)
  if (hit.triangle == kNone) return;
  vec3 weights;
  shot_hits[index] = face_at(hit, dot(fetch_surface(hit).geometric_normal, direction) > 0.0, weights);
}
