// Lists of candidates, the nearest first: triangles behind what is wanted end the search (Haines and Greenberg 1986;
// Arvo and Kirk 1987).
#ifndef WAVEPATH_SORTED_LIST_GLSL
#define WAVEPATH_SORTED_LIST_GLSL

#include "kernels/bench/structure.glsl"

layout(set = 0, binding = 6) uniform samplerBuffer item_depths; // of the items: the nearest point, lowered by rounding

float depth_of_interest(); // the depth from which on nothing is wanted; it may fall with every hit

void test_sorted_items(uint first, uint count) {
  uint item = first;
  bool goes_on = item < first + count;
  while (goes_on) {
    goes_on = texelFetch(item_depths, int(item)).x <= depth_of_interest();
    if (goes_on) {
      test_triangle(texelFetch(items, int(item)).x);
      ++item;
      goes_on = item < first + count && !is_over();
    }
  }
}

#endif
