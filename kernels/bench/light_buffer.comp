// A light buffer (Haines and Greenberg 1986), for rays that end at its lamp: the list of the cell in which the lamp
// sees the ray's origin, up to the depth of that. nodes: the lamp, three floats; where the items of each cell begin,
// and one more. Cells go face by face (+x, -x, +y, ...), row by row.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/bench/sorted_list.glsl"

const uint kHeaderWords = 3u;

float receiver_depth;

float depth_of_interest() { return receiver_depth; }

void traverse(float t_enter, float t_exit) {
  vec3 lamp = uintBitsToFloat(uvec3(texelFetch(nodes, 0).x, texelFetch(nodes, 1).x, texelFetch(nodes, 2).x));
  TraversalRay from_lamp = make_traversal_ray(lamp, ray.origin - lamp);
  vec3 place = to_sheared_axes(ray.origin - lamp, from_lamp.axis);
  receiver_depth = abs(place.z);
  uint face = 2u * from_lamp.axis + (place.z < 0.0 ? 1u : 0u);
  float side = float(resolution.x);
  uvec2 cell = uvec2(clamp((0.5 * place.xy / receiver_depth + 0.5) * side, vec2(0.0), vec2(side - 1.0)));
  int node = int(kHeaderWords + (face * resolution.x + cell.y) * resolution.x + cell.x);
  count_visit();
  uint first = texelFetch(nodes, node).x;
  test_sorted_items(first, texelFetch(nodes, node + 1).x - first);
}
