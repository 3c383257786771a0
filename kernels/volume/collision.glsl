// Collisions of light that follows a ray through the volume, without bias: they are tracked with the largest density of
// each cell, and are real or null (Woodcock 1965). Of the real ones, the part that the smallest density of
// the cell has is known without a look at the voxels: decomposition tracking (Kutz, Habel, Li and Novak 2017), and
// weights by channel as they have it. Include kernels/volume/bindings.glsl first.
#ifndef WAVEPATH_VOLUME_COLLISION_GLSL
#define WAVEPATH_VOLUME_COLLISION_GLSL

#include "kernels/volume/transmittance.glsl"

float sum_of(vec3 v) { return v.x + v.y + v.z; }

// Follows a ray of unit direction. True: it is scattered at `distance_`. Multiplies the throughput, and adds to the
// radiance what black bodies send along the way. `first`: random numbers of the first collision. Call begin_random()
// before.
bool collide(VolumeCoefficients coefficients, vec3 origin, vec3 direction, float t_max, vec2 first,
             inout vec3 throughput, inout vec3 radiance, out float distance_) {
  distance_ = t_max;
  CellWalk walk;
  if (!begin_walk(origin, direction, t_max, walk)) return false;
  VoxelBox box = fetch_box(kVolumeDensity);
  float depth = random_depth(first.x), u = first.y;
  vec2 bounds = cell_bounds(walk);
  for (uint steps = 0u; steps < kMostSteps; ++steps) {
    float most = bounds.x * coefficients.extinction, leaves = end_of_cell(walk);
    float in_cell = most * (leaves - walk.at);
    if (in_cell > depth) {
      walk.at = min(walk.at + depth / most, leaves);
      vec3 point = walked_to(walk);
      // The density over the largest one: of the smallest density always 1, with the probability that it has.
      float real = 1.0;
      if (!decide(bounds.y / bounds.x, u))
        real = clamp((some_density(box, voxel_point(point), u) - bounds.y) /
                         (bounds.x - bounds.y), 0.0, 1.0);
      vec3 absorbed = coefficients.absorption / coefficients.extinction * real;
      vec3 scattered = coefficients.scattering / coefficients.extinction * real;
      if (HAS_FIRE && real > 0.0) radiance += throughput * absorbed * fire_at(point);
      vec3 null = 1.0 - absorbed - scattered;
      float scatters = sum_of(throughput * scattered), passes = sum_of(throughput * max(null, vec3(0.0)));
      if (!(scatters + passes > 0.0)) {
        throughput = vec3(0.0);
        return false;
      }
      float probability = scatters / (scatters + passes);
      bool is_scattered = decide(probability, u);
      throughput *= is_scattered ? scattered / probability : max(null, vec3(0.0)) / (1.0 - probability);
      if (is_scattered) {
        distance_ = walk.start + walk.at;
        return true;
      }
      depth = random_depth(next_random());
      u = next_random();
      continue;
    }
    depth -= in_cell;
    if (!next_cell(walk)) return false;
    bounds = cell_bounds(walk);
  }
  throughput = uintBitsToFloat(uvec3(0x7fc00000u));
  return false;
}

#endif
