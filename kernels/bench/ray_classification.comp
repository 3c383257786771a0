// Ray classification (Arvo and Kirk 1987): a ray is a point of five coordinates, its origin and where its direction
// pierces a face of a cube. A binary tree over them leads to the triangles that the rays of its leaf can meet. Two
// words a node, six roots first, by axis and sign of the direction. Of an inner node: where it is cut, and the
// coordinate with the first of its two children above three bits. Of a leaf: its first item, and their number above
// three set bits.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/bench/sorted_list.glsl"

const uint kLeaf = 7u;

vec2 origin_and_speed; // along the axis of the face

float depth_of_interest() { return origin_and_speed.x + t_best * origin_and_speed.y; }

void traverse(float t_enter, float t_exit) {
  vec3 direction = texelFetch(rays, 2 * int(first_ray + gl_GlobalInvocationID.x) + 1).xyz;
  vec3 along = to_sheared_axes(direction, ray.axis);
  bool backwards = along.z < 0.0;
  float speed = abs(along.z), origin = to_sheared_axes(ray.origin, ray.axis).z;
  origin_and_speed = vec2(backwards ? -origin : origin, speed);
  uint node = 2u * ray.axis + (backwards ? 1u : 0u);
  uvec2 entry = texelFetch(nodes, int(node)).xy;
  while ((entry.y & 7u) != kLeaf) {
    count_visit();
    uint coordinate = entry.y & 7u;
    // Products in place of quotients, which host and device round alike.
    precise float cut = uintBitsToFloat(entry.x) * (coordinate < 3u ? 1.0 : speed);
    float place = coordinate == 0u   ? ray.origin.x
                  : coordinate == 1u ? ray.origin.y
                  : coordinate == 2u ? ray.origin.z
                  : coordinate == 3u ? along.x
                                     : along.y;
    node = (entry.y >> 3u) + (place < cut ? 0u : 1u);
    entry = texelFetch(nodes, int(node)).xy;
  }
  test_sorted_items(entry.x, entry.y >> 3u);
}
