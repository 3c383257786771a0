// The walk on devices whose lanes branch by themselves and have memory of their own that they reach fast, as GPUs do.
// The latest entry of the stack is in a register and the others in a local array; leaves wait as groups of items with a
// mask (Ylitie, Karras and Laine 2017, Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs, section
// 4). Ballots here steer only what is done first: lanes that do not run together change the time, not the result.
// bvh.glsl includes this. What was measured on a GPU: benchmarks/results/NOTES.md.
#ifndef WAVEPATH_BVH_BY_LANE_GLSL
#define WAVEPATH_BVH_BY_LANE_GLSL

uint top_entry;    // top entry of the stack; kNone: it is empty
uint kept_entries; // below it, in stack_array
uvec2 items;       // pending leaves: first item of a group, and a mask of the items to test, relative to it
uvec2 later_items; // a second pending group; empty if `items` is

void clear_lane() {
  top_entry = kNone;
  kept_entries = 0u;
  items = later_items = uvec2(0u);
}

void keep(uint entry) { stack_array[kept_entries++] = entry; }

uint recall() { return kept_entries > 0u ? stack_array[--kept_entries] : kNone; }

void push_entry(uint entry) {
  if (top_entry != kNone) keep(top_entry);
  top_entry = entry;
}

// The next node of the stack, or an entry that is no group.
uint pop_entry() {
  uint entry = top_entry;
  if (int(entry) < 0) {
    top_entry = recall();
    return entry;
  }
#ifdef ANY_HIT
  uint slot = uint(findMSB(entry & 15u));
  uint rest = entry & ~(1u << slot);
  bool last = (rest & 15u) == 0u;
#else
  uint slot = entry & 3u;
  uint rest = (entry & ~15u) | (entry >> 2u & 15u);
  bool last = (entry >> 2u & 3u) == slot;
#endif
  if (last)
    top_entry = recall();
  else
    top_entry = rest;
  return (entry >> kSlotBits) + slot;
}

uint take_item() {
  uint bit = uint(findLSB(items.y));
  uint item = items.x + bit;
  items.y &= items.y - 1u;
  if (items.y == 0u) {
    items = later_items;
    later_items.y = 0u;
  }
  return item;
}

void visit_by_lane() {
  uvec4 grid, zw;
  ivec4 t_near;
  bvec4 entered;
  enter_children(local_ray, t_best, current, grid, zw, t_near, entered);

  uint counts = grid.w >> 24u;
  uint end0 = counts & 3u, end1 = end0 + (counts >> 2u & 3u), end2 = end1 + (counts >> 4u & 3u),
       end3 = end2 + (counts >> 6u);
  uint before0 = 1u, before1 = 1u << end0, before2 = 1u << end1, before3 = 1u << end2, before4 = 1u << end3;
  uint mask = (entered.x ? before1 - before0 : 0u) | (entered.y ? before2 - before1 : 0u) |
              (entered.z ? before3 - before2 : 0u) | (entered.w ? before4 - before3 : 0u);
  if (mask != 0u) {
    if (items.y == 0u)
      items = uvec2(zw.w, mask);
    else
      later_items = uvec2(zw.w, mask);
  }

  uint inner_count = grid.w >> 21u & 7u;
#ifdef ANY_HIT
  uint inner = ((entered.x ? 1u : 0u) | (entered.y ? 2u : 0u) | (entered.z ? 4u : 0u) | (entered.w ? 8u : 0u)) &
               ((1u << inner_count) - 1u);
  if (inner == 0u) {
    current = pop_entry();
    return;
  }
  uint slot = uint(findMSB(inner));
  uint rest = inner & ~(1u << slot);
  if (rest != 0u) push_entry(zw.z << kSlotBits | rest);
#else
  uvec4 key = sort_children(t_near, entered, inner_count);
  if (key.x == kMissedKey) {
    current = pop_entry();
    return;
  }
  uint slot = key.x & 3u;
  if (key.y != kMissedKey) {
    uint third = key.z != kMissedKey ? key.z : key.y;
    uint fourth = key.w != kMissedKey ? key.w : third;
    push_entry(zw.z << kSlotBits | (key.y & 3u) | (third & 3u) << 2u | (fourth & 3u) << 4u);
  }
#endif
  current = zw.z + slot;
}

// Continues in the space of an instance; what waits in the top-level tree goes to the stack.
void enter_instance_by_lane(vec3 origin, vec3 direction) {
  if (int(current) < 0 && current != kNone) {
    instance = leaf_first(current);
  } else {
    instance = take_item();
    if (current != kNone) push_entry(current << kSlotBits | kOnlySlot0);
  }
  while (items.y != 0u) push_entry(leaf_word(take_item(), 1u));
  push_entry(kPopInstance);
  begin_instance(origin, direction);
}

void change_level_by_lane(vec3 origin, vec3 direction) {
  if (in_top_level) {
    if (items.y != 0u || (int(current) < 0 && current != kNone)) enter_instance_by_lane(origin, direction);
  } else if (current == kPopInstance) {
    in_top_level = true;
    local_ray = make_traversal_ray(origin, direction);
    current = pop_entry();
  }
}

bool may_meet_item(uint item) {
  int texel = int(item * kTriangleTexels);
  return may_meet(local_ray, moved(texelFetch(triangles, texel).xyz, texel),
                  moved(texelFetch(triangles, texel + 1).xyz, texel + 1),
                  moved(texelFetch(triangles, texel + 2).xyz, texel + 2));
}

// Most triangles are missed, and finding the position of a hit takes longer than finding that there is none: so the
// positions are found in a loop of their own, which takes few rounds.
void drop_missed() {
  uint rest = items.y, later = later_items.y;
  while ((rest | later) != 0u) {
    bool is_later = rest == 0u;
    uint mask = is_later ? later : rest;
    uint bit = uint(findLSB(mask));
    bool missed = !may_meet_item((is_later ? later_items.x : items.x) + bit);
    uint dropped = missed ? 1u << bit : 0u;
    if (is_later) {
      later &= later - 1u;
      later_items.y &= ~dropped;
    } else {
      rest &= rest - 1u;
      items.y &= ~dropped;
    }
  }
  if (items.y == 0u) {
    items = later_items;
    later_items.y = 0u;
  }
}

bool can_visit_by_lane() { return int(current) >= 0 && later_items.y == 0u; }

bool is_over_by_lane() {
#ifdef ANY_HIT
  if (best.triangle != kNone) return true;
#endif
  return current == kNone && items.y == 0u;
}

// Down to leaves until each lane has two groups of them, and through these. When few lanes go on visiting, the others
// do not wait for them.
void walk_by_lane(vec3 origin, vec3 direction, float t_max) {
  for (;;) {
    bool visiting = can_visit_by_lane();
    uint lanes = subgroupBallotBitCount(subgroupBallot(visiting));
    if (lanes == 0u) break;
    if (visiting) visit_by_lane();
    if (4u * lanes < gl_SubgroupSize) break;
  }
  if (!in_top_level) {
    drop_missed();
    while (items.y != 0u && !is_over_by_lane()) test_triangle(take_item(), t_max);
  }
  if (has_levels()) change_level_by_lane(origin, direction);
}

#endif
