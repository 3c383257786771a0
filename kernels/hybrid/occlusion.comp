// Traces ambient occlusion: the cosine-weighted fraction of the directions above a surface that are blocked within
// ao_radius. unoccluded fraction = 1 - that.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_RAYS
#define BIND_COUNTERS
#define BIND_HYBRID
#define BIND_GBUFFER
#define BIND_SIGNALS
#include "kernels/hybrid/bindings.glsl"
#include "kernels/path/bindings.glsl"
#include "kernels/base/dimensions.glsl"
#include "kernels/hybrid/frame_terms.glsl"
#include "kernels/path/records.glsl"
#include "kernels/base/pixel.glsl"
#include "kernels/surface/surface.glsl"

Sampler path_sampler;
#define ALPHA_TEST(hit) is_hole(hit, path_sampler, kHashConnect)
#define ANY_HIT
#include "kernels/bvh/trace.glsl"

layout(local_size_x = kWorkgroupSize) in;

void count_rays(bool traced) {
  uint count = subgroupBallotBitCount(subgroupBallot(traced)) * hybrid.ao_samples;
  if (!subgroupElect()) return;
  uint before = atomicAdd(counters.occlusion_rays[0], count);
  if (before + count < before) atomicAdd(counters.occlusion_rays[1], 1u);
}

// Directions that the shading normal allows but the real surface does not count as occluded: paths end there as well.
float unoccluded(Hit hit, vec3 normal, vec3 wo, uint pixel_index) {
  Surface surface = fetch_surface(hit);
  bool front = dot(surface.geometric_normal, wo) >= 0.0;
  lift_surface(surface, front);
  vec3 facing = front ? surface.geometric_normal : -surface.geometric_normal;
  vec3 tangent, bitangent;
  make_basis(normal, tangent, bitangent);
  uint free = 0u;
  for (uint i = 0u; i < hybrid.ao_samples; ++i) {
    path_sampler = make_sampler(frame.seed, pixel_index, hybrid_sample(hybrid.ao_samples, i),
                                frame_total() * hybrid.ao_samples);
    vec3 local = warp_cosine_hemisphere(sample_2d(path_sampler, kDimensionOcclusion));
    vec3 direction = normalize(to_world(local, tangent, bitangent, normal));
    if (!(dot(direction, facing) > 0.0)) continue;
    vec3 origin = offset_ray_origin(surface.position, surface.position_error, surface.geometric_normal, direction);
    if (trace(origin, direction, hybrid.ao_radius, kNone, 0u).triangle == kNone) ++free;
  }
  return float(free) / float(hybrid.ao_samples);
}

void main() {
  uint local = gl_GlobalInvocationID.x;
  Hit hit = Hit(kNone, 0u, 0.0, 0.0);
  if (local < wave.pixel_count) hit = fetch_hit(local); // hit of the pixel's first light sample; all samples have the
                                                        // same
  count_rays(hit.triangle != kNone);
  if (local >= wave.pixel_count) return;
  uvec2 pixel = slot_pixel(local);
  uint pixel_index = pixel.y * frame.width + pixel.x;
  signals[pixel_index].w = hit.triangle == kNone
                               ? 0.0
                               : unoccluded(hit, gbuffer[pixel_index].normal, -fetch_ray(local).direction, pixel_index);
}
