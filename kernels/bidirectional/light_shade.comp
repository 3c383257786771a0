// Shades the hits of light paths: stores their vertices, connects them to the camera, and sends the light on.
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
#define BIND_QUEUES
#define BIND_COUNTERS
#define BIND_PATH_WEIGHTS
#define BIND_LIGHT_VERTICES
#define BIND_CONNECTIONS
#define BIND_GROUPS
#include "kernels/bidirectional/bindings.glsl"
#include "kernels/bidirectional/light_step.glsl"
#include "kernels/bidirectional/projection.glsl"
#include "kernels/bidirectional/receiver.glsl"
#include "kernels/path/light_groups.glsl"
#include "kernels/path/nonfinite.glsl"
#include "kernels/path/queue.glsl"

layout(local_size_x = kWorkgroupSize) in;

// Connects the vertex to the camera: true if there is a ray worth tracing. `light`: as LightVertex has it.
bool connect_to_camera(Vertex v, Hit hit, uint slot, vec2 u, vec3 lens, vec3 light, PathWeights weights,
                       out Connection c) {
  vec2 position;
  vec3 origin, to_point;
  uvec2 pixel;
  // Of a stereo pair, one eye by chance: each has half of the light paths.
  uint eye = 0u;
  if (uses_camera_model() && frame.eyes != kEyesOne) {
    eye = u.x < 0.5 ? 0u : 1u;
    u.x = 2.0 * u.x - float(eye);
  }
  if (!project(v.surface.position, lens, eye, position, origin, to_point)) return false;
  float filter_weight = pick_pixel(position, eye, u, pixel);
  if (uses_camera_model() && frame.eyes != kEyesOne) filter_weight *= 2.0;
  if (!(filter_weight > 0.0)) return false;

  float cosine = surface_cosine(v, to_point);
  Vertex seen = seen_from(v, -to_point);
  if (CULLS_BACKS && !seen.front && is_single_sided(hit)) return false; // the camera looks through this side
  float forward, reverse;
  vec3 value = scatter_value(seen, v.wo, forward, reverse);
  if (!(max_component(value) > 0.0)) return false;
  float camera_pdf = camera_pdf_area(v.surface.position - origin, cosine);
  // a connection to the light itself, which PathWeights::connect describes
  bool connects = wave.bounce == 1u || uses_technique(kTechniqueConnect);
  float weight = 1.0 / (1.0 + nearer(weights, camera_pdf / bidirectional.light_paths, forward, connects));
  c.contribution = light * value * (camera_pdf * filter_weight * weight);
  if (has(kFeatureVolume)) c.contribution *= medium_transmittance(body_at_eye(), length(v.surface.position - origin));
  if (MOVES_FAST) c.contribution = doppler_shifted(c.contribution, doppler_factor(to_point));
  if (is_finite(c.contribution) && !(max_component(c.contribution) > 0.0)) return false;

  c.origin = origin;
  c.slot = slot;
  c.in_body = HAS_VOXELS && has(kFeatureVolume) && body_at_eye() != kNone ? 1u : 0u;
  c.direction =
      offset_ray_origin(v.surface.position, v.surface.position_error, v.surface.geometric_normal, -to_point) - origin;
  c.triangle = hit.triangle;
  c.instance = hit.instance;
  c.pixel = tile_order_of(pixel, frame.width, frame.height);
  c.group = HAS_LIGHT_GROUPS ? path_group(slot) : 0u;
  return true;
}

// Sends the light on: true if it goes on with `ray`.
bool scatter(Vertex v, Sampler path_sampler, uint dimension, uint slot, inout PathState path, inout PathWeights weights,
             out Ray ray) {
  vec2 u = sample_2d(path_sampler, dimension + kDimensionDirection);
  vec2 u_choice = sample_2d(path_sampler, dimension + kDimensionChoice);
  vec3 local = to_local(v, v.wo);
  BsdfSample s;
  vec3 w;
  if (!vertex_sample(v, u_choice.x, u, s, w)) return false;
  Vertex seen = seen_from(v, w);
  float out_cosine = surface_cosine(v, w), in_cosine = surface_cosine(v, v.wo);
  if (!(out_cosine > 0.0) || !sides_agree(seen, s, v.wo)) return false;

  if (s.pdf < 0.0) {
    if (!light_passes_delta(v, local, s, w, path, weights)) return false;
  } else {
    float forward;
    vec3 value = vertex_eval(seen, v.wo, forward);
    path.throughput *= value * (out_cosine / (in_cosine * s.pdf));
    weights = scattered(weights, out_cosine, s.pdf, forward, wave.bounce == 1u || uses_technique(kTechniqueConnect));
  }
  return light_departs(v, s.transmitted, w, u_choice.y, slot, path, ray);
}

// Follows a light path to its next vertex. Returns which of the two rays it wants traced.
void follow(Ray ray, Hit hit, inout PathState path, out bool wants_ray, out Ray next, out bool wants_splat,
            out Connection splat) {
  wants_ray = wants_splat = false;
  Vertex v;
  float cosine;
  PathWeights weights;
  if (!light_arrives(ray, hit, path, v, cosine, weights)) return;
  uint outside = outside_body(v, ray.slot);
  if (is_hidden(v, ray.slot)) {
    wants_ray = wave.bounce < frame.max_depth && light_passes_hidden(ray, v, cosine, path, weights, next);
    store_weights(ray.slot, weights);
    return;
  }
  if (wave.bounce == 1u && has_lobe(kFeatureSoftLamps) && path.bsdf_pdf != 0.0) {
    Light light = fetch_light(texelFetch(receiver_texels, int(ray.slot)).x);
    vec3 offset = v.surface.position - ray.origin;
    if (is_soft(light)) weights.connect *= square(start_ratio(light, v.surface.position, dot(offset, offset)));
    weights = bounded(weights);
  }
  if (wave.bounce == 1u && uses_light_tree() && bsdf_has_smooth(v.bsdf)) { // a camera path would choose the light by
                                                                           // this vertex
    uint light = texelFetch(receiver_texels, int(ray.slot)).x;
    weights = bounded(PathWeights(weights.connect * square(light_ratio(receiver_at(v), light)), weights.others));
  }

  Sampler path_sampler = light_sampler(ray.slot);
  uint dimension = bounce_dimension(wave.bounce);
  if (bsdf_has_smooth(v.bsdf)) {
    vec3 light = path.radiance * path.throughput / cosine;
    if (uses_technique(kTechniqueSplat)) {
      vec3 lens = vec3(0.0);
      if (kLens != kLensPinhole) lens = sample_lens(sample_2d(path_sampler, kDimensionLens + wave.bounce));
      vec2 u = sample_2d(path_sampler, dimension + kDimensionLight);
      wants_splat = connect_to_camera(v, hit, ray.slot, u, lens, light, weights, splat);
    }
    if (wave.bounce < frame.max_depth && uses_technique(kTechniqueConnect)) {
      uint vertex_index = light_counts[ray.slot]++;
      store_light_vertex(light_vertex_index(ray.slot, vertex_index),
                         LightVertex(v.wo, wave.bounce, light, weights.connect, hit.triangle, hit.instance, hit.b1,
                                     hit.b2, weights.others, outside,
                                     HAS_LIGHT_GROUPS ? path_group(ray.slot) : 0u, 0u));
    }
  }
  if (wave.bounce < frame.max_depth) {
    wants_ray = scatter(v, path_sampler, dimension, ray.slot, path, weights, next);
    store_weights(ray.slot, weights);
  }
}

void shade(uint index, out bool wants_ray, out Ray next, out bool wants_splat, out Connection splat) {
  Ray ray = fetch_ray((wave.bounce & 1u) * frame.slot_count + index);
  PathState path = fetch_path(ray.slot);
  follow(ray, fetch_hit(index), path, wants_ray, next, wants_splat, splat);
  bool sound = is_finite(path.throughput) && (!wants_ray || (is_finite(next.origin) && is_finite(next.direction))) &&
               (!wants_splat || is_finite(splat.contribution));
  if (!sound) {
    count_nonfinite(kMakerShade, ray.slot);
    wants_ray = wants_splat = false;
  }
  store_path(ray.slot, path);
}

void main() {
  uint index = gl_GlobalInvocationID.x;
  bool wants_ray = false, wants_splat = false;
  Ray next;
  Connection splat;
  if (index < queues.ray_count[wave.bounce & 1u]) shade(index, wants_ray, next, wants_splat, splat);

  uint next_queue = (wave.bounce + 1u) & 1u;
  uint append_index;
  APPEND(queues.ray_count[next_queue], wants_ray, append_index);
  if (wants_ray) store_ray(next_queue * frame.slot_count + append_index, next);
  APPEND(connections.count, wants_splat, append_index);
  if (wants_splat) store_connection(append_index, splat);
}
