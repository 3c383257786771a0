// Light of a path by groups of lights (kFeatureLightGroups). Include kernels/path/bindings.glsl with BIND_GROUPS first,
// and with BIND_GEOMETRY where surfaces are asked for their group.
#ifndef WAVEPATH_PATH_LIGHT_GROUPS_GLSL
#define WAVEPATH_PATH_LIGHT_GROUPS_GLSL

#include "kernels/base/config.glsl"
#include "kernels/base/scene_types.h"

#define HAS_LIGHT_GROUPS has_lobe(kFeatureLightGroups)

uint group_word(uint index) { return texelFetch(group_table, int(index)).x; }
uint group_count() { return group_word(kGroupCount); }
uint group_of_environment() { return group_word(kGroupEnvironment); }
uint group_of_volume() { return group_word(kGroupVolume); }
// `light`: index of a light, or kNone for a sky that paths look for by themselves.
uint group_of_light(uint light) { return light == kNone ? group_of_environment() : group_word(kGroupLights + light); }

#ifdef BIND_GEOMETRY
// Group of what a surface emits.
uint group_of_surface(Hit hit, uint material) {
  uint group = group_word(group_word(kGroupMaterials) + material);
  uint first_triangle = group_word(kGroupTriangles), first_instance = group_word(kGroupInstances);
  if (first_triangle == 0u) return group;
  uint of_node = first_instance != 0u ? group_word(first_instance + hit.instance) : kNone;
  if (of_node == kNone) of_node = group_word(first_triangle + hit.triangle);
  return min(group, of_node);
}
#endif

// Words of a path: its channels of the first group, of the second one, and so on, each of all slots.
uint group_channel(uint group, uint channel, uint slot) { return (3u * group + channel) * frame.slot_count + slot; }

vec3 group_light(uint group, uint slot) {
  return vec3(path_groups[group_channel(group, 0u, slot)], path_groups[group_channel(group, 1u, slot)],
              path_groups[group_channel(group, 2u, slot)]);
}

void add_to_group(uint group, uint slot, vec3 light) {
  for (uint c = 0u; c < 3u; ++c) path_groups[group_channel(group, c, slot)] += light[c];
}

// Behind them the number of the group of the light that a light path began at.
uint path_group(uint slot) { return uint(path_groups[group_channel(group_count(), 0u, slot)]); }
void store_path_group(uint slot, uint group) {
  path_groups[group_channel(group_count(), 0u, slot)] = float(group);
}

// Before a path begins.
void clear_groups(uint slot) {
  for (uint i = 0u; i < 3u * group_count(); ++i) path_groups[i * frame.slot_count + slot] = 0.0;
}

#endif
