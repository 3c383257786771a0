// Choosing lights and points on them: triangles, punctual lights, and the lat-long environment.
//
// Everything here works on data already fetched; those at the end read the buffers of kernels/base/bindings.glsl
// and are there when BIND_LIGHTS or BIND_ENVIRONMENT asked for those.
#ifndef WAVEPATH_LIGHT_SAMPLING_GLSL
#define WAVEPATH_LIGHT_SAMPLING_GLSL

#include "kernels/base/config.glsl"
#include "kernels/base/scene_types.h"
#include "kernels/base/intervals.glsl"
#include "kernels/base/math.glsl"
#include "kernels/base/records.glsl"

// ---- triangles --------------------------------------------------------------------------------------------------

// Density per solid angle of a point chosen with pdf_area, seen along `to_light` (unnormalized) on a surface with unit
// normal n.
float solid_angle_pdf(float pdf_area, vec3 to_light, vec3 n) {
  float d2 = dot(to_light, to_light);
  float cosine = abs(dot(to_light, n)) / sqrt(d2);
  return cosine > 0.0 ? pdf_area * d2 / cosine : 0.0;
}

// A triangle whose emission texture varies is cut into parts, each picked by an interval of its own. The middles of its
// edges cut it into quarters, those cut each of them, and so on, down to 4^depth cells. The number of a cell has two
// bits for every cut, the first one on top: 0 to 2 for the quarter at that corner, 3 for the one in the middle, which
// is turned by half a turn about the middle of the whole. A part is 1, 4, 16, ... cells in a row, from where the part
// before ends to its own end.

// Number of the cell that has the point with these barycentric weights.
uint cell_at(uint depth, vec2 weights) {
  uint cell = 0u;
  for (uint i = 0u; i < depth; ++i) {
    bool first = weights.x >= 0.5, second = !first && weights.y >= 0.5;
    bool middle = !first && !second && weights.x + weights.y > 0.5;
    cell = cell << 2u | (first ? 1u : second ? 2u : middle ? 3u : 0u);
    weights = middle ? 1.0 - 2.0 * weights : 2.0 * weights - vec2(first ? 1.0 : 0.0, second ? 1.0 : 0.0);
  }
  return cell;
}

// Barycentric weights of a point that has these weights within the part of so many cells from `cell` on.
vec2 weights_in_part(uint depth, uint cell, uint cells, vec2 weights) {
  for (uint shift = uint(findMSB(cells)); shift < 2u * depth; shift += 2u) {
    uint quarter = cell >> shift & 3u;
    weights *= 0.5;
    weights = quarter == 3u ? 0.5 - weights : weights + vec2(quarter == 1u ? 0.5 : 0.0, quarter == 2u ? 0.5 : 0.0);
  }
  return weights;
}

// ---- punctual lights --------------------------------------------------------------------------------------------

// Falloff of KHR_lights_punctual for lights with a `range`: 1 near the light, 0 beyond the range. Its argument is the
// square of a distance.
float range_window(float inverse_range, float distance_squared) {
  float fraction = distance_squared * (inverse_range * inverse_range);
  return clamp(1.0 - fraction * fraction, 0.0, 1.0);
}

#ifdef BIND_LIGHTS
// A word behind the lights.
uint part_word(uint word) {
  return texelFetch(light_texels, int(frame.light_count * kLightTexels + (word >> 2u)))[word & 3u];
}
float part_float(uint word) { return uintBitsToFloat(part_word(word)); }
vec3 part_vector(uint word) { return vec3(part_float(word), part_float(word + 1u), part_float(word + 2u)); }

// Place of an angle among ascending ones, as the index of one plus a fraction of the way to the next.
float place_among(uint first, uint count, float angle) {
  uint below = 0u, above = count - 1u;
  while (above > below + 1u) {
    uint middle = (below + above) >> 1u;
    if (part_float(first + middle) <= angle)
      below = middle;
    else
      above = middle;
  }
  float begin = part_float(first + below), end = part_float(first + above);
  return float(below) + (above > below ? clamp((angle - begin) / (end - begin), 0.0, 1.0) : 0.0);
}

// Intensity of a profile along a direction of any length, relative to the largest one. It goes linearly from angle to
// angle.
float profile_intensity(uint parts, vec3 direction) {
  uint first = parts - 1u, table = part_word(first + kProfileTable);
  vec3 axis = part_vector(first + kProfileAxis), tangent = part_vector(first + kProfileTangent);
  uint rows = part_word(table), columns = part_word(table + 1u);
  uint vertical = table + kProfileAngles, horizontal = vertical + rows, values = horizontal + columns;
  vec2 beside = vec2(dot(direction, tangent), dot(direction, cross(tangent, axis)));
  float polar = atan2_exact(length(beside), dot(direction, axis));
  if (polar < part_float(vertical) || polar > part_float(vertical + rows - 1u)) return 0.0;
  float turn = atan2_exact(beside.y, beside.x);
  float row = place_among(vertical, rows, polar);
  float column = columns > 1u ? place_among(horizontal, columns, turn < 0.0 ? turn + 2.0 * kPi : turn) : 0.0;
  uint r0 = uint(row), c0 = uint(column), r1 = min(r0 + 1u, rows - 1u), c1 = min(c0 + 1u, columns - 1u);
  float across = fract(column), down = fract(row);
  uint near = values + c0 * rows, far = values + c1 * rows;
  return mix(mix(part_float(near + r0), part_float(near + r1), down),
             mix(part_float(far + r0), part_float(far + r1), down), across);
}
#endif

// Irradiance that a point, spot or directional light gives a surface at p which faces it. to_light: to the light itself
// for points and spots (not normalized), a unit vector for directional ones.
vec3 punctual_irradiance(Light light, vec3 p, out vec3 to_light) {
  bool distant = light.kind == kLightDirectional;
  to_light = distant ? light.direction : light.position - p;
  float d2 = distant ? 1.0 : dot(to_light, to_light);
  if (!(d2 > 0.0)) return vec3(0.0);
  float falloff = 1.0;
  if (light.kind == kLightSpot) {
    float c = -dot(to_light, light.direction) / sqrt(d2);
    falloff = clamp(c * light.spot_scale + light.spot_offset, 0.0, 1.0);
    falloff *= falloff;
  }
#ifdef BIND_LIGHTS
  if (has_lobe(kFeatureLightProfiles) && light.kind == kLightPoint && light.parts != 0u)
    falloff = profile_intensity(light.parts, -to_light);
#endif
  return light.intensity * (falloff * range_window(light.inverse_range, d2) / d2);
}

// ---- environment ------------------------------------------------------------------------------------------------
// Lat-long: u = atan2(z, x)/2pi + 1/2, v = acos(y)/pi from the top row, in the map's own basis. rotation = (cos, sin)
// of the angle by which the map is turned about +Y, counter-clockwise seen from above.

vec3 environment_from_world(vec3 d, vec2 rotation) {
  return vec3(rotation.x * d.x - rotation.y * d.z, d.y, rotation.y * d.x + rotation.x * d.z);
}
vec3 world_from_environment(vec3 d, vec2 rotation) {
  return vec3(rotation.x * d.x + rotation.y * d.z, d.y, rotation.x * d.z - rotation.y * d.x);
}

// Position in the map of a unit direction in its basis, both in [0, 1).
vec2 environment_uv(vec3 d) {
  float u = atan2_exact(d.z, d.x) * (0.5 * kInvPi) + 0.5;
  float v = atan2_exact(sqrt(d.x * d.x + d.z * d.z), d.y) * kInvPi;
  return vec2(u < 1.0 ? u : 0.0, min(v, kOneMinusEpsilon));
}

vec3 environment_direction(vec2 uv) {
  vec2 azimuth = cos_sin_turns(uv.x - 0.5);
  vec2 polar = cos_sin_turns(0.5 * uv.y);
  return vec3(polar.y * azimuth.x, polar.x, polar.y * azimuth.y);
}

// Solid angle of a texel: 2pi/w times the difference of two cosines, written as a product because they agree near the
// poles.
float environment_texel_solid_angle(uint row, uint width, uint height) {
  float h = float(height);
  return 4.0 * kPi / float(width) * cos_sin_turns((float(row) + 0.5) / (2.0 * h)).y * cos_sin_turns(0.25 / h).y;
}

// Direction in texel (column, row), uniform in solid angle over it, and its position in the map in texels, which lies
// in that texel or on its border whatever is rounded. Heights are measured from the nearer pole as sin^2 of half the
// polar angle, which is proportional to solid angle and keeps its precision there.
vec3 environment_texel_direction(uint column, uint row, uint width, uint height, vec2 u, out vec2 position) {
  bool south = 2u * row >= height;
  float k = float(south ? height - 1u - row : row);
  float h = float(height);
  float near = cos_sin_turns(0.25 * k / h).y, far = cos_sin_turns(0.25 * (k + 1.0) / h).y;
  float s = mix(near * near, far * far, south ? 1.0 - u.y : u.y);
  float x = float(column) + u.x, y = 1.0 - 2.0 * s, sine = 2.0 * sqrt(s * (1.0 - s));
  y = south ? -y : y;
  position = vec2(x, clamp(atan2_exact(sine, y) * kInvPi * h, float(row), float(row) + 1.0));
  return vec3(sine * cos_sin_turns(x / float(width) - 0.5), y).xzy;
}

// Fraction of the texel's height, by solid angle, at which a direction lies: u.y of the function above.
float environment_row_fraction(vec3 d, uint row, uint height) {
  bool south = 2u * row >= height;
  float k = float(south ? height - 1u - row : row);
  float h = float(height);
  float near = cos_sin_turns(0.25 * k / h).y, far = cos_sin_turns(0.25 * (k + 1.0) / h).y;
  float y = south ? -d.y : d.y, beside = 0.5 * (d.x * d.x + d.z * d.z) / (1.0 + abs(y));
  float fraction = ((y < 0.0 ? 1.0 - beside : beside) - near * near) / (far * far - near * near);
  return south ? 1.0 - fraction : fraction;
}

// ---- from the bound buffers -------------------------------------------------------------------------------------

#ifdef BIND_LIGHTS
uint light_end(uint index) { return texelFetch(light_texels, int(index * kLightTexels + 2u)).w; }

// Index of a light chosen by its interval. u.x becomes what is left of it.
uint pick_light(inout uvec2 u) {
  if (frame.light_count <= 1u) return 0u;
  uint index, begin, end, pick = min(u.x, kLargestPick);
  PICK_INTERVAL(pick, frame.light_count, light_end, index, begin, end)
  u.x = stretch(pick - begin, end - begin);
  return index;
}

// Words behind the lights, for every triangle that is cut: the number of its parts, their ends among the numbers that
// pick, and their ends among the cells.
uint first_part, part_count; // word range of the triangle that the next functions read
uint part_end(uint part) { return part_word(first_part + part); }
uint part_cell_end(uint part) { return part_word(first_part + part_count + part); }
void find_parts(uint parts) {
  uint word = parts & kFirstPartMask;
  part_count = part_word(word);
  first_part = word + 1u;
}

// Density of points in a part, relative to the triangle's average.
float part_density(uint depth, uint cells, uint begin, uint end) {
  return float(end - begin) * (1.0 / 4294967296.0) * (float(1u << (2u * depth)) / float(cells));
}

// Barycentric weights of a point on a triangle light, and its density over the mean. `parts`: Light::parts.
vec2 sample_light_triangle(uint parts, uvec2 u, out float density) {
  density = 1.0;
  uint depth = parts >> kPartDepthShift;
  if (!has(kFeatureEmissionTextures) || depth == 0u) return warp_triangle(unit_float(u));
  find_parts(parts);
  uint part, begin, end, pick = min(u.x, kLargestPick);
  PICK_INTERVAL(pick, part_count, part_end, part, begin, end)
  u.x = stretch(pick - begin, end - begin);
  uint cell = part > 0u ? part_cell_end(part - 1u) : 0u, cells = part_cell_end(part) - cell;
  density = part_density(depth, cells, begin, end);
  return weights_in_part(depth, cell, cells, warp_triangle(unit_float(u)));
}

// The same density at the point with these weights.
float light_triangle_density(uint parts, vec2 weights) {
  uint depth = parts >> kPartDepthShift;
  if (!has(kFeatureEmissionTextures) || depth == 0u) return 1.0;
  find_parts(parts);
  uint part, cell, cell_end, at = cell_at(depth, weights);
  PICK_INTERVAL(at, part_count, part_cell_end, part, cell, cell_end)
  cell_end = min(cell_end, 1u << (2u * depth));
  return part_density(depth, cell_end - cell, part > 0u ? part_end(part - 1u) : 0u, part_end(part));
}
#endif

#ifdef BIND_ENVIRONMENT
// A position in the environment map.
struct EnvironmentPoint {
  vec2 position; // in texels
  uvec2 texel;   // column and row of the one that it is in
};

EnvironmentPoint environment_point(vec3 d) { // `d`: in the map's basis
  uvec2 size = uvec2(frame.environment_width, frame.environment_height);
  vec2 position = environment_uv(d) * vec2(size);
  return EnvironmentPoint(position, min(uvec2(position), size - 1u));
}

// Radiance there, interpolated between texel centres (u wraps, v ends at the poles), and the density per solid angle
// with which sample_environment_map finds a direction in the texel: one of the four between which is interpolated.
vec3 environment_map_radiance(EnvironmentPoint at, out float pdf) {
  ivec2 size = ivec2(frame.environment_width, frame.environment_height), texel = ivec2(at.texel);
  vec2 position = at.position - 0.5;
  vec2 first = floor(position), weight = position - first;
  int left = int(first.x) < 0 ? size.x - 1 : int(first.x);
  int right = left + 1 == size.x ? 0 : left + 1;
  int upper = max(int(first.y), 0), lower = min(int(first.y) + 1, size.y - 1);
  vec4 upper_left = texelFetch(environment, upper * size.x + left),
       upper_right = texelFetch(environment, upper * size.x + right);
  vec4 lower_left = texelFetch(environment, lower * size.x + left),
       lower_right = texelFetch(environment, lower * size.x + right);
  vec2 column = texel.x == left ? vec2(upper_left.w, lower_left.w) : vec2(upper_right.w, lower_right.w);
  float probability = texel.y == upper ? column.x : column.y;
  pdf = probability / environment_texel_solid_angle(at.texel.y, frame.environment_width, frame.environment_height);
  return mix(mix(upper_left.rgb, upper_right.rgb, weight.x), mix(lower_left.rgb, lower_right.rgb, weight.x), weight.y);
}

// Ends of the rows and of the columns of each row, behind them the cuts of both.
uint row_cut(uint cut) {
  return texelFetch(environment_ends, int(frame.environment_height * (1u + frame.environment_width) + cut)).x;
}
uint row_end(uint row) { return texelFetch(environment_ends, int(row)).x; }
uint first_column, first_cut; // word offsets of the row that column_end() and column_cut() read
uint column_end(uint column) { return texelFetch(environment_ends, int(first_column + column)).x; }
uint column_cut(uint cut) { return texelFetch(environment_ends, int(first_cut + cut)).x; }

// World direction chosen in proportion to the map, and its position there. By inversion, first of the distribution of
// rows, then of the columns in the row (pbrt-v4, section A.5.6): near numbers give near directions, so that nets stay
// nets. Picks from an alias table have 4 to 40 times the squared error at 128 samples.
vec3 sample_environment_map(uvec2 u, out EnvironmentPoint at) {
  uint width = frame.environment_width, height = frame.environment_height;
  u = min(u, uvec2(kLargestPick));
  uint begin, end;
  uvec2 texel;
  PICK_INTERVAL_BY_CUTS(u.y, height, row_cut, row_end, texel.y, begin, end)
  u.y = stretch(u.y - begin, end - begin);
  first_column = height + texel.y * width;
  first_cut = height * (1u + width) + (1u << cut_bits(height)) + (texel.y << cut_bits(width));
  PICK_INTERVAL_BY_CUTS(u.x, width, column_cut, column_end, texel.x, begin, end)
  u.x = stretch(u.x - begin, end - begin);
  vec2 position;
  vec3 d = environment_texel_direction(texel.x, texel.y, width, height, unit_float(u), position);
  at = EnvironmentPoint(position, texel);
  return world_from_environment(d, frame.environment_rotation);
}
#endif

#endif
