// An 8-wide BVH of compressed nodes (Ylitie, Karras, Laine 2017), five texels a node, which host/bench/structures/
// wide_tree.cpp describes. Traversal goes as in kernels/bvh/bvh.glsl: nearest child first, for any hit the largest;
// items of a node that the ray enters wait until all lanes have some, or are done.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/bench/structure.glsl"

const uint kMostDepth = 64u;                // as bvh/binary.h has it
const float kPadding = 1.0 + 1.90734863e-6; // as in kernels/bvh/bvh.glsl
const uint kCellBias = 66u;                 // as in bvh/wide.h
const uint kNodeTexels = 5u;
const uint kMissedKey = 0xffffffffu;

// ---- the stack ------------------------------------------------------------------------------------------------------
// An entry is a group of siblings: the node of the first, and the order of those still to be visited, 0 where there is
// none. For a closest hit an order is slots by distance, three bits each, with their number in the top byte; for any
// hit it is a mask of slots, the highest first. The top entry is the group that the ray is in. Where kStackInRegisters,
// six entries are in registers (with four, rays on Sponza take 5 to 10 % longer) and the array takes what overflows.
// Otherwise it holds all but the top.
uvec3 firsts, firsts_below;
uvec3 orders, orders_below;
uvec2 stack_array[kMostDepth];
uint stack_size; // entries in the array

bool stack_is_full() { return kStackInRegisters && orders_below.z != 0u; }

uint take_slot(inout uint order) {
  if (kAnyHit) {
    uint highest = uint(findMSB(order));
    order &= ~(1u << highest);
    return highest;
  }
  uint nearest = order & 7u;
  order = (order & 0xffffffu) >> 3u | (order & 0xff000000u) - 0x1000000u;
  return nearest;
}

// On to the group of a node's children, if its order is not 0, and to what waits if nothing else is left of the top.
void enter_group(uint first, uint order) {
  bool found = order != 0u, stays = orders.x != 0u;
  bool pushes = found && stays, pops = !found && !stays;
  if (kStackInRegisters) {
    firsts_below = mix(firsts_below, uvec3(firsts.z, firsts_below.xy), bvec3(pushes));
    orders_below = mix(orders_below, uvec3(orders.z, orders_below.xy), bvec3(pushes));
    firsts = mix(firsts, uvec3(0u, firsts.xy), bvec3(pushes));
    orders = mix(orders, uvec3(0u, orders.xy), bvec3(pushes));
    firsts = mix(firsts, uvec3(firsts.yz, firsts_below.x), bvec3(pops));
    orders = mix(orders, uvec3(orders.yz, orders_below.x), bvec3(pops));
    firsts_below = mix(firsts_below, uvec3(firsts_below.yz, 0u), bvec3(pops));
    orders_below = mix(orders_below, uvec3(orders_below.yz, 0u), bvec3(pops));
  } else if (pushes) {
    stack_array[stack_size++] = uvec2(firsts.x, orders.x);
  } else if (pops && stack_size > 0u) {
    uvec2 entry = stack_array[--stack_size];
    firsts.x = entry.x;
    orders.x = entry.y;
  }
  firsts.x = found ? first : firsts.x;
  orders.x = found ? order : orders.x;
}

// Moves the lowest register to the array, or the top of the array to registers that are empty.
void balance_stack() {
  if (!kStackInRegisters) return;
  if (orders_below.z != 0u) {
    stack_array[stack_size++] = uvec2(firsts_below.z, orders_below.z);
    orders_below.z = 0u;
  }
  if (orders.x == 0u && stack_size > 0u) {
    uvec2 entry = stack_array[--stack_size];
    firsts.x = entry.x;
    orders.x = entry.y;
  }
}

// ---- a visit --------------------------------------------------------------------------------------------------------
// Items of the node visited last: the first, and by slot, three bits each, those that wait and all that the node has.
uint first_item, waiting_items, all_items;

// What each slot stands for in a node's word of children: its items, and whether it is a node.
const uvec4 kLowerSlots = uvec4(0x01000007u, 0x02000038u, 0x040001c0u, 0x08000e00u);
const uvec4 kUpperSlots = uvec4(0x10007000u, 0x20038000u, 0x401c0000u, 0x80e00000u);

float cell_size(uint layout_, uint shift) {
  return uintBitsToFloat(((layout_ >> shift & 127u) + 127u - kCellBias) << 23u);
}

ivec4 crossings(uint planes, float slope, float offset) {
  vec4 cells = vec4(planes & 255u, planes >> 8u & 255u, planes >> 16u & 255u, planes >> 24u);
  // As in bvh.glsl.
  return floatBitsToInt(kStackInRegisters ? cells * slope + offset : fma(cells, vec4(slope), vec4(offset)));
}

// Tests four children. Returns the slots of those that the ray enters; their keys grow with the distance.
uint enter_children(uvec3 near_planes, uvec3 far_planes, vec3 slope, vec3 offset, uvec4 slots, uvec4 numbers,
                    out uvec4 keys) {
  ivec4 t_near = max(max(crossings(near_planes.x, slope.x, offset.x), crossings(near_planes.y, slope.y, offset.y)),
                     max(crossings(near_planes.z, slope.z, offset.z), ivec4(0)));
  ivec4 t_far = min(min(crossings(far_planes.x, slope.x, offset.x), crossings(far_planes.y, slope.y, offset.y)),
                    min(crossings(far_planes.z, slope.z, offset.z), ivec4(floatBitsToInt(t_best))));
  bvec4 entered = lessThanEqual(intBitsToFloat(t_near), intBitsToFloat(t_far) * kPadding);
  keys = mix(uvec4(kMissedKey), (uvec4(t_near) & ~7u) | numbers, entered);
  slots = mix(uvec4(0u), slots, entered);
  return slots.x | slots.y | slots.z | slots.w;
}

void sort(inout uint a, inout uint b) {
  uint least = min(a, b);
  b = max(a, b);
  a = least;
}

// The order of `count` keys out of eight, by a network of 19 comparisons.
uint sorted_order(uvec4 a, uvec4 b, uint count) {
  sort(a.x, a.z); sort(a.y, a.w); sort(b.x, b.z); sort(b.y, b.w);
  sort(a.x, b.x); sort(a.y, b.y); sort(a.z, b.z); sort(a.w, b.w);
  sort(a.x, a.y); sort(a.z, a.w); sort(b.x, b.y); sort(b.z, b.w);
  sort(a.z, b.x); sort(a.w, b.y);
  sort(a.y, b.x); sort(a.w, b.z);
  sort(a.y, a.z); sort(a.w, b.x); sort(b.y, b.z);
  a = (a & 7u) << uvec4(0u, 3u, 6u, 9u);
  b = (b & 7u) << uvec4(12u, 15u, 18u, 21u);
  return (a.x | a.y | a.z | a.w | b.x | b.y | b.z | b.w) & ((1u << 3u * count) - 1u) | count << 24u;
}

// Visits the next node of the top group.
void visit() {
  count_visit();
  int texel = int((firsts.x + take_slot(orders.x)) * kNodeTexels);
  uvec4 grid = texelFetch(nodes, texel), children = texelFetch(nodes, texel + 1);
  uvec4 x = texelFetch(nodes, texel + 2), y = texelFetch(nodes, texel + 3), z = texelFetch(nodes, texel + 4);
  vec3 slope = vec3(cell_size(grid.w, 0u), cell_size(grid.w, 7u), cell_size(grid.w, 14u)) * ray.reciprocal;
  vec3 offset = (uintBitsToFloat(grid.xyz) - ray.origin) * ray.reciprocal;
  x = ray.reciprocal.x < 0.0 ? x.zwxy : x;
  y = ray.reciprocal.y < 0.0 ? y.zwxy : y;
  z = ray.reciprocal.z < 0.0 ? z.zwxy : z;
  uvec4 lower, upper;
  uint entered = enter_children(uvec3(x.x, y.x, z.x), uvec3(x.z, y.z, z.z), slope, offset, kLowerSlots,
                                uvec4(0u, 1u, 2u, 3u), lower) |
                 enter_children(uvec3(x.y, y.y, z.y), uvec3(x.w, y.w, z.w), slope, offset, kUpperSlots,
                                uvec4(4u, 5u, 6u, 7u), upper);
  entered &= children.z;
  first_item = children.y;
  waiting_items = entered & 0xffffffu;
  all_items = children.z & 0xffffffu;
  uint order = entered >> 24u;
  if (!kAnyHit) { // keys of leaves become those of children that are not there
    lower |= ~uvec4(ivec4(children.zzzz << uvec4(7u, 6u, 5u, 4u)) >> 31);
    upper |= ~uvec4(ivec4(children.zzzz << uvec4(3u, 2u, 1u, 0u)) >> 31);
    order = sorted_order(lower, upper, uint(bitCount(order)));
  }
  enter_group(children.x, order);
}

bool can_visit() { return orders.x != 0u && waiting_items == 0u && !stack_is_full(); }

// As in kernels/bvh/bvh.glsl: what loops cost depends on the driver.
void visit_nodes() {
  if (!kStackInRegisters) {
    while (can_visit()) visit();
    return;
  }
  bool visiting = can_visit();
  do {
    if (visiting) visit();
    visiting = can_visit();
  } while (visiting);
}

void test_waiting_items() {
  bool testing = waiting_items != 0u;
  while (testing) {
    uint lowest = waiting_items & (~waiting_items + 1u);
    test_triangle(first_item + uint(bitCount(all_items & (lowest - 1u))));
    waiting_items ^= lowest;
    testing = waiting_items != 0u && !is_over();
  }
}

void traverse(float t_enter, float t_exit) {
  firsts = firsts_below = orders_below = uvec3(0u);
  orders = uvec3(kAnyHit ? 1u : 1u << 24u, 0u, 0u); // the root, as an only child
  waiting_items = stack_size = 0u;
  bool goes_on = true;
  do {
    visit_nodes();
    test_waiting_items();
    balance_stack();
    goes_on = orders.x != 0u && !is_over();
  } while (goes_on);
}
