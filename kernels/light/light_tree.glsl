// Picks one of many lights in proportion to a bound of what it brings to a point: the walk down the light tree (Conty
// Estevez and Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting"; pbrt-v4, 12.6.3).
//
// All choices are drawn with one integer, which keeps the net of the sampler whole: each cuts the range of integers in
// two and goes on in one part, so that what is left is uniform again. Include light_tree_types.h first and declare
// `usamplerBuffer light_tree`.
#ifndef WAVEPATH_LIGHT_TREE_GLSL
#define WAVEPATH_LIGHT_TREE_GLSL

#include "kernels/base/math.glsl"

// ---- one integer for many choices -------------------------------------------------------------------------------

// Uniform in [0, range), which is kept between 2^30 and 2^31: where it becomes shorter it is stretched and hashed bits
// fill up the value, as in an arithmetic decoder. So any number of choices can be drawn with one integer.
struct Draw {
  uint value, range, spare;
};

Draw make_draw(uint bits) { return Draw(bits >> 1u, 0x80000000u, bits); }

// Permuted congruential hash (Jarzynski and Olano, JCGT 2020).
uint next_spare(uint x) {
  x = x * 747796405u + 2891336453u;
  x = ((x >> ((x >> 28u) + 4u)) ^ x) * 277803737u;
  return (x >> 22u) ^ x;
}

// Goes on in [first, first + size) of the range.
void enter_part(inout Draw draw, uint first, uint size) {
  uint shift = 30u - min(uint(findMSB(size)), 30u);
  draw.spare = next_spare(draw.spare);
  draw.range = size << shift;
  draw.value = ((draw.value - first) << shift) | (draw.spare & ((1u << shift) - 1u));
}

// True with that probability, which is neither 0 nor 1.
bool draw_choice(inout Draw draw, float probability) {
  uint below = uint(float(draw.range) * probability);
  bool inside = draw.value < below;
  enter_part(draw, inside ? 0u : below, inside ? below : draw.range - below);
  return inside;
}

// The rest of the number, in [0, 1).
float remainder_of(Draw draw) { return min(float(draw.value) / float(draw.range), kOneMinusEpsilon); }

// ---- bounds -----------------------------------------------------------------------------------------------------

vec3 octahedral_direction(vec2 at) { // `at`: in [-1, 1]^2
  vec3 d = vec3(at, 1.0 - abs(at.x) - abs(at.y));
  if (d.z < 0.0) d.xy = (1.0 - abs(d.yx)) * vec2(d.x < 0.0 ? -1.0 : 1.0, d.y < 0.0 ? -1.0 : 1.0);
  return normalize(d);
}

float light_intensity(uint bits) { return uintBitsToFloat((bits << 13u) + (kLeastIntensityExponent << 23u)); }

// Cosine and sine of max(0, a - b).
vec2 angle_beyond(vec2 a, vec2 b) {
  return a.x >= b.x ? vec2(1.0, 0.0) : vec2(a.x * b.x + a.y * b.y, a.y * b.x - a.x * b.y);
}

vec2 angle_of(float cosine) { return vec2(cosine, sqrt(max(0.0, 1.0 - cosine * cosine))); }

// A receiver of light. `normal` is zero where light counts from both sides.
struct Receiver {
  vec3 position, normal;
};

// Bound of the light that a subtree with this box brings to the receiver, up to a factor that all subtrees share. Zero
// only where no light of the subtree can contribute: bounds hold the lights with their rounding, and the slacks below
// are larger than the rounding here and of packed normals. A floor under the cosines keeps weights bounded where the
// walk knows only a little.
float subtree_importance(Receiver receiver, vec3 lo, vec3 hi, LightTreeChild child) {
  const float kSlack = 1e-3, kLeastCosine = 0.01;
  vec3 to_centre = 0.5 * (lo + hi) - receiver.position, to_corner = 0.5 * (hi - lo);
  float radius2 = 1.02 * dot(to_corner, to_corner), distance2 = dot(to_centre, to_centre);
  vec3 direction = to_centre / sqrt(max(distance2, 1e-37));
  // Half angle under which the sphere about the box is seen; everything if the receiver is inside.
  float sine2 = min(radius2 / max(distance2, 1e-37), 1.0);
  vec2 seen = distance2 > radius2 ? vec2(sqrt(1.0 - sine2), sqrt(sine2)) : vec2(-1.0, 0.0);

  vec4 cone = unpackUnorm4x8(child.emission), axis = unpackUnorm4x8(child.box1);
  vec2 half_sines = cone.zw;
  vec2 cosines = 1.0 - 2.0 * half_sines * half_sines;
  vec2 spread = vec2(cosines.x, 2.0 * half_sines.x * sqrt(1.0 - half_sines.x * half_sines.x));
  float leaving = -dot(octahedral_direction(axis.zw * 2.0 - 1.0), direction);
  if ((child.link & kLightTwoSided) != 0u) leaving = abs(leaving);
  float emitted = angle_beyond(angle_beyond(angle_of(leaving), spread), seen).x;
  bool dark = emitted < cosines.y - kSlack;

  float received = 1.0;
  if (receiver.normal != vec3(0.0)) {
    received = angle_beyond(angle_of(dot(receiver.normal, direction)), seen).x;
    dark = dark || received < -kSlack;
  }
  float importance = light_intensity(child.emission & 0xffffu) * max(emitted, kLeastCosine) *
                     max(received, kLeastCosine) / max(max(distance2, radius2), 1e-30);
  return dark ? 0.0 : max(importance, 1e-36);
}

// ---- walks ------------------------------------------------------------------------------------------------------

LightCluster fetch_light_root() {
  uvec4 lo_link = texelFetch(light_tree, 0), hi_depth = texelFetch(light_tree, 1);
  return LightCluster(uintBitsToFloat(lo_link.xyz), lo_link.w, uintBitsToFloat(hi_depth.xyz), hi_depth.w);
}

// The two subtrees of a node, and the probability of the first.
struct Fork {
  LightCluster child[2];
  float probability;
  bool dead; // neither can contribute
};

LightCluster fetch_child(LightCluster at, uint k, out LightTreeChild child) {
  uvec4 words = texelFetch(light_tree, int(kLightRecordTexels * (at.link & kLightIndexMask) + k));
  child = LightTreeChild(words.x, words.y, words.z, words.w);
  vec4 box0 = unpackUnorm4x8(child.box0), box1 = unpackUnorm4x8(child.box1);
  vec3 size = at.hi - at.lo;
  return LightCluster(at.lo + size * box0.xyz, child.link, at.lo + size * vec3(box0.w, box1.xy), at.depth + 1u);
}

LightCluster fetch_child(Receiver receiver, LightCluster at, uint k, out float importance) {
  LightTreeChild child;
  LightCluster below = fetch_child(at, k, child);
  importance = subtree_importance(receiver, below.lo, below.hi, child);
  return below;
}

// A subtree that can contribute is taken once in 4096 times at least: then the integers that stand for it, 2^18 or
// more, agree with its probability to 4e-6.
Fork fetch_fork(Receiver receiver, LightCluster at) {
  const float kLeastProbability = 1.0 / 4096.0;
  Fork fork;
  float first, second;
  fork.child[0] = fetch_child(receiver, at, 0u, first);
  fork.child[1] = fetch_child(receiver, at, 1u, second);
  fork.dead = first == 0.0 && second == 0.0;
  fork.probability = first == 0.0    ? 0.0
               : second == 0.0 ? 1.0
                               : clamp(first / (first + second), kLeastProbability, 1.0 - kLeastProbability);
  return fork;
}

// The end of a walk: a light, with its probability from the root, and from the root of its cluster (`below_cluster`).
// kNone: subtrees that cannot contribute.
struct LightWalk {
  uint light;
  float probability, below_cluster;
};

const LightWalk kNowhere = LightWalk(kNone, 0.0, 0.0);

// Follows `branches`, whose bit d chooses at depth d. Draws its choices instead if `drawn`, or once it is in a cluster
// if `drawn_below_cluster`.
LightWalk walk_lights(Receiver receiver, uint branches, bool drawn, bool drawn_below_cluster, inout Draw draw) {
  LightCluster at = fetch_light_root();
  LightWalk walk = LightWalk(kNone, 1.0, 1.0);
  while ((at.link & kLightLeaf) == 0u) {
    Fork fork = fetch_fork(receiver, at);
    bool first = (branches >> at.depth & 1u) == 0u;
    float probability = fork.probability;
    if (fork.dead) return kNowhere;
    if (drawn) {
      if (probability == 0.0 || probability == 1.0) first = probability == 1.0;
      else first = draw_choice(draw, probability);
    }
    if (!first) probability = 1.0 - probability;
    if (probability == 0.0) return kNowhere;
    walk.probability *= probability;
    walk.below_cluster *= probability;
    if (first) at = fork.child[0]; else at = fork.child[1];
    if ((at.link & kLightClusterRoot) != 0u) {
      walk.below_cluster = 1.0;
      drawn = drawn || drawn_below_cluster;
    }
  }
  walk.light = at.link & kLightIndexMask;
  return walk;
}

// A light drawn from the whole tree; from a cluster, to which `branches` lead; and the probability of the light at the
// end of `branches`.
LightWalk draw_from_tree(Receiver receiver, inout Draw draw) { return walk_lights(receiver, 0u, true, true, draw); }
LightWalk draw_from_cluster(Receiver receiver, uint branches, inout Draw draw) {
  return walk_lights(receiver, branches, false, true, draw);
}
LightWalk walk_to(Receiver receiver, uint branches) {
  Draw none = Draw(0u, 1u, 0u);
  return walk_lights(receiver, branches, false, false, none);
}

// ---- lights along a ray -----------------------------------------------------------------------------------------

// A search of the tree, without a stack: branches as above, and the depths at which the second child is still to be
// looked at. A return to one of them goes down again from the root.
struct LightSearch {
  uint branches, open, known; // known: branches that are followed without a look at their boxes
  bool ended;
};

LightSearch begin_light_search() { return LightSearch(0u, 0u, 0u, false); }

// True if a ray comes as near to the box as this, within its length. Boxes are widened by more than the rounding.
bool passes_box(LightCluster at, float radius, vec3 from, vec3 direction, float end) {
  vec3 wide = vec3(1.01 * radius) + 1e-5 * (abs(at.lo - from) + abs(at.hi - from));
  vec3 inverse = 1.0 / mix(direction, vec3(1e-30), lessThan(abs(direction), vec3(1e-30)));
  vec3 a = (at.lo - wide - from) * inverse, b = (at.hi + wide - from) * inverse;
  vec3 near = min(a, b), far = max(a, b);
  return max(max(near.x, near.y), max(near.z, 0.0)) <= min(min(far.x, far.y), min(far.z, end));
}

// To the deepest second child that is left.
void turn_back(inout LightSearch search) {
  search.ended = search.open == 0u;
  if (search.ended) return;
  uint depth = uint(findMSB(search.open)), bit = 1u << depth;
  search.open ^= bit;
  search.branches = (search.branches & (bit - 1u)) | bit;
  search.known = depth + 1u;
}

// The next light whose position is within `radius` of the ray, or not much farther; kNone: no more.
uint next_light_along(inout LightSearch search, float radius, vec3 from, vec3 direction, float end) {
  LightCluster at = fetch_light_root();
  while (!search.ended && (at.link & kLightLeaf) == 0u) {
    bool second = (search.branches >> at.depth & 1u) != 0u, dead = false;
    LightTreeChild ignored;
    if (at.depth >= search.known) {
      LightCluster child = fetch_child(at, 0u, ignored), other = fetch_child(at, 1u, ignored);
      bool first = passes_box(child, radius, from, direction, end);
      second = passes_box(other, radius, from, direction, end);
      dead = !first && !second;
      if (first && second) search.open |= 1u << at.depth;
      if (second && !first) search.branches |= 1u << at.depth;
      second = second && !first;
    }
    if (!dead) {
      at = fetch_child(at, second ? 1u : 0u, ignored);
    } else {
      turn_back(search);
      at = fetch_light_root();
    }
  }
  if (search.ended) return kNone;
  turn_back(search);
  return at.link & kLightIndexMask;
}

#endif
