// The walk on devices that run all lanes of a subgroup in step, as CPU drivers do: the algorithm and order of
// bvh/traverse.h. Such a driver writes a local array lane by lane, which takes longer than the rest of a visit, and
// runs both sides of every branch. So the top of the stack is in registers, moved by selects, and the array takes what
// overflows (on Sponza, less than one ray in a thousand). bvh.glsl includes this.
#ifndef WAVEPATH_BVH_IN_STEP_GLSL
#define WAVEPATH_BVH_IN_STEP_GLSL

uvec4 stack_top, stack_below;
uint stack_size; // entries in stack_array
uvec4 leaves;    // leaf words to be tested, latest first
uint last_leaf;  // a fifth leaf word

void clear_step() {
  stack_top = stack_below = leaves = uvec4(kNone);
  last_leaf = kNone;
  stack_size = 0u;
}

bool stack_is_full() { return stack_below.w != kNone; }

// Needs room: !stack_is_full().
void push(bool wanted, uint entry) {
  stack_below = mix(stack_below, uvec4(stack_top.w, stack_below.xyz), bvec4(wanted));
  stack_top = mix(stack_top, uvec4(entry, stack_top.xyz), bvec4(wanted));
}

// Moves the lowest register to the array.
void spill() {
  if (stack_below.w != kNone) {
    stack_array[stack_size++] = stack_below.w;
    stack_below.w = kNone;
  }
}
#ifdef ANY_HIT
uint first_slot(uint mask) { return (mask & 8u) != 0u ? 3u : (mask & 4u) != 0u ? 2u : mask >> 1u; }
#endif

// Where `wanted`, the next node to visit, or an entry that is no group.
void pop(bool wanted, inout uint current) {
  uint entry = stack_top.x;
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
  stack_top.x = wanted ? rest : stack_top.x;
  stack_top = mix(stack_top, uvec4(stack_top.yzw, stack_below.x), bvec4(leaves_stack));
  stack_below = mix(stack_below, uvec4(stack_below.yzw, kNone), bvec4(leaves_stack));
}

// The same, where the registers may be empty while the array is not.
void take_next(bool wanted, inout uint current) {
  if (wanted && stack_top.x == kNone && stack_size > 0u) stack_top.x = stack_array[--stack_size];
  pop(wanted, current);
}

void add_leaf(bool wanted, uint leaf) {
  last_leaf = wanted ? leaves.w : last_leaf;
  leaves = mix(leaves, uvec4(leaf, leaves.xyz), bvec4(wanted));
}

void take_leaf() {
  leaves = uvec4(leaves.yzw, last_leaf);
  last_leaf = kNone;
}

// Tests the children of node `current`, pushes those that the ray enters, and moves on to the next node.
void visit(TraversalRay ray, float t_best, inout uint current) {
  uvec4 grid, zw;
  ivec4 t_near;
  bvec4 entered;
  enter_children(ray, t_best, current, grid, zw, t_near, entered);

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
  uvec4 key = sort_children(t_near, entered, inner_count);
  bool found = key.x != kMissedKey;
  uint slot = key.x & 3u;
  uint third = key.z != kMissedKey ? key.z : key.y;
  uint fourth = key.w != kMissedKey ? key.w : third;
  push(key.y != kMissedKey, zw.z << kSlotBits | (key.y & 3u) | (third & 3u) << 2u | (fourth & 3u) << 4u);
#endif
  current = zw.z + slot;
  pop(!found, current);
}

bool is_over() {
#ifdef ANY_HIT
  if (best.triangle != kNone) return true;
#endif
  return current == kNone && leaves.x == kNone;
}

// Tests the triangles of all leaves that wait, or those before one that is pending.
void test_leaves(float t_max) {
  uint item = leaf_first(leaves.x), end = leaf_end(leaves.x);
  bool testing = leaves.x != kNone && !in_top_level;
  while (testing) {
    bool needs_alpha = test_triangle(item, t_max);
    ++item;
    // The rest of the leaf waits.
    if (has(TESTED_FEATURES)) leaves.x = needs_alpha ? leaf_word(item, end - item) : leaves.x;
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
  begin_instance(origin, direction);
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

// Down to leaves. A driver that runs all lanes in step executes the body of a loop once more for lanes that are all
// done, unless the loop is tested at its end.
void visit_nodes() {
  bool visiting = can_visit();
  do {
    if (visiting) visit(local_ray, t_best, current);
    visiting = can_visit();
  } while (visiting);
}

// Down to leaves, through these, and on to what waits on the stack. Returns whether the ray has been traced.
bool walk_in_step(vec3 origin, vec3 direction, float t_max) {
  visit_nodes();
  test_leaves(t_max);
  spill();
  take_next(current == kNone, current);
  if (has_levels()) change_level(origin, direction);
  return is_over();
}

void trace_in_step(vec3 origin, vec3 direction, float t_max) {
  bool done;
  do {
    do done = walk_in_step(origin, direction, t_max); // as in visit_nodes()
    while (!done && pending.triangle == kNone);
    if (has(TESTED_FEATURES)) {
      look_up_alpha();
#ifdef ANY_HIT
      done = done || best.triangle != kNone;
#endif
    }
  } while (!done);
}

#endif
