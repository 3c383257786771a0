// The fraction of light that passes the volume along a ray, estimated without bias. Within a cell the smallest density
// has its part in closed form, and what is above it is tracked by collisions: residual ratio tracking (Novak, Selle and
// Jarosz 2014), with bounds for each cell. Include kernels/volume/bindings.glsl first.
#ifndef WAVEPATH_VOLUME_TRANSMITTANCE_GLSL
#define WAVEPATH_VOLUME_TRANSMITTANCE_GLSL

#include "kernels/volume/cells.glsl"
#include "kernels/volume/random.glsl"

// More steps than rays take through volumes as dense as the host lets them be (volume_thinning()). lavapipe ends loops
// after 65,535 without a word; a ray that comes to these is not finite, and counted as such.
const uint kMostSteps = 60000u;

// Light that is fainter passes by Russian roulette with this probability, and is then as many times brighter.
const float kFaint = 0.05, kFaintSurvival = 0.25;

// `direction`: of length `metres` for a unit of t. Call begin_random() before.
vec3 volume_transmittance(vec3 origin, vec3 direction, float t_max, float metres) {
  CellWalk walk;
  if (!begin_walk(origin, direction, t_max, walk)) return vec3(1.0);
  VolumeCoefficients coefficients = fetch_coefficients();
  VoxelBox box = fetch_box(kVolumeDensity);
  vec3 extinction = coefficients.scattering + coefficients.absorption, share = extinction / coefficients.extinction;
  float passed_smallest = 0.0; // integral of the smallest density
  vec3 fraction = vec3(1.0);
  float depth = random_depth(next_random());
  vec2 bounds = cell_bounds(walk);
  for (uint steps = 0u; steps < kMostSteps; ++steps) {
    float most = (bounds.x - bounds.y) * coefficients.extinction * metres, leaves = end_of_cell(walk);
    float in_cell = most * (leaves - walk.at);
    if (in_cell > depth) { // a collision
      float before = walk.at;
      walk.at = min(walk.at + depth / most, leaves);
      passed_smallest += bounds.y * (walk.at - before);
      float u = next_random();
      float density = some_density(box, voxel_point(walked_to(walk)), u);
      fraction *= 1.0 - share * clamp((density - bounds.y) / (bounds.x - bounds.y), 0.0, 1.0);
      float brightest = max_component(fraction);
      if (!(brightest > 0.0)) return vec3(0.0);
      if (brightest < kFaint) {
        if (!(next_random() < kFaintSurvival)) return vec3(0.0);
        fraction /= kFaintSurvival;
      }
      depth = random_depth(next_random());
      continue;
    }
    depth -= in_cell;
    passed_smallest += bounds.y * (leaves - walk.at);
    if (!next_cell(walk)) return fraction * exp(-extinction * (passed_smallest * metres));
    bounds = cell_bounds(walk);
  }
  return uintBitsToFloat(uvec3(0x7fc00000u));
}

#endif
