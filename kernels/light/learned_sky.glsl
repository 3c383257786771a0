// Parts of an environment map or of a sky of one colour, chosen with probabilities that were trained near a receiver:
// indoors most of either is hidden, and a surface sees half of it at most. A direction is drawn by two numbers
// (sample_environment_map, sky_direction). A part is a square of these numbers, so that all parts have the same
// probability without training, and a net of numbers stays a net in every part. Include bindings.glsl with BIND_LIGHTS,
// BIND_LIGHT_TREE and BIND_ENVIRONMENT first.
#ifndef WAVEPATH_LEARNED_SKY_GLSL
#define WAVEPATH_LEARNED_SKY_GLSL

#include "kernels/base/intervals.glsl"
#include "kernels/base/learned_sky_types.h"
#include "kernels/light/light_sampling.glsl"
#include "kernels/light/light_selection.glsl"

bool uses_learned_sky() { return has_lobe(kFeatureLearnedSky) && (frame.scene_lobes & kFeatureLearnedSky) != 0u; }

uint first_sky_end; // first word of the intervals that sky_end() reads
uint sky_end(uint i) { return texelFetch(light_cells, int(first_sky_end + i)).x; }

// The ends of a cell's bands, and of the columns of one.
uint first_band(Receiver receiver) {
  return (uses_light_cells() ? kLightCells * kLightClusters : 0u) + light_cell(receiver) * kSkyCellWords;
}
uint first_in_band(uint first_band_, uint band) { return first_band_ + kSkySide + band * kSkySide; }

float sky_probability(uint i) { return fraction_of_integers(sky_end(i) - (i > 0u ? sky_end(i - 1u) : 0u)); }

// Warps two numbers so that they pick parts with the probabilities of the receiver's cell. Returns how many times more
// probable the part has become.
float pick_sky_part(Receiver receiver, inout uvec2 u) {
  u = min(u, uvec2(kLargestPick));
  uint first = first_band(receiver), band, column, begin, end;
  first_sky_end = first;
  PICK_INTERVAL(u.y, kSkySide, sky_end, band, begin, end)
  u.y = stretch(u.y - begin, end - begin);
  float probability = fraction_of_integers(end - begin);
  first_sky_end = first_in_band(first, band);
  PICK_INTERVAL(u.x, kSkySide, sky_end, column, begin, end)
  u.x = stretch(u.x - begin, end - begin);
  probability *= fraction_of_integers(end - begin);
  u = u >> kSkySideBits | uvec2(column, band) << (32u - kSkySideBits);
  return probability * float(kSkyParts);
}

// A direction of a sky of one colour, and the two numbers that would have drawn it.
vec3 sky_direction(uvec2 u) { return warp_uniform_sphere(unit_float(u)).xzy; }
vec2 sky_numbers(vec3 d) {
  float turns = atan2_exact(d.z, d.x) * (0.5 * kInvPi);
  return vec2(0.5 - 0.5 * d.y, turns < 0.0 ? turns + 1.0 : turns);
}

// The part, column and band, that has a world direction: what it would have been drawn by, undone.
uvec2 sky_part(vec3 direction) {
  if (!has(kFeatureEnvironmentMap) || frame.environment_width == 0u)
    return min(uvec2(max(sky_numbers(direction), 0.0) * float(kSkySide)), uvec2(kSkySide - 1u));
  vec3 d = environment_from_world(direction, frame.environment_rotation);
  EnvironmentPoint at = environment_point(d);
  uvec2 texel = at.texel;
  first_column = frame.environment_height + texel.y * frame.environment_width;
  uvec2 begin = uvec2(texel.x > 0u ? column_end(texel.x - 1u) : 0u, texel.y > 0u ? row_end(texel.y - 1u) : 0u);
  uvec2 end = uvec2(column_end(texel.x), row_end(texel.y));
  float across = at.position.x - float(texel.x),
        down = environment_row_fraction(d, texel.y, frame.environment_height);
  vec2 fraction = clamp(vec2(across, down), 0.0, 1.0);
  uvec2 width = max(end - begin, uvec2(1u));
  uvec2 inside = min(uvec2(min(fraction * vec2(width), vec2(4294967040.0))), width - 1u);
  return min(begin + inside, uvec2(kLargestPick)) >> (32u - kSkySideBits);
}

// Probability of the part that has a direction, relative to that without training.
float sky_part_ratio(Receiver receiver, vec3 direction) {
  if (!uses_learned_sky()) return 1.0;
  uvec2 part = sky_part(direction);
  first_sky_end = first_band(receiver);
  float probability = sky_probability(part.y);
  first_sky_end = first_in_band(first_sky_end, part.y);
  return probability * sky_probability(part.x) * float(kSkyParts);
}

// Probability of the environment in this direction, relative to selection by power.
float environment_ratio(Receiver receiver, vec3 direction) {
  return environment_ratio(receiver) * sky_part_ratio(receiver, direction);
}

#endif
