// The way of a ray through the volume's cells, which know the largest and the smallest density within (Amanatides and
// Woo 1987, "A Fast Voxel Traversal Algorithm"). Include kernels/volume/bindings.glsl first.
#ifndef WAVEPATH_VOLUME_CELLS_GLSL
#define WAVEPATH_VOLUME_CELLS_GLSL

#include "kernels/base/frame_types.h"
#include "kernels/volume/voxels.glsl"

// Distances are counted from where the ray enters the box, so that they are fine however far away its origin is; in
// units of the ray's `t`.
struct CellWalk {
  vec3 origin, direction; // in the space of cells
  ivec3 cell, cells;      // the cell that it is in, and the number of cells along each axis
  int first_cell;         // texel of the first one
  vec3 exits;  // distances to the planes where the ray leaves the cell
  float start; // t of the entry into the box
  float at, end;
};

float smallest(vec3 v) { return min(v.x, min(v.y, v.z)); }

// Distance to the plane where the ray leaves the cell along each axis. Computed from the cell, not added up.
vec3 exits_of(CellWalk walk) {
  vec3 plane = vec3(walk.cell) + vec3(greaterThan(walk.direction, vec3(0.0)));
  vec3 distance_ = (plane - walk.origin) / walk.direction;
  return mix(distance_, vec3(kFar), lessThan(abs(walk.direction), vec3(1e-30)));
}

// False if the ray misses the box before `t_max`.
bool begin_walk(vec3 origin, vec3 direction, float t_max, out CellWalk walk) {
  uvec4 cells = volume_words(kVolumeCells);
  walk.cells = ivec3(cells.xyz);
  walk.first_cell = int(cells.w);
  walk.direction = volume_transform(kVolumeCellsFromWorld, direction, 0.0);
  walk.origin = volume_transform(kVolumeCellsFromWorld, origin, 1.0);
  vec3 side = vec3(walk.cells);
  float enter = 0.0, leave = t_max;
  for (int axis = 0; axis < 3; ++axis) {
    if (abs(walk.direction[axis]) < 1e-30) {
      if (!(walk.origin[axis] >= 0.0 && walk.origin[axis] <= side[axis])) return false;
      continue;
    }
    float a = -walk.origin[axis] / walk.direction[axis], b = (side[axis] - walk.origin[axis]) / walk.direction[axis];
    enter = max(enter, min(a, b));
    leave = min(leave, max(a, b));
  }
  if (!(enter < leave)) return false;
  walk.origin += enter * walk.direction;
  walk.cell = clamp(ivec3(floor(walk.origin)), ivec3(0), walk.cells - 1);
  walk.start = enter;
  walk.at = 0.0;
  walk.end = leave - enter;
  walk.exits = exits_of(walk);
  return true;
}

// Distance at which the ray leaves the cell, or ends.
float end_of_cell(CellWalk walk) { return max(min(smallest(walk.exits), walk.end), walk.at); }

// The largest and the smallest density in the cell.
vec2 cell_bounds(CellWalk walk) {
  int texel = walk.first_cell + walk.cell.x + walk.cells.x * (walk.cell.y + walk.cells.y * walk.cell.z);
  return uintBitsToFloat(texelFetch(volume_grid, texel).xy);
}

// Goes on to the next cell; false if the ray has ended.
bool next_cell(inout CellWalk walk) {
  walk.at = end_of_cell(walk);
  if (!(walk.at < walk.end)) return false;
  bvec3 leaves = lessThanEqual(walk.exits, vec3(walk.at));
  walk.cell += ivec3(leaves) * ivec3(sign(walk.direction));
  if (any(lessThan(walk.cell, ivec3(0))) || any(greaterThanEqual(walk.cell, walk.cells))) return false;
  walk.exits = exits_of(walk);
  return true;
}

// The point that the walk has come to, in the space of cells. Within the cell in spite of rounding, so that its bounds
// hold.
vec3 walked_to(CellWalk walk) {
  vec3 lo = vec3(walk.cell);
  return clamp(walk.origin + walk.at * walk.direction, lo, lo + 0.999999);
}

// The same in coordinates of voxels of density.
vec3 voxel_point(vec3 cells_point) {
  vec4 first = volume_floats(kVolumeFirstVoxel);
  return cells_point * first.w + first.xyz;
}

#endif
