// Shades the hits of light paths that photons come from: they go on through delta lobes alone, and leave a photon where they are
// scattered otherwise, unless that is the first surface: what lamps light directly is found without photons.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_LIGHTS
#define BIND_ENVIRONMENT
#define BIND_PATHS
#define BIND_RAYS
#define BIND_QUEUES
#define BIND_PATH_WEIGHTS
#define BIND_PHOTONS
#include "kernels/bidirectional/bindings.glsl"
#include "kernels/bidirectional/light_step.glsl"
#include "kernels/bidirectional/photons.glsl"
#include "kernels/path/queue.glsl"

layout(local_size_x = kWorkgroupSize) in;

void keep_photon(uint slot, Photon photon) {
  uint replicate = wave.first_sample % kReplicates;
  store_photon(replicate * photon_frame.path_count + wave.first_pixel + slot, photon);
  atomicAdd(photon_cells[cell_place(cell_of(photon.position), replicate)].x, 1u);
}

// Probability of going on through a delta lobe rather than ending in a photon. It need not fit the lobes, but does where it can:
// photons then carry the same light.
float go_probability(Vertex v, Lobes lobes) {
  if (lobes.facet_probability == 0.0) return 0.0;
  if (!bsdf_has_smooth(v.bsdf)) return 1.0;
  return lobes.delta_reflection ? lobes.facet_probability : lobes.delta_transmission ? 0.5 : 0.0;
}

// Follows a light path to its next vertex. Returns whether it goes on with `next`.
bool follow(Ray ray, Hit hit, inout PathState path, out Ray next) {
  Vertex v;
  float cosine;
  PathWeights weights;
  if (!light_arrives(ray, hit, path, v, cosine, weights)) return false;
  vec3 local = to_local(v, v.wo);
  if (!(local.z > 0.0)) return false;
  Sampler path_sampler = light_sampler(ray.slot);
  uint dimension = bounce_dimension(wave.bounce);
  vec2 u = sample_2d(path_sampler, dimension + kDimensionDirection);
  vec2 u_choice = sample_2d(path_sampler, dimension + kDimensionChoice);
  Lobes lobes = lobes_of(v.bsdf, local);
  float go = go_probability(v, lobes);
  if (u_choice.x >= go) {
    vec3 light = path.radiance * path.throughput / (cosine * (1.0 - go));
    if (wave.bounce > 1u && bsdf_has_smooth(v.bsdf) && is_finite(light) && max_component(light) > 0.0 && wave.bounce <= kMostPhotonBounces)
      keep_photon(ray.slot, Photon(v.surface.position, packSnorm4x8(vec4(v.surface.geometric_normal, 0.0)), v.wo,
                                   wave.bounce << kPhotonBounceShift, light, weights.others));
    return false;
  }
  BsdfSample s = BsdfSample(vec3(0.0, 0.0, 1.0), vec3(0.0), -1.0, 1.0, false);
  bool delta;
  if (!sample_facets(v.bsdf, lobes, local, min(u_choice.x / go, kOneMinusEpsilon), u, s, delta) || !delta) return false;
  s.weight *= lobes.facet_probability / go;
  vec3 w = normalize(to_world(s.wi, v.tangent, v.bitangent, v.normal));
  if (!(surface_cosine(v, w) > 0.0) || !sides_agree(seen_from(v, w), v.wo)) return false;
  if (!light_passes_delta(v, local, s, w, path, weights)) return false;
  store_weights(ray.slot, weights);
  return light_departs(v, s.transmitted, w, u_choice.y, ray.slot, path, next);
}

void main() {
  uint index = gl_GlobalInvocationID.x;
  bool goes_on = false;
  Ray next;
  if (index < queues.ray_count[wave.bounce & 1u]) {
    Ray ray = fetch_ray((wave.bounce & 1u) * frame.slot_count + index);
    PathState path = fetch_path(ray.slot);
    goes_on = follow(ray, fetch_hit(index), path, next);
    goes_on = goes_on && is_finite(path.throughput) && is_finite(next.origin) && is_finite(next.direction);
    store_path(ray.slot, path);
  }
  uint next_queue = (wave.bounce + 1u) & 1u;
  uint place;
  APPEND(queues.ray_count[next_queue], goes_on, place);
  if (goes_on) store_ray(next_queue * frame.slot_count + place, next);
}
