// Merges camera paths with the photons around: paths that have met nothing but mirrors and smooth glass, where they
// arrive at something else.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_PATHS
#define BIND_RAYS
#define BIND_QUEUES
#define BIND_COUNTERS
#define BIND_PHOTONS
#define BIND_MERGE_WEIGHTS
#define BIND_GROUPS
#include "kernels/bidirectional/bindings.glsl"
#include "kernels/bidirectional/exact_total.glsl"
#include "kernels/bidirectional/merging.glsl"
#include "kernels/bidirectional/photons.glsl"
#include "kernels/bidirectional/scattering.glsl"
#include "kernels/path/crossing.glsl"
#include "kernels/path/light_groups.glsl"
#include "kernels/path/nonfinite.glsl"
#include "kernels/path/records.glsl"
#include "kernels/base/pixel.glsl"

layout(local_size_x = kWorkgroupSize) in;

// True if the photon is on the same piece of surface as v: within the radius, in a flat disk around v, facing the same
// way.
bool is_near(Vertex v, Photon photon) {
  const float kFlat = 0.25, kSameDirection = 0.8;
  vec3 offset = photon.position - v.surface.position, normal = v.surface.geometric_normal;
  float radius = photon_frame.radius;
  return dot(offset, offset) < square(radius) && abs(dot(offset, normal)) < kFlat * radius &&
         dot(unpackSnorm4x8(photon.normal).xyz, normal) > kSameDirection;
}

// Light that the photon brings, times the area that it stands for.
vec3 light_of(Vertex v, Photon photon) {
  if (!sides_agree(v, photon.direction)) return vec3(0.0);
  float forward;
  vec3 value = vertex_eval(v, photon.direction, forward);
  return value * photon.light * photon_weight(photon, forward);
}

// The list of the k-th of the eight cells that a ball of the radius around the vertex reaches, as index + 1.
uint list_of(ivec3 lowest, uint k, uint replicate, out ivec3 cell) {
  cell = lowest + ivec3(k & 1u, (k >> 1u) & 1u, k >> 2u);
  return texelFetch(photon_cell_texels, int(cell_index(cell, replicate))).y;
}

// Sum over all photons near v of which the camera path has bounces left to take the light; with groups of lights over
// those of one group.
vec3 gather(Vertex v, uint replicate, uint group) {
  uvec4 red = uvec4(0u), green = uvec4(0u), blue = uvec4(0u);
  bool sound = true;
  ivec3 lowest = ivec3(floor(v.surface.position * photon_frame.cells_per_metre - 0.5)), cell;
  uint cells = 0u, next = 0u; // cells begun; index + 1 of the photon to look at
  do {
    bool found = false;
    Photon photon;
    do { // advance to the next photon that counts, so that lanes evaluate photons at the same time
      if (next == 0u) {
        if (cells < 8u) next = list_of(lowest, cells, replicate, cell);
        ++cells;
      } else {
        photon = fetch_photon(next - 1u);
        found = is_near(v, photon) && cell_of(photon.position) == cell &&
                (photon.link >> kPhotonBounceShift) + wave.bounce <= frame.max_depth &&
                replicate_of_photon(next - 1u) == replicate &&
                (!HAS_LIGHT_GROUPS || photon.normal >> kPhotonGroupShift == group);
        next = photon.link & kPhotonIndexMask;
      }
    } while (!found && (next != 0u || cells < 8u));
    if (found) {
      vec3 light = light_of(v, photon);
      sound = sound && is_finite(light) && max_component(light) < kLargestTerm;
      if (sound) {
        add_exact(red, light.r);
        add_exact(green, light.g);
        add_exact(blue, light.b);
      }
    }
  } while (next != 0u || cells < 8u);
  vec3 sum = vec3(value_of(red), value_of(green), value_of(blue));
  return sound ? sum / photon_frame.density : poisoned(vec3(0.0));
}

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= queues.ray_count[wave.bounce & 1u]) return;
  Ray ray = fetch_ray((wave.bounce & 1u) * frame.slot_count + index);
  if (merge_weights[ray.slot] != kMayMerge) return;
  Hit hit = fetch_hit(index);
  if (hit.triangle == kNone || (HAS_VOXELS && hit.triangle == kScattered)) return;
  Surface surface = fetch_surface(hit);
  Material material = fetch_material(surface.material);
  if ((material.flags & kMaterialUnlit) != 0u) return;
  Vertex v = make_vertex(surface, material, ray.direction);
  if (!(surface_cosine(v, v.wo) > 0.0) || !bsdf_has_smooth(v.bsdf) || is_hidden(v, ray.slot)) return;
  PathState path = fetch_path(ray.slot);
  if (!is_finite(path.radiance)) return; // another kernel has counted it
  vec3 throughput = path.throughput;
  if (has(kFeatureVolume))
    throughput *= medium_transmittance(current_body(ray.slot), length(surface.position - ray.origin));
  uint replicate = slot_sample(ray.slot) % kReplicates, sums = HAS_LIGHT_GROUPS ? group_count() : 1u;
  for (uint group = 0u; group < sums; ++group) {
    vec3 light = throughput * gather(v, replicate, group);
    path.radiance += light;
    if (HAS_LIGHT_GROUPS) add_to_group(group, ray.slot, light);
  }
  if (!is_finite(path.radiance)) count_nonfinite(kMakerConnect, ray.slot);
  store_radiance(ray.slot, path);
}
