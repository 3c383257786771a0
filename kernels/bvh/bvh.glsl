// Traversal of the 4-wide BVH, one ray a lane: finds the hits that bvh/traverse.h finds. Boxes: the padded slab test of
// Ize 2013. Triangles: triangle.glsl. How a lane gets from one test to the next is left to bvh_in_step.glsl or
// bvh_by_lane.glsl. Include bindings.glsl with BIND_GEOMETRY first; ray_kinds.glsl says what else to define. Kernels
// that trace include trace.glsl and enable GL_KHR_shader_subgroup_ballot.
#ifndef WAVEPATH_BVH_GLSL
#define WAVEPATH_BVH_GLSL

#include "kernels/base/config.glsl"
#include "kernels/bvh/instance.glsl"
#include "kernels/base/math.glsl"
#include "kernels/base/motion.glsl"
#include "kernels/bvh/ray_kinds.glsl"
#include "kernels/bvh/triangle.glsl"

const float kSlabPadding = 1.0 + 1.90734863e-6; // 2^-19, derived in bvh/intersect.h
const uint kMissedKey = 0xffffffffu;

// ---- what waits -----------------------------------------------------------------------------------------------------
// A stack entry is a group of siblings: the index of the first one, and the children still to be visited. For a closest
// hit these are ordered by distance, three of two bits, the last one repeated; for any hit they are a mask, the highest
// child first. Entries with the top bit set are not groups: an instance to be visited (a leaf word), the return to
// world space, or kNone, the bottom.
#ifdef ANY_HIT
const uint kSlotBits = 4u;
const uint kOnlySlot0 = 1u; // the children of a group of one
#else
const uint kSlotBits = 6u;
const uint kOnlySlot0 = 0u;
#endif
const uint kPopInstance = 0xfffffffeu;

uint stack_array[kStackSize];

uint leaf_word(uint first, uint count) { return kLeafBit | count << kLeafCountShift | first; }
uint leaf_first(uint leaf) { return leaf & kLeafFirstMask; }
uint leaf_end(uint leaf) { return (leaf & kLeafFirstMask) + (leaf >> kLeafCountShift & 7u); }

// ---- boxes ----------------------------------------------------------------------------------------------------------
ivec4 bytes_of(uint word) { return ivec4(word & 255u, word >> 8u & 255u, word >> 16u & 255u, word >> 24u); }

// Times at which the ray crosses four planes of an axis, as bits: see enter_children() in bvh/intersect.h. GPUs
// multiply and add at once, which errs by less; processors of CPU drivers need not be able to.
ivec4 crossings(uint planes, float slope, float offset) {
  vec4 cells = vec4(bytes_of(planes));
  return floatBitsToInt(kInStep ? cells * slope + offset : fma(cells, vec4(slope), vec4(offset)));
}

float cell_size(uint layout_, uint shift) {
  return uintBitsToFloat(((layout_ >> shift & 127u) + 127u - kCellBias) << 23u);
}

// Finds the children of a node that the ray enters, and at which t; also fetches the two texels that describe the
// children.
void enter_children(TraversalRay ray, float t_best, uint node, out uvec4 grid, out uvec4 zw, out ivec4 t_near,
                    out bvec4 entered) {
  int texel = int(node * kNodeTexels);
  grid = texelFetch(nodes, texel);
  uvec4 xy = texelFetch(nodes, texel + 1);
  zw = texelFetch(nodes, texel + 2);
  vec3 slope = vec3(cell_size(grid.w, 0u), cell_size(grid.w, 7u), cell_size(grid.w, 14u)) * ray.reciprocal;
  vec3 offset = (uintBitsToFloat(grid.xyz) - ray.origin) * ray.reciprocal;
  bvec3 backwards = lessThan(ray.reciprocal, vec3(0.0));
  uvec3 near_planes = mix(uvec3(xy.xz, zw.x), uvec3(xy.yw, zw.y), backwards);
  uvec3 far_planes = mix(uvec3(xy.yw, zw.y), uvec3(xy.xz, zw.x), backwards);
  t_near = max(max(crossings(near_planes.x, slope.x, offset.x), crossings(near_planes.y, slope.y, offset.y)),
               max(crossings(near_planes.z, slope.z, offset.z), ivec4(0)));
  ivec4 t_far = min(min(crossings(far_planes.x, slope.x, offset.x), crossings(far_planes.y, slope.y, offset.y)),
                    min(crossings(far_planes.z, slope.z, offset.z), ivec4(floatBitsToInt(t_best))));
  entered = lessThanEqual(intBitsToFloat(t_near), intBitsToFloat(t_far) * kSlabPadding);
}

// Keys of the inner children that the ray enters, nearest first, then kMissedKey. A key holds the number of the child
// in its low bits, so that equal distances keep their order.
uvec4 sort_children(ivec4 t_near, bvec4 entered, uint inner_count) {
  uvec4 key = mix(uvec4(kMissedKey), (uvec4(t_near) & ~3u) | uvec4(0u, 1u, 2u, 3u), entered);
  key = mix(key, uvec4(kMissedKey), greaterThanEqual(uvec4(0u, 1u, 2u, 3u), uvec4(inner_count)));
  key = uvec4(min(key.x, key.y), max(key.x, key.y), min(key.z, key.w), max(key.z, key.w));
  key = uvec4(min(key.x, key.z), min(key.y, key.w), max(key.x, key.z), max(key.y, key.w));
  return uvec4(key.x, min(key.y, key.z), max(key.y, key.z), key.w);
}

// ---- triangles ------------------------------------------------------------------------------------------------------
// State of a lane's traversal, besides its stack. `current`: the next node, an instance (a leaf word), kPopInstance, or
// kNone.
Hit best; // closest hit so far
uvec2 best_ids; // ids of its instance and triangle
float t_best;
TraversalRay local_ray; // the ray in the space of `instance`, or in the world in the top level
uint current, instance, instance_id;
bool in_top_level;

// A candidate whose alpha has to be looked up. Drivers that run both sides of every branch (Mesa 22.3) would do that
// for each triangle tested; so there a lane stops at such a candidate until no lane of its subgroup can go on without a
// look-up. GPUs look up at once: a candidate that waits takes NVIDIA's compiler 148 registers for `extend` in the place
// of 85 (benchmarks/results/compilers).
#define ALPHA_WAITS kInStep
Hit pending;
uvec2 pending_ids;
float t_pending;

// True if a hit at `t` on triangle `id` counts and is closer than the best one.
bool is_better(float t, uint id, uint flags, bool front) {
  bool better;
#ifdef ANY_HIT
  better = id != skipped_triangle || instance != skipped_instance;
#else
  bool first = instance_id < best_ids.x || (instance_id == best_ids.x && id < best_ids.y);
  better = t < t_best || (t == t_best && first);
#endif
  if (CULLS_BACKS) better = better && (front || (flags & passed_sides) == 0u);
  return better;
}

// Tests triangle `item`. Returns whether it is pending: its alpha must be looked up before anything else is tested.
bool test_triangle(uint item, float t_max) {
  int texel = int(item * kTriangleTexels);
  vec4 v0 = texelFetch(triangles, texel);
  vec4 v1 = texelFetch(triangles, texel + 1);
  vec4 v2 = texelFetch(triangles, texel + 2);
  uint flags = floatBitsToUint(v0.w), id = floatBitsToUint(v1.w);
  Candidate candidate =
      intersect_triangle(local_ray, moved(v0.xyz, texel), moved(v1.xyz, texel + 1), moved(v2.xyz, texel + 2));
  bool accepted = candidate.hit && candidate.t < t_max && is_better(candidate.t, id, flags, candidate.front);
  Hit found = Hit(item, instance, candidate.b1, candidate.b2);
  bool needs_alpha = has(TESTED_FEATURES) && accepted && (flags & TESTED_TRIANGLES) != 0u;
  if (!ALPHA_WAITS) {
    if (needs_alpha) {
      t_pending = candidate.t;
      accepted = !ALPHA_TEST(found);
    }
    needs_alpha = false;
  }
  if (needs_alpha) {
    pending = found;
    pending_ids = uvec2(instance_id, id);
    t_pending = candidate.t;
  }
  if (accepted && !needs_alpha) {
    t_best = candidate.t;
    best = found;
    best_ids = uvec2(instance_id, id);
  }
  return needs_alpha;
}

// Goes on at the root of `instance`, in its space.
void begin_instance(vec3 origin, vec3 direction) {
  uint texel = instance * kInstanceTexels;
  local_ray = make_traversal_ray(transform_point(texel, origin), transform_vector(texel, direction));
  uvec4 entry = floatBitsToUint(texelFetch(instances, int(texel + 6u)));
  current = entry.x;
  instance_id = entry.z;
  in_top_level = false;
}

// ---- the walk -------------------------------------------------------------------------------------------------------
#include "kernels/bvh/bvh_by_lane.glsl"
#include "kernels/bvh/bvh_in_step.glsl"

void begin_traversal(vec3 origin, vec3 direction, float t_max) {
  bool valid = is_traceable(origin, direction);
  if (kInStep)
    clear_step();
  else
    clear_lane();
  best = pending = Hit(kNone, 0u, 0.0, 0.0);
  best_ids = pending_ids = uvec2(kNone);
  t_best = t_max;
  t_pending = 0.0;
  local_ray = make_traversal_ray(origin, direction);
  current = valid ? frame.root : kNone;
  instance = instance_id = 0u;
  in_top_level = has_levels();
}

Hit traverse(vec3 origin, vec3 direction, float t_max) {
  begin_traversal(origin, direction, t_max);
  if (kInStep)
    trace_in_step(origin, direction, t_max);
  else
    while (!is_over_by_lane()) walk_by_lane(origin, direction, t_max);
  return best;
}

#endif
