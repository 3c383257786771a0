// Traces the shadow rays for any hit: a path gains the light's contribution unless its ray is blocked.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_LIGHTS
#define BIND_LIGHT_TREE
#define BIND_RECEIVERS
#define BIND_LIGHT_SUMS
#define BIND_PATHS
#define BIND_SHADOW_RAYS
#define BIND_QUEUES
#define BIND_COUNTERS
#include "kernels/path/bindings.glsl"
#include "kernels/dimensions.glsl"
#include "kernels/light_selection.glsl"
#include "kernels/path/nonfinite.glsl"
#include "kernels/path/records.glsl"
#include "kernels/path/sky.glsl"
#include "kernels/pixel.glsl"
#include "kernels/records.glsl"

Sampler path_sampler;
#define SHADOW_PASSES_PANES
#include "kernels/shadow.glsl"

#define ALPHA_TEST(hit) lets_light_through(hit)
#define ANY_HIT
#include "kernels/trace.glsl"

layout(local_size_x = kWorkgroupSize) in;

// Adds to a sum of 64 bits in two words.
void add_to_sum(uint first, uint value) {
  uint before = atomicAdd(light_sums[first], value);
  if (before + value < before) atomicAdd(light_sums[first + 1u], 1u);
}

// For the learned selection: what the light would bring to the cell of the vertex, and what of it arrives; in the first
// word of the tree's column how often lights were picked there.
void tally(ShadowRay ray, bool blocked) {
  Receiver receiver = unpack_receiver(texelFetch(receiver_texels, int(ray.slot)));
  uint column = ray.light >= placed_lights() ? kEnvironmentColumn : kDirectionalColumn;
  if (ray.light < frame.local_light_count) column = light_trail_column(ray.light).y;
  float brought = luminance(ray.contribution) * frame.light_sum_scale;
  uint value = brought > 0.0 ? uint(min(brought, 1e9)) : 0u; // NaN: nothing
  uint row = light_row(receiver);
  for (int level = 1; level <= int(kLightCellLevels); ++level) {
    uint first = 4u * (row * kLightColumns + column), whole = 4u * (row * kLightColumns + kTreeColumn);
    add_to_sum(first, value);
    if (!blocked) add_to_sum(first + 2u, value);
    atomicAdd(light_sums[whole], 1u);
    row = light_row(receiver, level);
    if (level < int(kLightCellLevels)) atomicMax(light_sums[whole + 1u], row + 1u);
  }
}

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= queues.shadow_count) return;
  ShadowRay ray = fetch_shadow_ray((kLightSamples > 1u || SHARES_SKY ? queues.first_shadow : 0u) + index);
  if (has(kFeaturePanes) && has(kFeatureAlpha)) path_sampler = slot_sampler(ray.slot);
  if (kMoves) open_shutter(slot_sampler(ray.slot));
  begin_shadow(ray.direction);
  uint target = kNone, target_instance = 0u;
  bool to_sky = SHARES_SKY && ray.light == kNone;
  if (has(kFeatureTriangleLights) && !to_sky) {
    Light light = fetch_light(ray.light);
    target = light.kind == kLightTriangle ? light.triangle_id : kNone;
    target_instance = light.instance;
  }
  bool blocked = trace(ray.origin, ray.direction, ray.t_max, target, target_instance).triangle != kNone;
  if (has(kFeatureLearning) && !to_sky) tally(ray, blocked);
  if (blocked) return;
  // One shadow ray a path in this queue: no other lane writes this slot.
  PathState path = fetch_path(ray.slot);
  if (!is_finite(path.radiance)) return; // another kernel has counted it
  vec3 contribution = ray.contribution * light_passed();
  path.radiance += contribution;
  if (!is_finite(path.radiance)) count_nonfinite(kMakerConnect, ray.slot);
  store_radiance(ray.slot, path);
  bool is_direct = wave.bounce == 0u && pane_count == 0u; // a pane is a bounce
  if (has(kFeatureAovs) && is_direct) path_aovs[ray.slot].direct += contribution;
}
