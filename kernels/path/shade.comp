// Shades the hits of the queue: emission, shadow rays towards lights, and the next ray of the path.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_LIGHTS
#define BIND_LIGHT_TREE
#define BIND_RECEIVERS
#define BIND_ENVIRONMENT
#define BIND_PATHS
#define BIND_RAYS
#define BIND_SORTED_RAYS
#define BIND_SHADOW_RAYS
#define BIND_QUEUES
#define BIND_COUNTERS
#define BIND_SEEN
#define BIND_GUIDE
#define BIND_REUSE
#define BIND_GROUPS
#include "kernels/path/bindings.glsl"
#include "kernels/base/dimensions.glsl"
#include "kernels/light/emission.glsl"
#include "kernels/path/aovs_through.glsl"
#include "kernels/path/cover.glsl"
#include "kernels/path/escape.glsl"
#include "kernels/path/first_hit.glsl"
#include "kernels/path/found_light.glsl"
#include "kernels/path/guided.glsl"
#include "kernels/path/light_groups.glsl"
#include "kernels/path/medium.glsl"
#include "kernels/path/medium_light.glsl"
#include "kernels/path/medium_roulette.glsl"
#include "kernels/path/nonfinite.glsl"
#include "kernels/path/queue.glsl"
#include "kernels/path/queue_item.glsl"
#include "kernels/path/receiver.glsl"
#include "kernels/path/reuse_vertex.glsl"
#include "kernels/path/records.glsl"
#include "kernels/path/sky_density.glsl"
#include "kernels/path/path_sampler.glsl"
#include "kernels/surface/ray_cone.glsl"
#include "kernels/base/records.glsl"
#include "kernels/surface/vertex.glsl"
#include "kernels/surface/walls.glsl"

layout(local_size_x = kWorkgroupSize) in;

Guide guide; // guide of the vertex being shaded
bool sends = false; // true if the vertex sends light to neighbours
uint sender;        // slot of that vertex

uint light_sample_count() { return light_samples_at(kLightSamples, wave.bounce); }

bool is_behind(Vertex v, vec3 direction) { return is_below(v, direction) && !v.bsdf.thin; }

// Transmittance of the body on the side of the surface that `direction` leaves to; 1 where shadow rays pass walls,
// since connect then computes it.
vec3 transmittance_towards(Vertex v, vec3 direction, float distance_, uint slot) {
  if (!has(kFeatureVolume) || uses_walls()) return vec3(1.0);
  return medium_transmittance(is_behind(v, direction) ? body_behind(v, slot) : current_body(slot), distance_);
}

// Stores for connect the bodies in which the vertex's shadow rays begin.
void store_bodies_around(Vertex v, uint slot) {
  if (!has(kFeatureVolume) || !uses_walls()) return;
  store_bodies(kBodiesHere, slot, fetch_bodies(slot));
  store_bodies(kBodiesBehind, slot, bodies_behind(v, slot));
}

// t_max of a shadow ray, which also tells connect whether the ray begins behind the surface.
float t_max_of(Vertex v, vec3 direction, bool distant, uint slot) {
  float t_max = distant ? kFar : 1.0;
  if (!marks_bodies()) return t_max;
  bool marked = is_behind(v, direction);
  if (HAS_VOXELS) marked = (marked ? body_behind(v, slot) : current_body(slot)) != kNone;
  return marked ? behind_t_max(t_max) : t_max;
}

bool is_soft_lamp(uint index) {
  if (!has_soft_lamps()) return false;
  return is_soft(fetch_light(index));
}

// Next-event estimation by one of light_sample_count() samples, the one at `index`. Returns true if there is a shadow
// ray to trace.
bool connect_to_light(Vertex v, Lobes lobes, Receiver receiver, Sampler path_sampler, uint dimension, uint slot,
                      vec3 throughput, uint index, out ShadowRay ray) {
  LightSample light = sample_light(receiver, sample_bits(path_sampler, dimension + kDimensionLight));
  if (max_component(light.radiance) <= 0.0 || !(light.pdf > 0.0) || !sides_agree(v, light.direction)) return false;

  float bsdf_pdf;
  vec3 scattered = vertex_eval(v, lobes, light.direction, bsdf_pdf);
  if (has(kFeatureGuide)) bsdf_pdf = guided_pdf(guide, bsdf_pdf, light.direction);
  float density = light.pdf; // density of all light samples together
  if (TAKES_MORE_LIGHT_SAMPLES) density *= float(light_sample_count());
  float weight = light.delta || kDirect == kDirectNee ? 1.0 : mis_weight(density, bsdf_pdf);
  bool is_lamp = false, is_caught_lamp = false;
  if (COVERS && wave.bounce == 0u) {
    is_lamp = is_soft_lamp(light.light);
    is_caught_lamp = is_lamp && is_caught(slot);
    if (is_caught_lamp) weight = 1.0; // no ray from there meets it
  }
  ray.contribution = throughput * scattered * light.radiance * (weight / density);
  float distance_ = light.distant ? kFarAway : length(light.target - v.surface.position);
  ray.contribution *= transmittance_towards(v, light.direction, distance_, slot);
  if (is_finite(ray.contribution) && max_component(ray.contribution) <= 0.0) return false;
  if (COVERS && wave.bounce == 0u)
    note_light_sample(slot, index, ray.contribution, weight,
                      !light.delta && (is_lamp ? !is_caught_lamp : !light.distant));

  ray.slot = slot;
  ray.light = light.light;
  ray.origin =
      offset_ray_origin(v.surface.position, v.surface.position_error, v.surface.geometric_normal, light.direction);
  ray.direction = light.distant ? light.direction : light.target - ray.origin;
  ray.t_max = t_max_of(v, light.direction, light.distant, slot);
  return true;
}

// Light samples of a vertex are consecutive points of one net, and so are directions to the sky.
Sampler one_of(Sampler path_sampler, uint i, uint count) {
  path_sampler.index = path_sampler.index * count + i;
  path_sampler.count = min(path_sampler.count, kNone / count) * count;
  return path_sampler;
}

// Next-event estimation by all light samples; appends the shadow rays to their queues. Appends lane by lane, since the
// lanes of a subgroup need not be together here.
void connect_to_lights(Vertex v, Lobes lobes, Receiver receiver, Sampler path_sampler, uint dimension, uint slot,
                       vec3 throughput) {
  for (uint i = 0u; i < light_sample_count(); ++i) {
    ShadowRay ray;
    bool wanted = connect_to_light(v, lobes, receiver, one_of(path_sampler, i, light_sample_count()), dimension, slot,
                                   throughput, i, ray);
    if (!wanted) continue;
    store_shadow_ray(i * frame.slot_count + atomicAdd(queues.shadow_count[i], 1u), ray);
  }
}

// Draws a direction in which the vertex looks for the sky, and the weight of the sky's radiance. Returns false if it
// brings nothing.
bool sample_sky(Vertex v, Lobes lobes, Receiver receiver, Sampler sky_sampler, out vec3 wi, out vec3 weight) {
  uint dimension = kDimensionSky + 2u * wave.bounce;
  float bsdf_pdf;
  if (USES_LEARNED_SKY) {
    uvec2 u = sample_bits(sky_sampler, dimension);
    float density = learned_sky_pdf(wave.bounce, pick_sky_part(receiver, u));
    wi = sky_direction(u);
    if (!sides_agree(v, wi)) return false;
    weight = vertex_eval(v, lobes, wi, bsdf_pdf);
    if (has(kFeatureGuide)) bsdf_pdf = guided_pdf(guide, bsdf_pdf, wi);
    weight *= mis_weight(density, bsdf_pdf) / density;
    return true;
  }
  BsdfSample s;
  if (!guided_sample(v, lobes, guide, sample_2d(sky_sampler, dimension + 1u).x, sample_2d(sky_sampler, dimension), s,
                     wi, bsdf_pdf))
    return false;
  weight = s.weight / float(sky_directions());
  return s.pdf >= 0.0 && sides_agree(v, wi); // a delta lobe is the path's own
}

// Samples the directions towards the sky besides the path's own; their shadow rays go to separate queues.
void connect_to_sky(Vertex v, Lobes lobes, Receiver receiver, Sampler path_sampler, uint slot, vec3 throughput) {
  uint further = further_directions(wave.bounce);
  for (uint i = 1u; i <= further; ++i) {
    vec3 wi, weight;
    if (!sample_sky(v, lobes, receiver, one_of(path_sampler, i - 1u, further), wi, weight)) continue;
    ShadowRay ray;
    ray.contribution = throughput * frame.environment_radiance * weight * transmittance_towards(v, wi, kFarAway, slot);
    if (is_finite(ray.contribution) && max_component(ray.contribution) <= 0.0) continue;
    if (COVERS && wave.bounce == 0u) note_unblocked(slot, ray.contribution, is_caught(slot));
    ray.slot = slot;
    ray.light = kNone;
    ray.origin = offset_ray_origin(v.surface.position, v.surface.position_error, v.surface.geometric_normal, wi);
    ray.direction = wi;
    ray.t_max = t_max_of(v, wi, true, slot);
    uint queue_ = kLightSamples - 1u + i;
    store_shadow_ray(queue_ * frame.slot_count + atomicAdd(queues.shadow_count[queue_], 1u), ray);
  }
}

// True if a wall of ior 1 lets shadow rays through, as in kernels/light/shadow.glsl.
bool may_be_pane; // of the triangle being shaded; set only if there are walls
bool lets_shadow_rays_pass(Vertex v) {
  if (!uses_walls() || !may_be_pane || !is_unbending_wall(v.bsdf)) return false;
  return max_component(pane_transmittance(v.bsdf, dot(v.wo, v.normal))) > 0.0;
}

// Scatters the path. Returns true if it continues with `ray`. `receives`: the vertex receives the light that neighbours
// find. `passed`: set if the path goes straight through a pane, as shadow rays do.
bool scatter(Vertex v, Lobes lobes, Sampler path_sampler, uint dimension, uint slot, bool receives,
             inout PathState path, out Ray ray, out bool passed) {
  passed = false;
  vec2 u = sample_2d(path_sampler, dimension + kDimensionDirection);
  vec2 u_choice = sample_2d(path_sampler, dimension + kDimensionChoice);
  BsdfSample s;
  vec3 wi;
  float bsdf_pdf;
  if (!guided_sample(v, lobes, guide, u_choice.x, u, s, wi, bsdf_pdf)) return false;
  bool is_straight = is_pane(v.bsdf) || (v.material.ior == 1.0 && lets_shadow_rays_pass(v));
  passed = uses(kFeaturePanes) && is_straight && s.pdf < 0.0 && s.transmitted;
  if (passed) wi = -v.wo;
  if (!sides_agree(v, s, wi)) return false;
  if (COVERS && !(s.pdf < 0.0 && s.transmitted)) leave_straight(slot);
  if (COVERS && wave.bounce > 0u && !passed) leave_catcher(slot);
  if (receives) scatter_receiver(v, lobes, s, wi, slot);

  path.throughput *= s.weight;
  // Light behind a pane is found by the shadow rays of the vertex before as well. So the direction keeps its density.
  if (!passed) path.bsdf_pdf = s.pdf;
  if (!passed && TAKES_MORE_LIGHT_SAMPLES) path.bsdf_pdf /= float(light_sample_count());
  path.eta_scale *= s.eta_scale;
  // Roulette uses the throughput that the BSDF alone would give, since a path guided towards light has a low one.
  if (has(kFeatureGuide)) path.eta_scale *= s.pdf < 0.0 ? 1.0 - guide.probability : s.pdf / max(bsdf_pdf, 1e-6 * s.pdf);
  // Russian roulette from the third bounce on, by the square root of the light that the path can still carry. pbrt-v4
  // (section 13.2.1) uses the plain value, from the second bounce on, which ends expensive paths that would still bring
  // light. Relative to that, time times relMSE is 0.82x on a Cornell box, 0.74x on Sponza, 0.2x on DamagedHelmet under
  // a studio environment (llvmpipe). Paths survive 1.25x as often, and 2x as often where they are guided
  // (benchmarks/results/NOTES.md).
  float survival = (has(kFeatureGuide) ? 2.0 : 1.25) * sqrt(max_component(path.throughput) * abs(path.eta_scale));
  if (survival < 1.0 && wave.bounce > 1u && !has(kFeatureTraining)) {
    if (!(u_choice.y < survival)) return false;
    path.throughput /= survival;
  }
  if (!(max_component(path.throughput) > 0.0)) return false;
  if (has(kFeatureTraining))
    note_scattering(wave.first_pixel + slot, wave.bounce, guide, v.surface.position, wi, s.pdf, bsdf_pdf,
                    path.throughput);

  if (has(kFeatureVolume) && s.transmitted && !v.bsdf.thin) cross_surface(v, slot);
  ray = Ray(offset_ray_origin(v.surface.position, v.surface.position_error, v.surface.geometric_normal, wi), slot, wi,
            kFar);
  return true;
}

// Follows the path of one ray to its next vertex. Sets wants_ray and wants_shadow if `next` and `shadow` are to be
// traced.
void follow(Ray ray, Hit hit, inout PathState path, out bool wants_ray, out Ray next, out bool wants_shadow,
            out ShadowRay shadow) {
  wants_ray = wants_shadow = false;
  uint slot = ray.slot;
  choose_channel(slot);
  bool scatters = is_in_scattering_medium(slot);

  // A ray that left the scene.
  if (kSort == kSortNone && hit.triangle == kNone) {
    escape(ray, path);
    return;
  }

  Surface surface = fetch_surface(hit);
  Material material = fetch_material(surface.material);
  vec3 offset = surface.position - ray.origin;
  meet_lamps(ray, length(offset), path);
  // Scattering or absorption on the way to the surface.
  if (scatters) {
    if (scatter_in_medium(ray, length(offset), path, next)) {
      end_behind(slot, path.throughput);
      if (COVERS) leave_straight(slot), leave_catcher(slot);
      if (has(kFeatureTraining)) note_unguided(wave.first_pixel + slot, wave.bounce);
      wants_ray = wave.bounce < frame.max_depth;
      if (wants_ray) wants_shadow = light_in_medium(ray, next, medium_anisotropy(slot), path, shadow);
      wants_ray = wants_ray && survives_medium(fetch_sampler(slot), path);
      return;
    }
  } else if (has(kFeatureVolume)) {
    path.throughput *= medium_transmittance(current_body(slot), length(offset));
  }
  // The vertex; straight on if another body hides the surface.
  if (wave.bounce == 0u) open_cone(hit, offset);
  Vertex v = make_vertex(surface, material, ray.direction);
  if (uses_walls())
    may_be_pane = (floatBitsToUint(texelFetch(triangles, int(hit.triangle * kTriangleTexels)).w) & kTrianglePane) != 0u;
  if (is_hidden(v, slot)) {
    cross_surface(v, slot);
    if (has(kFeatureTraining)) note_unguided(wave.first_pixel + slot, wave.bounce);
    if (!lets_shadow_rays_pass(v)) { // shadow rays do not get here
      path.bsdf_pdf = -1.0;
      if (COVERS) leave_catcher(slot);
    }
    next = Ray(offset_ray_origin(surface.position, surface.position_error, surface.geometric_normal, ray.direction),
               slot, ray.direction, kFar);
    wants_ray = wave.bounce < frame.max_depth;
    return;
  }
  // Emission, weighted against next-event estimation.
  if (has(kFeatureAovs) && wave.bounce == 0u) record_first_hit(slot, hit, v, surface.position, ray.origin);
  if (has_lobe(kFeatureAovsThrough) && (wave.bounce == 0u || shows_behind(slot)))
    record_behind(slot, path.throughput * v.bsdf.base_color, v.normal,
                  !bsdf_has_smooth(v.bsdf) && (material.flags & kMaterialUnlit) == 0u);
  disperse(v, path);
  bool caught = COVERS && wave.bounce == 0u && catch_path(slot, v.surface.material);

  if (has(kFeatureEmission) && (material.flags & kMaterialUnlit) != 0u) {
    // KHR_materials_unlit: the surface shows its base colour; it is never sampled as a light.
    vec3 light = path.throughput * v.bsdf.base_color;
    if (COVERS && caught && note_light(slot, light)) return;
    add_radiance(path, slot, light);
    if (HAS_LIGHT_GROUPS) add_to_group(group_of_surface(hit, surface.material), slot, light);
    return;
  }
  vec3 emitted = surface_emission(surface, material, v.front);
  close_cone();
  if (max_component(emitted) > 0.0) {
    float pdf_area = light_pdf_area(surface, hit);
    bool weighs = wants_light_weight(path) && pdf_area > 0.0;
    if (weighs && uses(kFeaturePanes)) offset = surface.position - fetch_receiver(slot).position;
    float light_pdf = solid_angle_pdf(pdf_area, offset, surface.geometric_normal);
    if (weighs && light_pdf > 0.0) light_pdf *= local_light_ratio(fetch_receiver(slot), light_at(surface, hit));
    vec3 light = path.throughput * emitted * emission_weight(path.bsdf_pdf, light_pdf);
    if (!(COVERS && caught && note_light(slot, light))) {
      add_radiance(path, slot, light);
      if (HAS_LIGHT_GROUPS) add_to_group(group_of_surface(hit, surface.material), slot, light);
    }
  }

  // Light samples, directions to the sky, and the next ray.
  vec3 wo = to_local(v, v.wo);
  if (wave.bounce < frame.max_depth && wo.z > 0.0) {
    Lobes lobes = lobes_of(v.bsdf, wo);
    bool receives = REUSES_PATHS && wave.bounce == 0u && begin_receiver(v, lobes, slot);
    if (REUSES_PATHS && wave.bounce == 1u) sends = share_sender(v, surface, hit, slot, lobes, path);
    sender = slot;
    if (has(kFeatureGuide))
      guide = bsdf_has_smooth(v.bsdf) ? find_guide(lobes, v.bsdf.alpha, v.surface.position) : no_guide();
    Sampler path_sampler = fetch_sampler(slot);
    uint dimension = bounce_dimension(wave.bounce);
    bool connects = kDirect != kDirectBsdf && frame.light_count > 0u && bsdf_has_smooth(v.bsdf), passed;
    bool looks_for_sky = SAMPLES_SKY && bsdf_has_smooth(v.bsdf);
    uvec4 earlier = uvec4(0u);
    if (uses(kFeaturePanes) && keeps_receivers()) earlier = texelFetch(receiver_texels, int(receiver_index(slot)));
    Receiver receiver = Receiver(vec3(0.0), vec3(0.0));
    if (connects || looks_for_sky) {
      receiver = store_receiver(slot, v);
      store_bodies_around(v, slot);
    }
    if (connects) {
      // A single light sample is appended to its queue together with the path's own ray: 108 registers instead of 120
      // with AMD's compiler.
      if (TAKES_MORE_LIGHT_SAMPLES)
        connect_to_lights(v, lobes, receiver, path_sampler, dimension, slot, path.throughput);
      else
        wants_shadow = connect_to_light(v, lobes, receiver, path_sampler, dimension, slot, path.throughput, 0u, shadow);
    }
    if (looks_for_sky) connect_to_sky(v, lobes, receiver, path_sampler, slot, path.throughput);
    wants_ray = scatter(v, lobes, path_sampler, dimension, slot, receives, path, next, passed);
    if (COVERS && wave.bounce == 0u && wants_ray && !is_in_scattering_medium(slot)) {
      PathState ahead = path;
      if (has(kFeatureVolume)) ahead.throughput *= medium_transmittance(current_body(slot), kFarAway);
      note_sky_ahead(slot, environment_found(slot, ahead, next.direction, 0u, true, receiver));
    }
    // A pane with a diffuse lobe receives light, too. But light straight ahead comes from the vertex before it, so that
    // vertex is stored again. (Training counts the pane's own shadow ray for that vertex: probabilities become less
    // suitable, never wrong.) Where no weight will be asked for, as behind the camera or a mirror, nothing was stored
    // before. The words there are those of another path, and training from them would differ from run to run.
    if (passed && (connects || looks_for_sky) && keeps_receivers() && wants_light_weight(path))
      receiver_words[receiver_index(slot)] = earlier;
  }
}

// Follows the ray at this index in the queue. The path ends if it is no longer finite.
void shade(uint index, out bool wants_ray, out Ray next, out bool wants_shadow, out ShadowRay shadow) {
  wants_ray = wants_shadow = false;
  Ray ray = fetch_ray((wave.bounce & 1u) * frame.slot_count + index);
  if (HAS_VOXELS && fetch_hit(index).triangle == kScattered) return; // collide has done it
  PathState path = fetch_path(ray.slot);
  if (!is_finite(path.radiance)) return; // another kernel has counted it
  if (kMoves) open_shutter(fetch_sampler(ray.slot));
  if (has(kFeatureTraining)) note_arrival(wave.first_pixel + ray.slot, wave.bounce, path.radiance);
  follow(ray, fetch_hit(index), path, wants_ray, next, wants_shadow, shadow);
  if (has(kFeatureTraining) && !wants_ray) note_end(wave.first_pixel + ray.slot, wave.bounce);
  if (!is_sound(path) || (wants_ray && !is_sound(next))) {
    path.radiance = poisoned(path.radiance);
    count_nonfinite(kMakerShade, ray.slot);
    wants_ray = wants_shadow = false; // connect finds out for its other light samples
  }
  store_path(ray.slot, path);
}

void main() {
  uint index = queue_item();
  bool wants_ray = false, wants_shadow = false;
  Ray next;
  ShadowRay shadow;
  if (index < (kSort != kSortNone ? queues.hit_count : queues.ray_count[wave.bounce & 1u]))
    shade(kSort != kSortNone ? texelFetch(sorted_ray_texels, int(index)).x : index, wants_ray, next, wants_shadow,
          shadow);

  uint append_index;
  if (REUSES_PATHS && wave.bounce == 1u) {
    APPEND(queues.sender_count, sends, append_index);
    if (sends) list_sender(append_index, sender);
  }
  uint next_queue = (wave.bounce + 1u) & 1u;
  APPEND(queues.ray_count[next_queue], wants_ray, append_index);
  if (wants_ray) store_ray(next_queue * frame.slot_count + append_index, next);
  if (TAKES_MORE_LIGHT_SAMPLES) return; // their shadow rays are there
  APPEND(queues.shadow_count[0], wants_shadow, append_index);
  if (wants_shadow) store_shadow_ray(append_index, shadow);
}
