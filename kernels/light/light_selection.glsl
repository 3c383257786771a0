// Selection of a light for next-event estimation at a receiver: by power, by the light tree, or with probabilities that
// were trained near the receiver. Include bindings.glsl with BIND_LIGHTS and BIND_LIGHT_TREE first.
#ifndef WAVEPATH_LIGHT_SELECTION_GLSL
#define WAVEPATH_LIGHT_SELECTION_GLSL

#include "kernels/base/config.glsl"
#include "kernels/base/intervals.glsl"
#include "kernels/light/light_sampling.glsl"
#include "kernels/light/light_tree.glsl"
#include "kernels/base/sampler.glsl"

bool uses_light_tree() { return has(kFeatureLightTree) && (frame.scene_features & kFeatureLightTree) != 0u; }
bool uses_light_cells() { return has(kFeatureLightCells) && (frame.scene_features & kFeatureLightCells) != 0u; }

// ---- receivers, packed ------------------------------------------------------------------------------------------
// Light samples and BSDF samples must weigh with the density from the same receiver, bit by bit: the one stored with
// the path.

// Bit 0: the normal counts. Then 15 and 16 bits of octahedral coordinates.
uint pack_normal(vec3 normal) {
  vec2 at = normal.xy / (abs(normal.x) + abs(normal.y) + abs(normal.z));
  if (normal.z < 0.0) at = (1.0 - abs(at.yx)) * vec2(at.x < 0.0 ? -1.0 : 1.0, at.y < 0.0 ? -1.0 : 1.0);
  uvec2 steps = uvec2(clamp(at * 0.5 + 0.5, 0.0, 1.0) * vec2(65535.0, 32767.0) + 0.5);
  return steps.x << 16u | steps.y << 1u | 1u;
}

Receiver unpack_receiver(uvec4 words) {
  vec2 at = vec2(float(words.w >> 16u) / 65535.0, float((words.w >> 1u) & 32767u) / 32767.0) * 2.0 - 1.0;
  return Receiver(uintBitsToFloat(words.xyz), (words.w & 1u) != 0u ? octahedral_direction(at) : vec3(0.0));
}

// ---- trained probabilities --------------------------------------------------------------------------------------

// Index of the cell that a receiver is in. Cells are cubes whose sides double with the distance from the eye, so that
// they look alike from there; a cube has a cell for each of the six axes that a surface may face. Indices are hashes.
// Cells of a level above 0 are 4^level times as wide: they train cells that were seldom visited.
//
//     eye .  |_|_|_|_|___|___|___|___|_______|_______|     sides of 1/4 to 1/8 of the distance
uint light_cell(Receiver receiver, int level) {
  vec3 offset = receiver.position - frame.camera_position;
  uint exponent =
      clamp(floatBitsToUint(max_component(abs(offset))) >> 23u, 16u, 240u) - kLightCellShift + 2u * uint(level);
  ivec3 cell = ivec3(floor(offset / uintBitsToFloat(exponent << 23u)));
  vec3 n = receiver.normal, size = abs(n);
  uint axis = size.x >= size.y && size.x >= size.z ? 0u : size.y >= size.z ? 1u : 2u;
  uint facing = n == vec3(0.0) ? 6u : 2u * axis + (n[axis] < 0.0 ? 1u : 0u);
  uvec3 bits = (uvec3(cell) & 0x3ffu) | uvec3(exponent, facing, 0u) << 10u;
  return pcg3d(bits).x & (kLightCells - 1u);
}

uint light_cell(Receiver receiver) { return light_cell(receiver, 0); }

uint current_cell; // the cell that cluster_end() reads
uint cluster_end(uint cluster) { return texelFetch(light_cells, int(current_cell * kLightClusters + cluster)).x; }

float cluster_probability(uint cell, uint cluster) {
  current_cell = cell;
  return float(cluster_end(cluster) - (cluster > 0u ? cluster_end(cluster - 1u) : 0u)) * (1.0 / 4294967296.0);
}

// ---- the light tree's words -------------------------------------------------------------------------------------
// Behind the records: by light its branches and its cluster, two lights a texel; then branches by cluster, four a
// texel.

uvec2 light_branches_and_cluster(uint light) {
  uvec4 words = texelFetch(light_tree, int(kLightRecordTexels * frame.local_light_count + (light >> 1u)));
  return (light & 1u) != 0u ? words.zw : words.xy;
}

uint cluster_branches(uint cluster) {
  uint first = kLightRecordTexels * frame.local_light_count + (frame.local_light_count + 1u >> 1u);
  uvec4 words = texelFetch(light_tree, int(first + (cluster >> 2u)));
  return words[cluster & 3u];
}

// ---- picks ------------------------------------------------------------------------------------------------------

// Probabilities of groups of lights by power, as intervals of the integers. Local lights come first.
uint local_end() { return light_end(frame.local_light_count - 1u); }
uint placed_lights() { return frame.light_count - (frame.environment_probability > 0.0 ? 1u : 0u); }
float fraction_of_integers(uint count) { return float(count) * (1.0 / 4294967296.0); }

// Probability of a local light, to which a walk has led.
float local_probability(Receiver receiver, LightWalk walk, uint cluster) {
  if (!uses_light_cells()) return fraction_of_integers(local_end()) * walk.probability;
  uint cell = light_cell(receiver);
  return cluster_probability(cell, kTreeCluster) * walk.probability +
         cluster_probability(cell, cluster) * walk.below_cluster;
}

uint directional_group() { return light_end(placed_lights() - 1u) - local_end(); }

// A directional light, by power among them.
uint pick_directional(inout uvec2 u, out float group_probability) {
  uint count = placed_lights(), group = local_end(), size = directional_group(), offset, rest;
  umulExtended(u.x, size, offset, rest);
  uint index, begin, end, pick = group + offset;
  PICK_INTERVAL(pick, count, light_end, index, begin, end)
  group_probability = fraction_of_integers(size);
  return index;
}

// A light for the receiver, and how many times more probable it is than by power. u.x becomes what is left of it.
// kNone: the pick fell to lights that cannot contribute.
uint pick_light_for(Receiver receiver, inout uvec2 u, out float ratio) {
  ratio = 1.0;
  if (!uses_light_tree()) return pick_light(u);
  uint pick = min(u.x, kLargestPick), cluster = kTreeCluster, begin = 0u, end = local_end();
  if (uses_light_cells()) {
    current_cell = light_cell(receiver);
    PICK_INTERVAL(pick, kLightClusters, cluster_end, cluster, begin, end)
    u.x = stretch(pick - begin, end - begin);
    if (cluster == kEnvironmentCluster || cluster == kDirectionalCluster) {
      float group_probability = frame.environment_probability;
      uint light = cluster == kEnvironmentCluster ? placed_lights() : pick_directional(u, group_probability);
      ratio = cluster_probability(current_cell, cluster) / group_probability;
      return light;
    }
  } else {
    if (pick >= end) return pick_light(u);
    u.x = stretch(pick, end);
  }
  Draw draw = make_draw(u.x);
  uint branches = cluster == kTreeCluster ? 0u : cluster_branches(cluster);
  LightWalk walk = walk_lights(receiver, branches, cluster == kTreeCluster, true, draw);
  u.x = stretch(draw.value, draw.range);
  if (walk.light == kNone) return kNone;
  ratio =
      local_probability(receiver, walk, light_branches_and_cluster(walk.light).y) / fetch_light(walk.light).probability;
  return walk.light;
}

// The ratio of probabilities for a local light, for the environment, and for any light.
float local_light_ratio(Receiver receiver, uint light) {
  if (!uses_light_tree()) return 1.0;
  uvec2 branches_and_cluster = light_branches_and_cluster(light);
  LightWalk walk = walk_to(receiver, branches_and_cluster.x);
  if (walk.light == kNone) return 0.0;
  return local_probability(receiver, walk, branches_and_cluster.y) / fetch_light(light).probability;
}
float environment_ratio(Receiver receiver) {
  if (!uses_light_cells() || !(frame.environment_probability > 0.0)) return 1.0;
  return cluster_probability(light_cell(receiver), kEnvironmentCluster) / frame.environment_probability;
}
float light_ratio(Receiver receiver, uint light) {
  if (light < frame.local_light_count) return local_light_ratio(receiver, light);
  if (light >= placed_lights()) return environment_ratio(receiver);
  if (!uses_light_cells()) return 1.0;
  return cluster_probability(light_cell(receiver), kDirectionalCluster) / fraction_of_integers(directional_group());
}

#endif
