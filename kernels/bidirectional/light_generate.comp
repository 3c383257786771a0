// Starts a light path for every (pixel, sample) of a wave.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_LIGHTS
#define BIND_ENVIRONMENT
#define BIND_PATHS
#define BIND_RECEIVERS
#define BIND_RAYS
#define BIND_QUEUES
#define BIND_PATH_WEIGHTS
#define BIND_LIGHT_VERTICES
#define BIND_GROUPS
#include "kernels/bidirectional/bindings.glsl"
#include "kernels/bidirectional/light_path.glsl"
#include "kernels/bidirectional/records.glsl"
#include "kernels/path/bodies.glsl"
#include "kernels/path/light_groups.glsl"
#include "kernels/path/records.glsl"

layout(local_size_x = kWorkgroupSize) in;

// Light paths count their surfaces from 1, so that their rays begin in the second queue. In a light path's state,
// `radiance` is what it began with, `throughput` what is left of it, a `bsdf_pdf` of 0 says that its ray comes from
// infinity, a negative one is that of a light with a range, negated inverse, and a negative `eta_scale` that its latest
// ray has met an unlit surface.
void main() {
  uint slot = gl_GlobalInvocationID.x;
  if (slot == 0u) queues.ray_count[1] = wave.pixel_count * wave.sample_count;
  if (slot >= wave.pixel_count * wave.sample_count) return;
  LightStart start;
  bool shines = start_light_path(light_sampler(slot), start);
  bool sound = is_finite(start.origin) && is_finite(start.direction) && is_finite(start.light);
  float t_max = shines && sound ? kFar : 0.0; // t_max 0 meets nothing
  store_ray(frame.slot_count + slot, Ray(start.origin, slot, start.direction, t_max));
  store_path(slot, PathState(vec3(1.0),
                             start.distant               ? 0.0
                             : start.inverse_range > 0.0 ? -start.inverse_range
                                                         : 1.0,
                             start.light, 1.0));
  store_weights(slot, start.weights);
  light_counts[slot] = 0u;
  if (HAS_LIGHT_GROUPS) store_path_group(slot, shines ? group_of_light(start.index) : 0u);
  if (uses(kFeatureLightTree) || has_lobe(kFeatureSoftLamps)) receiver_words[slot] = uvec4(start.index, 0u, 0u, 0u);
  begin_outside(slot); // light_extend finds the bodies that hold the lamp
}
