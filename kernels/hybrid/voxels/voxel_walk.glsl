// The voxels that a triangle crosses: those that no axis separates from it (Akenine-Moeller 2001), in the order of
// Schwarz and Seidel 2010: for every column along the axis of the normal's largest component the range that the
// triangle's plane crosses, then the triangle's edges in all three projections. Include bindings.glsl with
// BIND_GEOMETRY first, and define meet().
#ifndef WAVEPATH_VOXEL_WALK_GLSL
#define WAVEPATH_VOXEL_WALK_GLSL

#include "kernels/base/config.glsl"
#include "kernels/bvh/instance.glsl"
#include "kernels/bvh/triangle.glsl"
#include "kernels/hybrid/voxels/grid.glsl"

layout(set = 0, binding = kBindSurfaceItems) uniform usamplerBuffer voxel_items;

// What to do with a voxel of level 0, by its index.
void meet(uint index);

// Error of the cross product of two edges, relative to the product of their lengths.
const float kNormalError = 9.5367432e-7; // 2^-20

// Position of a corner, in voxels of level 0.
vec3 grid_corner(SurfaceGrid grid, uint triangle, uint instance, uint corner) {
  vec3 p = texelFetch(triangles, int(triangle * kTriangleTexels + corner)).xyz;
  if (has(kFeatureInstances) && frame.root_is_top != 0u) p = transform_point(instance * kInstanceTexels + 3u, p);
  return (p - grid.lo) / grid.voxel;
}

// The three edges of a triangle in one projection: a point of each, the axis across it, and where the opposite corner
// lies on this axis. An edge that is seen end-on has a random axis, which separates as little as any other.
struct Edges {
  vec2 from[3];
  vec2 across[3];
  float opposite[3];
};

Edges edges_of(vec2 a, vec2 b, vec2 c) {
  Edges edges;
  edges.from[0] = a;
  edges.from[1] = b;
  edges.from[2] = c;
  edges.across[0] = vec2(a.y - b.y, b.x - a.x);
  edges.across[1] = vec2(b.y - c.y, c.x - b.x);
  edges.across[2] = vec2(c.y - a.y, a.x - c.x);
  edges.opposite[0] = dot(edges.across[0], c - a);
  edges.opposite[1] = dot(edges.across[1], a - b);
  edges.opposite[2] = dot(edges.across[2], b - c);
  return edges;
}

// True unless the axis across one of the edges separates the square from the triangle.
bool may_cross(Edges edges, vec2 square, float margin) {
  for (uint i = 0u; i < 3u; ++i) {
    vec2 axis = edges.across[i];
    float middle = dot(axis, square + 0.5 - edges.from[i]), reach = (0.5 + margin) * (abs(axis.x) + abs(axis.y));
    if (middle + reach < min(edges.opposite[i], 0.0) || middle - reach > max(edges.opposite[i], 0.0)) return false;
  }
  return true;
}

ivec3 from_sheared_axes(ivec3 v, uint axis) { return axis == 2u ? v.xyz : axis == 0u ? v.zxy : v.yzx; }

// Calls meet() for every voxel of the item's rows that its triangle crosses.
void walk_item(uvec4 item) {
  uint axis = item.w >> kSurfaceAxisShift, rows = item.w & ((1u << kSurfaceAxisShift) - 1u);
  SurfaceGrid grid = fetch_surface_grid();
  SurfaceLevel level = fetch_surface_level(0u);
  float margin = grid.margin;
  // x: columns, y: rows, z: along the normal.
  vec3 a = to_sheared_axes(grid_corner(grid, item.x, item.y, 0u), axis),
       b = to_sheared_axes(grid_corner(grid, item.x, item.y, 1u), axis),
       c = to_sheared_axes(grid_corner(grid, item.x, item.y, 2u), axis);
  ivec3 size = ivec3(to_sheared_axes(vec3(level.size), axis));
  ivec3 first = max(ivec3(floor(min(min(a, b), c) - margin)), ivec3(0));
  ivec3 last = min(ivec3(floor(max(max(a, b), c) + margin)), size - 1);
  vec3 normal = cross(b - a, c - a);
  float slack = kNormalError * length(b - a) * length(c - a) * (length(b - a) + length(c - a) + 1.0);
  // Depth of the plane: d(depth) / d(column), d(row), and half of the range over a column.
  vec2 slope = -normal.xy / normal.z;
  float reach = 0.5 * (abs(slope.x) + abs(slope.y)) + margin * (abs(slope.x) + abs(slope.y) + 1.0) +
                slack / abs(normal.z);
  bool has_plane = reach < float(size.z); // false of a sliver, NaN included
  Edges across = edges_of(a.xy, b.xy, c.xy), by_row = edges_of(a.yz, b.yz, c.yz),
        by_column = edges_of(a.xz, b.xz, c.xz);
  for (int row = int(item.z); row < int(item.z + rows) && row <= last.y; ++row)
    for (int column = first.x; column <= last.x; ++column) {
      if (!may_cross(across, vec2(column, row), margin)) continue;
      float middle = a.z + dot(slope, vec2(column, row) + 0.5 - a.xy);
      int near = first.z, far = last.z;
      if (has_plane) {
        near = max(near, int(floor(middle - reach)));
        far = min(far, int(floor(middle + reach)));
      }
      for (int depth = near; depth <= far; ++depth) {
        if (!may_cross(by_row, vec2(row, depth), margin)) continue;
        if (!may_cross(by_column, vec2(column, depth), margin)) continue;
        meet(index_of_voxel(level, from_sheared_axes(ivec3(column, row, depth), axis)));
      }
    }
}

#endif
