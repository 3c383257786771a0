// Values of the volume's grids between their voxels. Include kernels/volume/bindings.glsl first.
#ifndef WAVEPATH_VOLUME_VOXELS_GLSL
#define WAVEPATH_VOLUME_VOXELS_GLSL

#include "kernels/base/math.glsl"

float voxel(VoxelBox box, ivec3 at) {
  at -= box.first;
  ivec3 brick = at >> int(kBrickShift), side = ivec3(box.bricks);
  if (any(lessThan(at, ivec3(0))) || any(greaterThanEqual(brick, side))) return 0.0;
  int texel = int(box.texel) + brick.x + side.x * (brick.y + side.y * brick.z);
  uvec2 words = texelFetch(volume_grid, texel).xy;
  if (words.x == kNone) return uintBitsToFloat(words.y);
  ivec3 within = at & 7;
  return texelFetch(volume_voxels, int(words.x * kBrickWords) + (within.x << 6 | within.y << 3 | within.z)).x;
}

// Takes a decision with this probability by the number u in [0, 1), and leaves in u what is random of it.
bool decide(float probability, inout float u) {
  bool taken = u < probability;
  u = taken ? u / probability : (u - probability) / (1.0 - probability);
  u = min(u, kOneMinusEpsilon);
  return taken;
}

// One of the eight voxels around the point, by its trilinear weight: one fetch, and in the mean the interpolated value.
// What follows from it linearly, as collisions do, is as it would be with interpolation (Pharr 2024, "Filtering After
// Shading With Stochastic Texture Filtering").
float some_density(VoxelBox box, vec3 point, inout float u) {
  vec3 corner = floor(point), weight = point - corner;
  ivec3 at = ivec3(corner);
  at.x += decide(weight.x, u) ? 1 : 0;
  at.y += decide(weight.y, u) ? 1 : 0;
  at.z += decide(weight.z, u) ? 1 : 0;
  return voxel(box, at);
}

// Interpolated, since black bodies do not shine in proportion to their temperature.
float temperature_at(vec3 point) {
  VoxelBox box = fetch_box(kVolumeTemperature);
  vec3 corner = floor(point), weight = point - corner;
  float sum = 0.0;
  for (int k = 0; k < 8; ++k) {
    ivec3 step_ = ivec3(k & 1, k >> 1 & 1, k >> 2);
    vec3 share = mix(1.0 - weight, weight, vec3(step_));
    sum += share.x * share.y * share.z * voxel(box, ivec3(corner) + step_);
  }
  return sum;
}

vec3 kelvin_color(uint first, uint entry) {
  int word = int(first + 3u * entry);
  return vec3(texelFetch(volume_voxels, word).x, texelFetch(volume_voxels, word + 1).x,
              texelFetch(volume_voxels, word + 2).x);
}

// Radiance of a black body of the temperature at a point of the cells' space.
vec3 fire_at(vec3 cells_point) {
  vec4 fire = volume_floats(kVolumeFire); // emission, scale and offset of temperatures
  uint first = floatBitsToUint(fire.w);
  float kelvin = fire.y * (temperature_at(volume_transform(kVolumeTemperatureFromCells, cells_point, 1.0)) - fire.z);
  if (!(kelvin > kLowestKelvin)) return vec3(0.0);
  float entry = min(float(kKelvinSteps) * minus_log2(kLowestKelvin / kelvin), float(kKelvins - 1u));
  uint below = min(uint(entry), kKelvins - 2u);
  return fire.x * mix(kelvin_color(first, below), kelvin_color(first, below + 1u), entry - float(below));
}

#endif
