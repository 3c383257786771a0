// Soft spheres that a ray may meet (kFeatureSoftLamps): by the light tree where there is one, else one after the other.
// Include bindings.glsl with BIND_LIGHTS and BIND_LIGHT_TREE first.
#ifndef WAVEPATH_LAMP_SEARCH_GLSL
#define WAVEPATH_LAMP_SEARCH_GLSL

#include "kernels/light/light_selection.glsl"
#include "kernels/light/soft_lamps.glsl"

struct LampSearch {
  LightSearch tree;
  float radius;
  uint left; // local lights that were not looked at, without a tree
};

// Spheres are the last of the local lights, and have one radius.
LampSearch begin_lamp_search() {
  LampSearch search = LampSearch(begin_light_search(), 0.0, frame.local_light_count);
  if (search.left > 0u) search.radius = sphere_radius(search.left - 1u);
  if (search.radius == 0.0) search.left = 0u, search.tree.ended = true;
  return search;
}

// The next sphere that the ray meets before `end`, or little behind it: its index, and how far it is. False: no more.
bool next_lamp(inout LampSearch search, vec3 from, vec3 direction, float end, out uint index, out float distance_) {
  distance_ = kFar;
  while (distance_ == kFar) {
    if (uses_light_tree()) {
      index = next_light_along(search.tree, search.radius, from, direction, end);
    } else {
      index = search.left > 0u ? --search.left : kNone;
    }
    if (index == kNone) return false;
    float radius = sphere_radius(index);
    if (radius > 0.0) {
      distance_ = distance_to_lamp(light_position(index), radius, from, direction);
    } else if (!uses_light_tree()) {
      search.left = 0u;
    }
  }
  return true;
}

#endif
