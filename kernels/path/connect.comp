// Traces the shadow rays for any hit: a path gains the light's contribution unless its ray is blocked.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_LIGHTS
#define BIND_LIGHT_TREE
#define BIND_ENVIRONMENT
#define BIND_RECEIVERS
#define BIND_LIGHT_SUMS
#define BIND_PATHS
#define BIND_SHADOW_RAYS
#define BIND_QUEUES
#define BIND_COUNTERS
#define BIND_GROUPS
#include "kernels/path/bindings.glsl"
#include "kernels/base/dimensions.glsl"
#include "kernels/light/learned_sky.glsl"
#include "kernels/path/bodies.glsl"
#include "kernels/path/light_groups.glsl"
#include "kernels/path/cover.glsl"
#include "kernels/path/nonfinite.glsl"
#include "kernels/path/queue.glsl"
#include "kernels/path/records.glsl"
#include "kernels/path/sky_density.glsl"
#include "kernels/path/path_sampler.glsl"
#include "kernels/base/records.glsl"
#include "kernels/volume/bindings.glsl"
#include "kernels/volume/transmittance.glsl"

Sampler path_sampler;
#define SHADOW_PASSES_PANES
#include "kernels/light/shadow.glsl"

#define ALPHA_TEST(hit) lets_light_through(hit, t_pending)
#define ANY_HIT
#include "kernels/bvh/trace.glsl"

layout(local_size_x = kWorkgroupSize) in;

// Adds to a 64-bit sum stored in two words.
void add_to_sum(uint first, uint value) {
  uint before = atomicAdd(light_sums[first], value);
  if (before + value < before) atomicAdd(light_sums[first + 1u], 1u);
}

// Training: adds a light's contribution to one of `bins` of the cell of the vertex, unblocked and as it arrives. Cells
// begin at word `first`. Behind the bins come the number of picks and the two wider cells around the cell; the host
// adds up the cells within a wider one (host/integrators/path/cell_histograms.h).
void tally(Receiver receiver, uint first, uint bins, uint bin, uint brought, bool blocked) {
  uint sums = first + 4u * light_cell(receiver) * (bins + 1u), behind = sums + 4u * bins;
  if (brought > 0u) {
    add_to_sum(sums + 4u * bin, brought);
    if (!blocked) add_to_sum(sums + 4u * bin + 2u, brought);
  }
  atomicAdd(light_sums[behind], 1u);
  uint cells_around = light_cell(receiver, 1) * kLightCells + light_cell(receiver, 2) + 1u;
  if (light_sums[behind + 1u] < cells_around) // an outdated value does no harm: the atomic then changes nothing
    atomicMax(light_sums[behind + 1u], cells_around);
}

bool is_to_sky(ShadowRay ray) { return SAMPLES_SKY && ray.light == kNone; }

void tally(ShadowRay ray, bool blocked) {
  Receiver receiver = unpack_receiver(texelFetch(receiver_texels, int(receiver_index(ray.slot))));
  float units = luminance(ray.contribution) * frame.light_sum_scale;
  uint brought = units > 0.0 ? uint(min(units, 1e9)) : 0u; // NaN: nothing
  bool is_environment = ray.light >= placed_lights();
  if (uses_light_cells() && !is_to_sky(ray)) {
    uint bin = is_environment ? kEnvironmentCluster : kDirectionalCluster;
    if (ray.light < frame.local_light_count) bin = light_branches_and_cluster(ray.light).y;
    tally(receiver, 0u, kTreeCluster, bin, brought, blocked);
  }
  if (!uses_learned_sky() || !is_environment) return;
  uvec2 part = sky_part(ray.direction);
  uint first = uses_light_cells() ? 4u * kLightCells * kLightClusters : 0u;
  tally(receiver, first, kSkyParts, kSkySide * part.y + part.x, brought, blocked);
}

vec3 queued_origin, queued_direction;
float queued_t_max;
uint queued_target, queued_target_instance; // triangle and instance of the light
ShadowRay shadow_ray;

// Fraction of the light that passes the volume.
vec3 volume_passed() {
  uint queue_ = queues.first_shadow / frame.slot_count;
  begin_random(fetch_sampler(shadow_ray.slot), wave.bounce, kWalkToLight + queue_);
  bool distant = shadow_ray.t_max == kFar;
  return volume_transmittance(shadow_ray.origin, shadow_ray.direction, shadow_ray.t_max,
                              distant ? 1.0 : length(shadow_ray.direction));
}

void begin_ray(uint index) {
  shadow_ray = fetch_shadow_ray((kLightSamples > 1u || SAMPLES_SKY ? queues.first_shadow : 0u) + index);
  queued_origin = shadow_ray.origin;
  queued_direction = shadow_ray.direction;
  queued_t_max = marks_bodies() ? plain_t_max(shadow_ray.t_max) : shadow_ray.t_max;
  if (has(kFeaturePanes) && has(kFeatureAlpha)) path_sampler = fetch_sampler(shadow_ray.slot);
  if (kMoves) open_shutter(fetch_sampler(shadow_ray.slot));
  begin_shadow(shadow_ray.direction);
  queued_target = kNone;
  queued_target_instance = 0u;
  if (has(kFeatureTriangleLights) && !is_to_sky(shadow_ray)) {
    Light light = fetch_light(shadow_ray.light);
    queued_target = light.kind == kLightTriangle ? light.triangle_id : kNone;
    queued_target_instance = light.instance;
  }
}

void end_ray(uint index, Hit hit) {
  bool blocked = hit.triangle != kNone;
  if (has(kFeatureTraining) && (USES_LEARNED_SKY || !is_to_sky(shadow_ray))) tally(shadow_ray, blocked);
  if (blocked) return;
  // One shadow ray a path in this queue: no other lane writes this slot.
  PathState path = fetch_path(shadow_ray.slot);
  if (!is_finite(path.radiance)) return; // another kernel has counted it
  vec3 contribution = shadow_ray.contribution * light_passed();
  if (has(kFeatureVolume) && uses_walls()) {
    uvec4 bodies = fetch_bodies(shadow_ray.t_max == queued_t_max ? kBodiesHere : kBodiesBehind, shadow_ray.slot);
    bool distant = queued_t_max == kFar;
    float metre = distant ? 1.0 : length(queued_direction);
    contribution *= bodies_passed(bodies, metre, distant ? kFarAway : metre);
  }
  if (HAS_VOXELS && shadow_ray.t_max == queued_t_max) contribution *= volume_passed();
  if (COVERS && wave.bounce == 0u) {
    uint index = kLightSamples > 1u || SAMPLES_SKY ? queues.first_shadow / frame.slot_count : 0u;
    float scale = is_to_sky(shadow_ray) ? 1.0 : path_cover[shadow_ray.slot].light_scale[index];
    if (note_arrived(shadow_ray.slot, contribution, scale)) return;
  }
  path.radiance += contribution;
  if (!is_finite(path.radiance)) count_nonfinite(kMakerConnect, shadow_ray.slot);
  store_radiance(shadow_ray.slot, path);
  if (HAS_LIGHT_GROUPS) add_to_group(group_of_light(shadow_ray.light), shadow_ray.slot, contribution);
  bool is_direct = wave.bounce == 0u && pane_count == 0u; // a pane is a bounce
  if (has(kFeatureAovs) && is_direct) path_aovs[shadow_ray.slot].direct += contribution;
}

#define RAY_COUNT queues.shadow_count[0]
#define NEXT_RAY queues.next_shadow_ray
#define IS_COHERENT false
#include "kernels/path/trace_queue.glsl"
