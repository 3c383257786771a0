// Traversal of the 4-wide BVH, one ray a lane: the same algorithm and order as bvh/traverse.h, which describes them.
// Boxes: the padded slab test of Ize 2013. Triangles: triangle.glsl. Include bindings.glsl with BIND_GEOMETRY first;
// ray_kinds.glsl says what else to define. Kernels that trace include trace.glsl.
#ifndef WAVEPATH_BVH_GLSL
#define WAVEPATH_BVH_GLSL

#include "kernels/config.glsl"
#include "kernels/instance.glsl"
#include "kernels/math.glsl"
#include "kernels/motion.glsl"
#include "kernels/ray_kinds.glsl"
#include "kernels/triangle.glsl"

const float kSlabPadding = 1.0 + 1.90734863e-6; // 2^-19, derived in bvh/intersect.h
const uint kMissedKey = 0xffffffffu;

// ---- the stack ------------------------------------------------------------------------------------------------------
// A stack entry is a group of siblings: the index of the first one, and the children still to be visited. For a closest
// hit these are ordered by distance, three of two bits, the last one repeated; for any hit they are a mask, the highest
// child first. Entries with the top bit set are not groups: an instance to be visited (a leaf word), the return to
// world space, or kNone, the bottom.
// CPU drivers run all lanes of a subgroup in step and write a local array lane by lane, which takes longer than the
// rest of a visit. So the top of the stack is in registers there, moved by selects, and the array takes what overflows
// (on Sponza, less than one ray in a thousand). Where local arrays are cheap, they hold all of it.
#ifdef ANY_HIT
const uint kSlotBits = 4u;
const uint kOnlySlot0 = 1u; // the children of a group of one
#else
const uint kSlotBits = 6u;
const uint kOnlySlot0 = 0u;
#endif
const uint kPopInstance = 0xfffffffeu;

uvec4 stack_top, stack_below; // kStackInRegisters
uint stack_array[kStackSize];
uint stack_size; // entries in the array
uvec4 leaves; // leaf words to be tested, latest first
uint last_leaf; // a fifth leaf word

void clear_waiting() {
  stack_top = stack_below = leaves = uvec4(kNone);
  last_leaf = kNone;
  stack_array[0] = kNone;
  stack_size = kStackInRegisters ? 0u : 1u;
}

bool stack_is_full() { return kStackInRegisters && stack_below.w != kNone; }

// Needs room: !stack_is_full().
void push(bool wanted, uint entry) {
  if (kStackInRegisters) {
    stack_below = mix(stack_below, uvec4(stack_top.w, stack_below.xyz), bvec4(wanted));
    stack_top = mix(stack_top, uvec4(entry, stack_top.xyz), bvec4(wanted));
  } else { // stored without a branch, kept by moving the top
    stack_array[stack_size] = entry;
    stack_size += uint(wanted);
  }
}

// Moves the lowest register to the array.
void spill() {
  if (kStackInRegisters && stack_below.w != kNone) {
    stack_array[stack_size++] = stack_below.w;
    stack_below.w = kNone;
  }
}
#ifdef ANY_HIT
uint first_slot(uint mask) { return (mask & 8u) != 0u ? 3u : (mask & 4u) != 0u ? 2u : mask >> 1u; }
#endif

// Where `wanted`, the next node to visit, or an entry that is no group.
void pop(bool wanted, inout uint current) {
  uint entry = kStackInRegisters ? stack_top.x : stack_array[stack_size - 1u];
#ifdef ANY_HIT
  uint slot = first_slot(entry & 15u);
  uint rest = entry & ~(1u << slot);
  bool last = (rest & 15u) == 0u;
#else
  uint slot = entry & 3u;
  uint rest = (entry & ~15u) | (entry >> 2u & 15u);
  bool last = (entry >> 2u & 3u) == slot;
#endif
  bool special = int(entry) < 0;
  current = wanted ? (special ? entry : (entry >> kSlotBits) + slot) : current;
  bool leaves_stack = wanted && (special || last);
  if (kStackInRegisters) {
    stack_top.x = wanted ? rest : stack_top.x;
    stack_top = mix(stack_top, uvec4(stack_top.yzw, stack_below.x), bvec4(leaves_stack));
    stack_below = mix(stack_below, uvec4(stack_below.yzw, kNone), bvec4(leaves_stack));
  } else if (wanted && entry != kNone) {
    stack_array[stack_size - 1u] = rest;
    stack_size -= uint(leaves_stack);
  }
}

// The same, where the registers may be empty while the array is not.
void take_next(bool wanted, inout uint current) {
  if (kStackInRegisters && wanted && stack_top.x == kNone && stack_size > 0u) stack_top.x = stack_array[--stack_size];
  pop(wanted, current);
}

uint leaf_word(uint first, uint count) { return kLeafBit | count << kLeafCountShift | first; }
uint leaf_first(uint leaf) { return leaf & kLeafFirstMask; }
uint leaf_end(uint leaf) { return (leaf & kLeafFirstMask) + (leaf >> kLeafCountShift & 7u); }

void add_leaf(bool wanted, uint leaf) {
  last_leaf = wanted ? leaves.w : last_leaf;
  leaves = mix(leaves, uvec4(leaf, leaves.xyz), bvec4(wanted));
}

void take_leaf() {
  leaves = uvec4(leaves.yzw, last_leaf);
  last_leaf = kNone;
}

// ---- a visit --------------------------------------------------------------------------------------------------------
ivec4 bytes_of(uint word) { return ivec4(word & 255u, word >> 8u & 255u, word >> 16u & 255u, word >> 24u); }

// Times at which the ray crosses four planes of an axis, as bits: see enter_children() in bvh/intersect.h.
ivec4 crossings(uint planes, float slope, float offset) {
  return floatBitsToInt(vec4(bytes_of(planes)) * slope + offset);
}

float cell_size(uint layout_, uint shift) {
  return uintBitsToFloat(((layout_ >> shift & 127u) + 127u - kCellBias) << 23u);
}

// Tests the children of node `current`, pushes those that the ray enters, and moves on to the next node.
void visit(TraversalRay ray, float t_best, inout uint current) {
  int texel = int(current * kNodeTexels);
  uvec4 grid = texelFetch(nodes, texel), xy = texelFetch(nodes, texel + 1), zw = texelFetch(nodes, texel + 2);
  vec3 slope = vec3(cell_size(grid.w, 0u), cell_size(grid.w, 7u), cell_size(grid.w, 14u)) * ray.reciprocal;
  vec3 offset = (uintBitsToFloat(grid.xyz) - ray.origin) * ray.reciprocal;
  bvec3 backwards = lessThan(ray.reciprocal, vec3(0.0));
  uvec3 near_planes = mix(uvec3(xy.xz, zw.x), uvec3(xy.yw, zw.y), backwards);
  uvec3 far_planes = mix(uvec3(xy.yw, zw.y), uvec3(xy.xz, zw.x), backwards);
  ivec4 t_near = max(max(crossings(near_planes.x, slope.x, offset.x), crossings(near_planes.y, slope.y, offset.y)),
                     max(crossings(near_planes.z, slope.z, offset.z), ivec4(0)));
  ivec4 t_far = min(min(crossings(far_planes.x, slope.x, offset.x), crossings(far_planes.y, slope.y, offset.y)),
                    min(crossings(far_planes.z, slope.z, offset.z), ivec4(floatBitsToInt(t_best))));
  bvec4 entered = lessThanEqual(intBitsToFloat(t_near), intBitsToFloat(t_far) * kSlabPadding);

  uvec4 count = grid.wwww >> uvec4(24u, 26u, 28u, 30u) & 3u;
  bvec4 leaf = notEqual(count, uvec4(0u));
  uint item1 = zw.w + count.x, item2 = item1 + count.y, item3 = item2 + count.z;
  add_leaf(entered.w && leaf.w, leaf_word(item3, count.w));
  add_leaf(entered.z && leaf.z, leaf_word(item2, count.z));
  add_leaf(entered.y && leaf.y, leaf_word(item1, count.y));
  add_leaf(entered.x && leaf.x, leaf_word(zw.w, count.x));

  uint inner_count = grid.w >> 21u & 7u;
#ifdef ANY_HIT
  uvec4 bits = mix(uvec4(0u), uvec4(1u, 2u, 4u, 8u), entered);
  uint mask = (bits.x | bits.y | bits.z | bits.w) & ((1u << inner_count) - 1u);
  bool found = mask != 0u;
  uint slot = first_slot(mask);
  uint rest = mask & ~(1u << slot);
  push(rest != 0u && found, zw.z << kSlotBits | rest);
#else
  // Nearest child first. The key holds the number of the child in its low bits, so that equal distances keep their
  // order.
  uvec4 key = mix(uvec4(kMissedKey), (uvec4(t_near) & ~3u) | uvec4(0u, 1u, 2u, 3u), entered);
  key = mix(key, uvec4(kMissedKey), greaterThanEqual(uvec4(0u, 1u, 2u, 3u), uvec4(inner_count)));
  key = uvec4(min(key.x, key.y), max(key.x, key.y), min(key.z, key.w), max(key.z, key.w));
  key = uvec4(min(key.x, key.z), min(key.y, key.w), max(key.x, key.z), max(key.y, key.w));
  key = uvec4(key.x, min(key.y, key.z), max(key.y, key.z), key.w);
  bool found = key.x != kMissedKey;
  uint slot = key.x & 3u;
  uint third = key.z != kMissedKey ? key.z : key.y;
  uint fourth = key.w != kMissedKey ? key.w : third;
  push(key.y != kMissedKey, zw.z << kSlotBits | (key.y & 3u) | (third & 3u) << 2u | (fourth & 3u) << 4u);
#endif
  current = zw.z + slot;
  pop(!found, current);
}

// ---- traversal ------------------------------------------------------------------------------------------------------
// What a lane knows on its way, besides its stack. `current`: the next node, an instance (a leaf word), kPopInstance, or
// kNone.
Hit best; // so far
uvec2 best_ids; // of its instance and triangle
float t_best;
TraversalRay local_ray; // in the space of `instance`, or of the world in the top level
uint current, instance, instance_id;
bool in_top_level;

// A candidate whose alpha has to be looked up. Drivers that run both sides of every branch (Mesa 22.3) would do that
// for each triangle tested; so there a lane stops at such a candidate until no lane of its subgroup can go on without a
// look-up. GPUs look up at once: a candidate that waits takes NVIDIA's compiler 148 registers for `extend` in the place of
// 85 (benchmarks/results/compilers).
#define ALPHA_WAITS kStackInRegisters
Hit pending;
uvec2 pending_ids;
float t_pending;

bool is_over() {
#ifdef ANY_HIT
  if (best.triangle != kNone) return true;
#endif
  return current == kNone && leaves.x == kNone;
}

// Whether a hit at `t` on triangle `id` counts, and comes before the best one.
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
  Candidate candidate = intersect_triangle(local_ray, moved(v0.xyz, texel), moved(v1.xyz, texel + 1), moved(v2.xyz, texel + 2));
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

// Tests the triangles of all leaves that wait, or those before one that is pending.
void test_leaves(float t_max) {
  uint item = leaf_first(leaves.x), end = leaf_end(leaves.x);
  bool testing = leaves.x != kNone && !in_top_level;
  while (testing) {
    bool needs_alpha = test_triangle(item, t_max);
    ++item;
    if (has(TESTED_FEATURES)) leaves.x = needs_alpha ? leaf_word(item, end - item) : leaves.x; // the rest of the leaf waits
    if (item == end) {
      take_leaf();
      item = leaf_first(leaves.x);
      end = leaf_end(leaves.x);
    }
    testing = leaves.x != kNone && !needs_alpha;
#ifdef ANY_HIT
    testing = testing && best.triangle == kNone;
#endif
  }
}

// Continues in the space of the latest instance that waits; the rest of the top-level tree goes to the stack.
void enter_instance(vec3 origin, vec3 direction) {
  instance = leaf_first(leaves.x);
  take_leaf();
  spill();
  push(current != kNone, int(current) < 0 ? current : current << kSlotBits | kOnlySlot0);
  while (leaves.x != kNone) {
    spill();
    push(true, leaves.x);
    take_leaf();
  }
  spill();
  push(true, kPopInstance);
  uint texel = instance * kInstanceTexels;
  local_ray = make_traversal_ray(transform_point(texel, origin), transform_vector(texel, direction));
  uvec4 entry = floatBitsToUint(texelFetch(instances, int(texel + 6u)));
  current = entry.x;
  instance_id = entry.z;
  in_top_level = false;
}

// Between the tree of instances and their trees of triangles. An instance from the stack joins the leaf words.
void change_level(vec3 origin, vec3 direction) {
  bool is_instance = in_top_level && int(current) < 0 && current != kNone;
  add_leaf(is_instance, current);
  take_next(is_instance, current);
  if (in_top_level && leaves.x != kNone) {
    enter_instance(origin, direction);
  } else if (current == kPopInstance && leaves.x == kNone) {
    in_top_level = true;
    local_ray = make_traversal_ray(origin, direction);
    take_next(true, current);
  }
}

// The pending candidate becomes the best hit if it is no hole.
void look_up_alpha() {
  if (pending.triangle != kNone && !ALPHA_TEST(pending)) {
    t_best = t_pending;
    best = pending;
    best_ids = pending_ids;
  }
  pending.triangle = kNone;
}

bool can_visit() { return int(current) >= 0 && leaves.y == kNone && !stack_is_full(); }

// Down to leaves. A driver that runs all lanes in step executes the body of a loop once more for lanes that are all done,
// unless the loop is tested at its end; compilers of GPUs take fewer registers for the plain one.
void visit_nodes() {
  if (!kStackInRegisters) {
    while (can_visit()) visit(local_ray, t_best, current);
    return;
  }
  bool visiting = can_visit();
  do {
    if (visiting) visit(local_ray, t_best, current);
    visiting = can_visit();
  } while (visiting);
}

// Down to leaves, through these, and on to what waits on the stack. Returns whether the ray has been traced.
bool walk(vec3 origin, vec3 direction, float t_max) {
  visit_nodes();
  test_leaves(t_max);
  spill();
  take_next(current == kNone, current);
  if (has_levels()) change_level(origin, direction);
  return is_over();
}

Hit traverse(vec3 origin, vec3 direction, float t_max) {
  const Hit none = Hit(kNone, 0u, 0.0, 0.0);
  bool valid = is_traceable(origin, direction);
  clear_waiting();
  best = pending = none;
  best_ids = pending_ids = uvec2(kNone);
  t_best = t_max;
  t_pending = 0.0;
  local_ray = make_traversal_ray(origin, direction);
  current = valid ? frame.root : kNone;
  instance = instance_id = 0u;
  in_top_level = has_levels();
  bool done = !valid;
  do {
    if (kStackInRegisters) { // as in visit_nodes()
      do done = walk(origin, direction, t_max);
      while (!done && pending.triangle == kNone);
    } else {
      while (!done) done = walk(origin, direction, t_max);
    }
    if (ALPHA_WAITS && has(TESTED_FEATURES)) {
      look_up_alpha();
#ifdef ANY_HIT
      done = done || best.triangle != kNone;
#endif
    }
  } while (!done);
  return best;
}

#endif
