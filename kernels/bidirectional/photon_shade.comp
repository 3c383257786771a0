// Shades the hits of light paths that photons come from. A path leaves a photon where it is scattered by other than a
// delta lobe, and has come there from one; then it goes on, but only as long as delta lobes and others take turns, and
// a delta lobe was first: all other light is found without photons.
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
#define BIND_MERGE_WEIGHTS
#define BIND_GROUPS
#include "kernels/bidirectional/bindings.glsl"
#include "kernels/bidirectional/light_step.glsl"
#include "kernels/bidirectional/photons.glsl"
#include "kernels/path/light_groups.glsl"
#include "kernels/path/queue.glsl"

layout(local_size_x = kWorkgroupSize) in;

// A path keeps one photon of all that it leaves, picked in proportion to their light, and as bright as all: so photons
// are as bright as each other, and lie where the light is. `merge_weights` has the sum so far.
void keep_photon(uint slot, Photon photon, float u) {
  uint replicate = wave.first_sample % kReplicates,
       photon_index = replicate * photon_frame.path_count + wave.first_pixel + slot;
  float brightness = luminance(photon.light), before = merge_weights[slot], total = before + brightness;
  merge_weights[slot] = total;
  if (!(brightness > 0.0)) return;
  bool replaces = u * total >= before;
  if (before > 0.0) {
    Photon earlier = fetch_photon(photon_index);
    if (replaces)
      atomicAdd(photon_cells[cell_index(cell_of(earlier.position), replicate)].x, 0xffffffffu); // one less
    else
      store_photon_light(photon_index, earlier.light * (total / before), earlier.others);
  }
  if (!replaces) return;
  photon.light *= total / brightness;
  store_photon(photon_index, photon);
  atomicAdd(photon_cells[cell_index(cell_of(photon.position), replicate)].x, 1u);
}

// Probability of going on through a delta lobe rather than ending in a photon. It need not fit the lobes, but does
// where it can: photons then carry the same light.
float go_probability(Vertex v, Lobes lobes) {
  if (lobes.facet_probability == 0.0) return 0.0;
  if (!bsdf_has_smooth(v.bsdf)) return 1.0;
  return lobes.delta_reflection ? lobes.facet_probability : lobes.delta_transmission ? 0.5 : 0.0;
}

// Scatters the path by a lobe that is not delta. `u`: what the choice to do so has left of its numbers.
bool scatter(Vertex v, vec3 local, float u_side, vec2 u, inout PathState path, inout PathWeights weights, out vec3 w,
             out BsdfSample s) {
  if (!vertex_sample(v, u_side, u, s, w) || s.pdf < 0.0) return false;
  Vertex seen = seen_from(v, w);
  float out_cosine = surface_cosine(v, w), forward;
  if (!(out_cosine > 0.0) || !sides_agree(seen, v.wo)) return false;
  vec3 value = vertex_eval(seen, v.wo, forward);
  path.throughput *= value * (out_cosine / (surface_cosine(v, v.wo) * s.pdf));
  weights = scattered(weights, out_cosine, s.pdf, forward, false);
  return true;
}

// Sends the path on through a delta lobe. `u`: as above.
bool pass(Vertex v, vec3 local, Lobes lobes, float go, float u_side, vec2 u, inout PathState path,
          inout PathWeights weights, out vec3 w, out BsdfSample s) {
  s = BsdfSample(vec3(0.0, 0.0, 1.0), vec3(0.0), -1.0, 1.0, false, false);
  bool delta;
  if (!sample_facets(v.bsdf, lobes, local, u_side, u, s, delta) || !delta) return false;
  s.weight *= lobes.facet_probability / go;
  w = normalize(to_world(s.wi, v.tangent, v.bitangent, v.normal));
  if (!(surface_cosine(v, w) > 0.0) || !sides_agree(seen_from(v, w), s, v.wo)) return false;
  return light_passes_delta(v, local, s, w, path, weights);
}

// Follows a light path to its next vertex. Returns whether it goes on with `next`.
bool follow(Ray ray, Hit hit, inout PathState path, out Ray next) {
  if (wave.bounce == 1u) merge_weights[ray.slot] = 0.0;
  bool after_delta = wave.bounce > 1u && fetch_weights(ray.slot).connect == 0.0; // see scattered_delta()
  Vertex v;
  float cosine;
  PathWeights weights;
  if (!light_arrives(ray, hit, path, v, cosine, weights)) return false;
  if (is_hidden(v, ray.slot)) {
    bool passes = light_passes_hidden(ray, v, cosine, path, weights, next);
    store_weights(ray.slot, weights);
    return passes;
  }
  vec3 local = to_local(v, v.wo), w;
  if (!(local.z > 0.0)) return false;
  Sampler path_sampler = light_sampler(ray.slot);
  uint dimension = bounce_dimension(wave.bounce);
  vec2 u = sample_2d(path_sampler, dimension + kDimensionDirection);
  vec2 u_choice = sample_2d(path_sampler, dimension + kDimensionChoice);
  Lobes lobes = lobes_of(v.bsdf, local);
  float go = go_probability(v, lobes);
  BsdfSample s;
  bool goes_on;
  vec2 left = u;
  if (take_with_probability(left.y, go)) {
    goes_on = pass(v, local, lobes, go, u_choice.x, left, path, weights, w, s);
  } else {
    if (!after_delta || !bsdf_has_smooth(v.bsdf) || wave.bounce > kMostPhotonBounces) return false;
    vec3 light = path.radiance * path.throughput / (cosine * (1.0 - go));
    if (!is_finite(light)) return false;
    uint normal = packSnorm4x8(vec4(v.surface.geometric_normal, 0.0));
    if (HAS_LIGHT_GROUPS) normal |= path_group(ray.slot) << kPhotonGroupShift;
    keep_photon(ray.slot,
                Photon(v.surface.position, normal, v.wo, wave.bounce << kPhotonBounceShift, light, weights.others),
                sample_2d(path_sampler, dimension + kDimensionLight).x);
    if (!lobes.delta_reflection) { // with a delta reflection, vertex_sample() makes the same choice by the same number
      path.throughput /= 1.0 - go;
      u = left;
    }
    goes_on = scatter(v, local, u_choice.x, u, path, weights, w, s);
  }
  if (!goes_on) return false;
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
  uint append_index;
  APPEND(queues.ray_count[next_queue], goes_on, append_index);
  if (goes_on) store_ray(next_queue * frame.slot_count + append_index, next);
}
