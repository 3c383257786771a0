// A density over the sphere that can be drawn from, as a leaf of the guiding field has it.
//
// The sphere is cut into kGuideSide^2 cells by height y and by an azimuth without trigonometry: a quarter of a turn
// goes by z / (|x| + |z|) instead of the angle, whose cells have 0.64x to 1.27x the solid angle of even ones. Texels:
// path_types.h. Include bindings.glsl with BIND_GUIDE first.
#ifndef WAVEPATH_GUIDE_MAP_GLSL
#define WAVEPATH_GUIDE_MAP_GLSL

#include "kernels/base/math.glsl"
#include "kernels/path/path_types.h"

// ---- where a direction lies -------------------------------------------------------------------------------------

// Maps the azimuth: -1 to 1 in front (x >= 0), and back again behind.
float azimuth_across(float azimuth, out bool behind) {
  float turn = 4.0 * azimuth - 1.0;
  behind = turn > 1.0;
  return behind ? 2.0 - turn : turn;
}

vec2 map_position(vec3 d) {
  float across = d.z / max(abs(d.x) + abs(d.z), 1e-30);
  return clamp(vec2(0.25 * (d.x < 0.0 ? 3.0 - across : 1.0 + across), 0.5 * d.y + 0.5), 0.0, kOneMinusEpsilon);
}

vec3 map_direction(vec2 position) {
  bool behind;
  float across = azimuth_across(position.x, behind), along = 1.0 - abs(across);
  float y = 2.0 * position.y - 1.0;
  float scale = sqrt(max((1.0 - y) * (1.0 + y), 0.0) / (across * across + along * along));
  return vec3((behind ? -along : along) * scale, y, across * scale);
}

// Density per solid angle over what it would be if all positions had the same solid angle.
float map_stretch(float azimuth) {
  bool behind;
  float across = abs(azimuth_across(azimuth, behind)), along = 1.0 - across;
  return 0.5 * kPi * (across * across + along * along);
}

// ---- the density ------------------------------------------------------------------------------------------------

vec4 map_quad(uint map, uvec2 quad) {
  return uintBitsToFloat(texelFetch(guide_maps, int(map + kGuideBlocks + quad.y * (kGuideSide / 2u) + quad.x)));
}

// Per solid angle.
float map_pdf(uint map, vec3 direction) {
  vec2 position = map_position(direction);
  uvec2 cell = uvec2(position * float(kGuideSide));
  vec4 quad = map_quad(map, cell >> 1u);
  vec2 pair = (cell.y & 1u) == 0u ? quad.xy : quad.zw;
  return ((cell.x & 1u) == 0u ? pair.x : pair.y) * map_stretch(position.x);
}

// The four weights of a column or, of columns, their sums: which one takes u, which is stretched to [0, 1) again.
uint choose_of_four(vec4 weights, inout float u) {
  float second = weights.x + weights.y, third = second + weights.z;
  float x = u * (third + weights.w);
  bvec3 passed = greaterThanEqual(vec3(x), vec3(weights.x, second, third));
  float first = passed.z ? third : passed.y ? second : passed.x ? weights.x : 0.0;
  float width = passed.z ? weights.w : passed.y ? weights.z : passed.x ? weights.y : weights.x;
  u = min((x - first) / width, kOneMinusEpsilon);
  return uint(passed.x) + uint(passed.y) + uint(passed.z);
}

vec4 weights_of(uint column) {
  uvec4 bytes = uvec4(column, column >> 8u, column >> 16u, column >> 24u) & 255u;
  return uintBitsToFloat(bytes << kGuideWeightShift | kGuideWeightExponent << 23u);
}

float sum_of(vec4 v) { return (v.x + v.y) + (v.z + v.w); }

// Chooses one of the 4x4 parts of a block; returns its column and row.
uvec2 choose_part(uvec4 block, inout vec2 u) {
  vec4 a = weights_of(block.x), b = weights_of(block.y), c = weights_of(block.z), d = weights_of(block.w);
  uint column = choose_of_four(vec4(sum_of(a), sum_of(b), sum_of(c), sum_of(d)), u.x);
  return uvec2(column, choose_of_four(column < 2u ? (column == 0u ? a : b) : (column == 2u ? c : d), u.y));
}

// Chooses one of two by their weights; u is stretched to [0, 1) again.
bool choose_second(float first, float second, inout float u) {
  float probability = first / (first + second);
  bool is_second = !(u < probability);
  u = min(is_second ? (u - probability) / (1.0 - probability) : u / probability, kOneMinusEpsilon);
  return is_second;
}

// A direction with that density. Neighbours among u stay neighbours, so that a net stays one.
vec3 sample_map(uint map, vec2 u) {
  uvec2 part = choose_part(texelFetch(guide_maps, int(map)), u);
  uvec2 quad = 4u * part + choose_part(texelFetch(guide_maps, int(map + 1u + 4u * part.y + part.x)), u);
  vec4 cells = map_quad(map, quad);
  bool right = choose_second(cells.x + cells.z, cells.y + cells.w, u.x);
  bool upper = choose_second(right ? cells.y : cells.x, right ? cells.w : cells.z, u.y);
  vec2 position = (vec2(2u * quad + uvec2(right, upper)) + u) / float(kGuideSide);
  return map_direction(clamp(position, 0.0, kOneMinusEpsilon)); // a rounded difference may have left the cell
}

#endif
