// Shades the hits of camera paths: light met by chance, one ray to a light, one to a vertex of the slot's light path,
// and the next ray of the path, each weighted against all other ways to find the same light.
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
#define BIND_SHADOW_RAYS
#define BIND_QUEUES
#define BIND_COUNTERS
#define BIND_PATH_WEIGHTS
#define BIND_LIGHT_VERTICES
#define BIND_CONNECTIONS
#define BIND_MERGE_WEIGHTS
#define BIND_GROUPS
#include "kernels/bidirectional/bindings.glsl"
#include "kernels/bidirectional/found_light.glsl"
#include "kernels/bidirectional/light_path.glsl"
#include "kernels/bidirectional/merging.glsl"
#include "kernels/bidirectional/receiver.glsl"
#include "kernels/bidirectional/records.glsl"
#include "kernels/bidirectional/scattering.glsl"
#include "kernels/path/cover.glsl"
#include "kernels/path/crossing.glsl"
#include "kernels/path/first_hit.glsl"
#include "kernels/path/light_groups.glsl"
#include "kernels/path/nonfinite.glsl"
#include "kernels/path/queue.glsl"
#include "kernels/path/records.glsl"

layout(local_size_x = kWorkgroupSize) in;

// True if the latest vertex of the camera path can be connected to the one before it, which is the camera or a surface.
bool connects_behind() { return uses_technique(wave.bounce == 0u ? kTechniqueSplat : kTechniqueConnect); }

// The body that a segment which leaves v towards `wi` runs in; kNone: the open.
uint body_towards(Vertex v, vec3 wi, uint slot) {
  if (!has(kFeatureVolume)) return kNone;
  bool crossing = is_below(v, wi) && !v.bsdf.thin;
  return crossing ? body_behind(v, slot) : current_body(slot);
}

// Transmittance of that body.
vec3 transmittance(Vertex v, vec3 wi, uint slot, float distance_) {
  return has(kFeatureVolume) ? medium_transmittance(body_towards(v, wi, slot), distance_) : vec3(1.0);
}

// Next-event estimation: true if there is a shadow ray worth tracing.
bool connect_to_light(Vertex v, Sampler path_sampler, uint dimension, uint slot, vec3 throughput, PathWeights weights,
                      out ShadowRay ray) {
  float ratio; // light paths begin by power
  LightSample light = sample_light(receiver_at(v), sample_bits(path_sampler, dimension + kDimensionLight), ratio);
  if (max_component(light.radiance) <= 0.0 || !(light.pdf > 0.0)) return false;
  float forward, reverse;
  vec3 value = scatter_value(v, light.direction, forward, reverse);
  if (!(max_component(value) > 0.0)) return false;
  float found = start_pdf_area(light, v.surface.position, surface_cosine(v, light.direction)) / ratio;
  float by_chance = light.delta || !uses_technique(kTechniqueHit) ? 0.0 : square(forward / light.pdf);
  float weight = 1.0 / (1.0 + by_chance + nearer(weights, found, reverse, connects_behind()));
  ray.contribution = throughput * value * light.radiance * (weight / light.pdf);
  ray.contribution *=
      transmittance(v, light.direction, slot, light.distant ? kFarAway : length(light.target - v.surface.position));
  if (is_finite(ray.contribution) && max_component(ray.contribution) <= 0.0) return false;

  ray.slot = slot;
  ray.light = light.light;
  ray.origin =
      offset_ray_origin(v.surface.position, v.surface.position_error, v.surface.geometric_normal, light.direction);
  ray.direction = light.distant ? light.direction : light.target - ray.origin;
  ray.t_max = light.distant ? kFar : 1.0;
  if (HAS_VOXELS && body_towards(v, light.direction, slot) != kNone) ray.t_max = behind_t_max(ray.t_max);
  return true;
}

// Light that a light vertex gives the path through v unless something is between; and its position.
vec3 connect_to_vertex(Vertex v, LightVertex at, uint slot, PathWeights weights, out Surface target) {
  target = fetch_surface(Hit(at.triangle, at.instance, at.b1, at.b2));
  vec3 offset = target.position - v.surface.position;
  float distance_squared = dot(offset, offset);
  if (!(distance_squared > 0.0)) return vec3(0.0);
  vec3 wi = offset / sqrt(distance_squared);
  float forward, reverse;
  vec3 value = scatter_value(v, wi, forward, reverse);
  if (!(max_component(value) > 0.0)) return vec3(0.0);
  Vertex light_end = make_vertex(target, fetch_material(target.material), wi); // seen from v
  set_outside(light_end, at.outside);
  float light_forward, light_reverse;
  vec3 light_value = scatter_value(light_end, at.direction, light_forward, light_reverse);
  float cosine = surface_cosine(v, wi), light_cosine = surface_cosine(light_end, wi);
  float others =
      nearer(weights, light_reverse * cosine / distance_squared, reverse, connects_behind()) +
      nearer(PathWeights(at.connect, at.others), forward * light_cosine / distance_squared, light_forward, true);
  return value * light_value * at.light * transmittance(v, wi, slot, sqrt(distance_squared)) *
         (light_cosine / (distance_squared * (1.0 + others)));
}

// Picks one of the slot's light vertices in proportion to what it would give (Talbot 2005), so that one ray does for
// all: true if there is one worth tracing.
bool connect_to_light_path(Vertex v, uint slot, vec3 throughput, PathWeights weights, out Connection c) {
  uint dimension = bounce_dimension(frame.max_depth + 1u + wave.bounce); // beyond those of the light path itself
  float u = sample_2d(light_sampler(slot), dimension).x;
  float total = 0.0, picked = 0.0;
  Surface target;
  uint count = light_counts[slot];
  for (uint k = 0u; k < count; ++k) {
    LightVertex at = fetch_light_vertex(light_vertex_index(slot, k));
    if (wave.bounce + 1u + at.bounce > frame.max_depth) break;
    Surface candidate;
    vec3 light = connect_to_vertex(v, at, slot, weights, candidate);
    float brightness = luminance(light);
    if (!(brightness > 0.0)) continue;
    total += brightness;
    float probability = brightness / total;
    bool takes = u < probability;
    u = min(takes ? u / probability : (u - probability) / (1.0 - probability), kOneMinusEpsilon);
    if (takes) {
      target = candidate;
      picked = brightness;
      c.contribution = light;
      c.group = HAS_LIGHT_GROUPS ? at.group : 0u;
      c.triangle = at.triangle;
      c.instance = at.instance;
    }
  }
  if (!(total > 0.0)) return false;
  c.contribution *= throughput * (total / picked);
  if (is_finite(c.contribution) && max_component(c.contribution) <= 0.0) return false;
  vec3 to_target = target.position - v.surface.position;
  c.origin = offset_ray_origin(v.surface.position, v.surface.position_error, v.surface.geometric_normal, to_target);
  c.direction =
      offset_ray_origin(target.position, target.position_error, target.geometric_normal, -to_target) - c.origin;
  c.slot = slot;
  c.in_body = HAS_VOXELS && body_towards(v, to_target, slot) != kNone ? 1u : 0u;
  c.pixel = 0u;
  return true;
}

// Scatters the path: true if it goes on with `ray`.
bool scatter(Vertex v, Sampler path_sampler, uint dimension, uint slot, inout PathState path, inout PathWeights weights,
             inout float merge, out Ray ray) {
  vec2 u = sample_2d(path_sampler, dimension + kDimensionDirection);
  vec2 u_choice = sample_2d(path_sampler, dimension + kDimensionChoice);
  vec3 local = to_local(v, v.wo);
  BsdfSample s;
  vec3 wi;
  if (!vertex_sample(v, u_choice.x, u, s, wi)) return false;
  if (!sides_agree(v, s, wi)) return false;
  if (COVERS && !(s.pdf < 0.0 && s.transmitted)) leave_straight(slot);

  float cosine = surface_cosine(v, wi);
  if (s.pdf < 0.0) {
    float ratio = abs(local.z) / (abs(s.wi.z) * s.eta_scale);
    weights = scattered_delta(weights, cosine, ratio);
    merge = merge_scattered_delta(merge, cosine, ratio);
  } else {
    float reverse = reverse_pdf(v, wi);
    weights = scattered(weights, cosine, s.pdf, reverse, connects_behind());
    merge = merge_scattered(merge, cosine, s.pdf, reverse, path.bsdf_pdf < 0.0);
  }
  path.throughput *= s.weight;
  path.bsdf_pdf = s.pdf; // extend asks whether it is that of a delta lobe
  path.eta_scale *= s.eta_scale;
  // A larger one, as in path/shade.comp, gains nothing.
  float survival = sqrt(max_component(path.throughput) * abs(path.eta_scale));
  if (survival < 1.0 && wave.bounce > 1u) {
    if (!(u_choice.y < survival)) return false;
    path.throughput /= survival;
  }
  if (!(max_component(path.throughput) > 0.0)) return false;

  if (has(kFeatureVolume) && s.transmitted && !v.bsdf.thin) cross_surface(v, slot);
  ray = Ray(offset_ray_origin(v.surface.position, v.surface.position_error, v.surface.geometric_normal, wi), slot, wi,
            kFar);
  return true;
}

// Sums of weights on arrival at the surface. A camera path begins with the density of the camera's own rays.
PathWeights arrive(Ray ray, vec3 offset, float cosine) {
  if (wave.bounce == 0u)
    return bounded(PathWeights(square(bidirectional.light_paths / camera_pdf_area(offset, cosine)), 0.0));
  return arrived(fetch_weights(ray.slot), dot(offset, offset), cosine);
}

// Straight on through a surface that another body hides, as through a delta lobe.
bool pass_hidden(Vertex v, Ray ray, vec3 offset, inout PathState path, out Ray next) {
  float cosine = surface_cosine(v, v.wo);
  if (!(cosine > 0.0)) return false;
  store_weights(ray.slot, scattered_delta(arrive(ray, offset, cosine), cosine, 1.0));
  store_merge(ray.slot, merge_scattered_delta(merge_arrived(fetch_merge(ray.slot), cosine), cosine, 1.0));
  path.bsdf_pdf = -1.0;
  cross_surface(v, ray.slot);
  next = Ray(offset_ray_origin(v.surface.position, v.surface.position_error, v.surface.geometric_normal, ray.direction),
             ray.slot, ray.direction, kFar);
  return true;
}

struct Wants {
  bool ray, shadow, connection;
};

// Follows the path of one ray to its next vertex. Returns which rays it wants traced.
void follow(Ray ray, Hit hit, inout PathState path, out Wants wants, out Ray next, out ShadowRay shadow,
            out Connection connection) {
  wants = Wants(false, false, false);
  uint slot = ray.slot;
  bool hits = wave.bounce == 0u || uses_technique(kTechniqueHit);

  // A ray that left the scene.
  if (hit.triangle == kNone) {
    if (hits) meet_lamps(ray, kFar, path);
    if (hits) meet_distant_lamps(ray, path);
    if (has(kFeatureVolume)) path.throughput *= medium_transmittance(current_body(slot), kFarAway);
    if (!hits) {
      if (COVERS) note_escape(slot, path.throughput, vec3(0.0));
      return;
    }
    float pdf;
    vec3 radiance = environment_emission(ray.direction, pdf);
    float merged = merge_met_light(fetch_merge(slot), path.bsdf_pdf);
    PathWeights weights = fetch_weights(slot);
    float connect_pdf = pdf;
    if (was_chosen_there(weights)) connect_pdf *= environment_ratio(fetch_receiver(slot));
    vec3 found = path.throughput * radiance * hit_weight(weights, connect_pdf, pdf * disk_pdf(), merged);
    if (COVERS && note_escape(slot, path.throughput, found)) return;
    add_radiance(path, slot, found);
    if (HAS_LIGHT_GROUPS) add_to_group(group_of_environment(), slot, found);
    return;
  }

  // The vertex; straight on if another body hides the surface.
  Surface surface = fetch_surface(hit);
  Material material = fetch_material(surface.material);
  vec3 offset = surface.position - ray.origin;
  meet_lamps(ray, length(offset), path);
  if (has(kFeatureVolume)) path.throughput *= medium_transmittance(current_body(slot), length(offset));
  Vertex v = make_vertex(surface, material, ray.direction);
  if (is_hidden(v, slot)) {
    wants.ray = wave.bounce < frame.max_depth && pass_hidden(v, ray, offset, path, next);
    return;
  }
  // Emission, weighted against all other techniques.
  if (has(kFeatureAovs) && wave.bounce == 0u) record_first_hit(slot, hit, v, surface.position, ray.origin);

  if (has(kFeatureEmission) && (material.flags & kMaterialUnlit) != 0u) { // as in path/shade.comp: no light
    if (!hits) return;
    vec3 light = path.throughput * v.bsdf.base_color;
    add_radiance(path, slot, light);
    if (HAS_LIGHT_GROUPS) add_to_group(group_of_surface(hit, surface.material), slot, light);
    return;
  }
  float cosine = surface_cosine(v, v.wo);
  if (!(cosine > 0.0)) return;
  PathWeights weights = arrive(ray, offset, cosine);
  float merge = merge_arrived(fetch_merge(slot), cosine);
  vec3 emitted = surface_emission(surface, material, v.front);
  if (hits && max_component(emitted) > 0.0) {
    float pdf = light_pdf_area(surface, hit);
    float merged = merge_met_light(merge, path.bsdf_pdf);
    float connect_pdf = pdf;
    if (was_chosen_there(weights) && pdf > 0.0)
      connect_pdf *= local_light_ratio(fetch_receiver(slot), light_at(surface, hit));
    float weight = hit_weight(weights, connect_pdf, pdf * triangle_direction_pdf(material, cosine), merged);
    vec3 light = path.throughput * emitted * weight;
    add_radiance(path, slot, light);
    if (HAS_LIGHT_GROUPS) add_to_group(group_of_surface(hit, surface.material), slot, light);
  }

  // A path that the volume has scattered is found from this end alone: no other way to find it counts.
  bool is_clouded = HAS_VOXELS && path.eta_scale < 0.0;
  if (is_clouded) weights = PathWeights(0.0, 0.0);

  // Connections to a light and to the light path, and the next ray.
  if (wave.bounce >= frame.max_depth) return;
  Sampler path_sampler = slot_sampler(slot);
  uint dimension = bounce_dimension(wave.bounce);
  if (frame.light_count > 0u && bsdf_has_smooth(v.bsdf)) {
    store_receiver(slot, v);
    if (uses_technique(kTechniqueLight))
      wants.shadow = connect_to_light(v, path_sampler, dimension, slot, path.throughput, weights, shadow);
    if (uses_technique(kTechniqueConnect) && !is_clouded)
      wants.connection = connect_to_light_path(v, slot, path.throughput, weights, connection);
  }
  wants.ray = scatter(v, path_sampler, dimension, slot, path, weights, merge, next);
  store_weights(slot, weights);
  store_merge(slot, merge);
}


// The same for the ray at this index in the queue, whose path ends if it is no longer finite.
void shade(uint index, out Wants wants, out Ray next, out ShadowRay shadow, out Connection connection) {
  wants = Wants(false, false, false);
  Ray ray = fetch_ray((wave.bounce & 1u) * frame.slot_count + index);
  if (HAS_VOXELS && fetch_hit(index).triangle == kScattered) return; // bidirectional_collide has done it
  PathState path = fetch_path(ray.slot);
  if (!is_finite(path.radiance)) return; // another kernel has counted it
  follow(ray, fetch_hit(index), path, wants, next, shadow, connection);
  if (!is_sound(path) || (wants.ray && !is_sound(next))) {
    path.radiance = poisoned(path.radiance);
    count_nonfinite(kMakerShade, ray.slot);
    wants = Wants(false, false, false);
  }
  store_path(ray.slot, path);
}

void main() {
  uint index = gl_GlobalInvocationID.x;
  Wants wants = Wants(false, false, false);
  Ray next;
  ShadowRay shadow;
  Connection connection;
  if (index < queues.ray_count[wave.bounce & 1u]) shade(index, wants, next, shadow, connection);

  uint next_queue = (wave.bounce + 1u) & 1u;
  uint append_index;
  APPEND(queues.ray_count[next_queue], wants.ray, append_index);
  if (wants.ray) store_ray(next_queue * frame.slot_count + append_index, next);
  APPEND(queues.shadow_count[0], wants.shadow, append_index);
  if (wants.shadow) store_shadow_ray(append_index, shadow);
  APPEND(connections.count, wants.connection, append_index);
  if (wants.connection) store_connection(append_index, connection);
}
