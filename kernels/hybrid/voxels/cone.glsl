// Cones through the levels of surface voxels (Crassin, Neyret, Sainz, Green and Eisemann 2011): from voxel to voxel
// along the axis, each about as wide as the cone there. What passes is composed front to back.
#ifndef WAVEPATH_CONE_GLSL
#define WAVEPATH_CONE_GLSL

#include "kernels/base/dimensions.glsl"
#include "kernels/base/sampler.glsl"
#include "kernels/hybrid/voxels/grid.glsl"

layout(set = 0, binding = kBindSurfaceVoxels) uniform usamplerBuffer voxels;

// Shift of the grid of a cone, two pairs; beyond the dimensions of any bounce, as those in dimensions.glsl.
const uint kDimensionConeShift = 0x04000000u;

// A voxel reaches 1 |n|_1 of its width along n from a position in it, and a shift is at most 0.5 |n|_1. A position that
// is farther than both together from a plane with the normal n lies in no voxel that the plane crosses.
const float kClearance = 1.5;
float l1_norm(vec3 v) { return dot(abs(v), vec3(1.0)); }

const float kNothing = 0.001; // less than 10 bits of opacity tell from it

struct Cone {
  vec3 origin;
  vec3 direction;    // unit length
  float t_max;       // metres
  float widening;    // width of voxels, over that of level 0, per metre from the origin
  float narrowing;   // the same, per metre from the end; kFar = any width
};

// Random shift of a cone's grid against the true one, in voxels. Across the cone alone: along it, a change of level
// would jump over what lies between.
vec3 cone_shift(Sampler s, vec3 direction) {
  vec3 shift = vec3(sample_2d(s, kDimensionConeShift), sample_2d(s, kDimensionConeShift + 1u).x) - 0.5;
  shift -= dot(shift, direction) * direction;
  return shift * (0.5 / max(0.5, max(abs(shift.x), max(abs(shift.y), abs(shift.z))))); // kClearance counts on that
}

vec3 opacity_of(SurfaceLevel level, bool has_bits, ivec3 voxel) {
  if (!is_in_level(level, voxel)) return vec3(0.0);
  uint index = index_of_voxel(level, voxel);
  if (has_bits) return vec3(texelFetch(voxels, int(level.first_word + index / 32u)).x >> index % 32u & 1u);
  return unpack_opacity(texelFetch(voxels, int(level.first_word + index)).x);
}

// What passes of a way through a voxel, if its surfaces lie anywhere in it with equal probability. Of a wall across an
// axis that is 1 - opacity * crossed, where `crossed` is the fraction of the voxel's width that lies behind; given what
// has passed where the way comes in. So a wall lets through the same, in however many voxels a slanted way crosses it.
float passing(vec3 opacity, vec3 crossed_in, vec3 crossed_out) {
  vec3 passed = (1.0 - opacity * min(crossed_out, 1.0)) / max(1.0 - opacity * crossed_in, 1e-4);
  return passed.x * passed.y * passed.z;
}

// True if a way in direction d has left the level for good.
bool has_left(SurfaceLevel level, ivec3 voxel, vec3 d) {
  return any(lessThan(mix(voxel, level.size - 1 - voxel, greaterThan(d, vec3(0.0))), ivec3(0)));
}

// A cone on its way, in voxels of level 0, and the voxel that it crosses next.
struct ConeWalk {
  vec3 origin, direction;
  float widening, narrowing, t, t_max;
  uint level_index;
  SurfaceLevel level;
  ivec3 voxel;
  vec3 crossed_in, crossed_out; // see passing()
};

ConeWalk begin_walk(SurfaceGrid grid, Cone cone) {
  ConeWalk walk;
  walk.direction = mix(cone.direction, vec3(1e-8), lessThan(abs(cone.direction), vec3(1e-8)));
  walk.origin = (cone.origin - grid.lo) / grid.voxel;
  walk.widening = cone.widening * grid.voxel;
  walk.narrowing = cone.narrowing * grid.voxel;
  walk.t = 0.0;
  walk.t_max = cone.t_max / grid.voxel;
  return walk;
}

// Goes on to the next voxel. False at the end of the cone.
bool step_cone(SurfaceGrid grid, vec3 shift, inout ConeWalk walk) {
  if (walk.t >= walk.t_max) return false;
  vec3 d = walk.direction;
  float width = min(1.0 + walk.widening * walk.t, 1.0 + walk.narrowing * (walk.t_max - walk.t));
  walk.level_index = min(uint(log2(max(width, 1.0))), grid.levels - 1u);
  walk.level = fetch_surface_level(walk.level_index);
  float size = float(1u << walk.level_index);
  vec3 p = (walk.origin + walk.t * d) / size + shift;
  walk.voxel = ivec3(floor(p));
  if (has_left(walk.level, walk.voxel, d)) return false;
  vec3 place = p - vec3(walk.voxel); // in the voxel
  vec3 to_exit = (mix(vec3(0.0), vec3(1.0), greaterThan(d, vec3(0.0))) - place) / d;
  float stretch = size * (min(to_exit.x, min(to_exit.y, to_exit.z)) + 1e-4);
  walk.crossed_in = mix(1.0 - place, place, greaterThan(d, vec3(0.0)));
  walk.crossed_out = walk.crossed_in + abs(d) * min(stretch, walk.t_max - walk.t) / size;
  walk.t += stretch;
  return true;
}

// Fraction of the cone that nothing blocks. `steps`: the most voxels that it visits.
float unblocked(SurfaceGrid grid, Cone cone, vec3 shift, uint steps) {
  ConeWalk walk = begin_walk(grid, cone);
  float passed = 1.0;
  for (uint step = 0u; step < steps && passed > kNothing && step_cone(grid, shift, walk); ++step) {
    bool has_bits = walk.level_index == 0u;
    vec3 opacity = opacity_of(walk.level, has_bits, walk.voxel);
    if (has_bits && opacity.x > 0.0) return 0.0; // as narrow as a ray
    passed *= passing(opacity, walk.crossed_in, walk.crossed_out);
  }
  return passed > kNothing ? passed : 0.0;
}

#endif
