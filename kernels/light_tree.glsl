// Picks one of many lights in proportion to a bound of what it brings to a point: the walk down the light tree (Conty
// Estevez and Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting"; pbrt-v4, 12.6.3).
//
// The pick is drawn with one integer, which keeps the net of the sampler whole: each choice cuts the range of integers in
// two and goes on in one part, so that the probability of a light is exactly the share of integers that lead to it, and
// what is left is uniform again. Include light_tree_types.h first and declare `usamplerBuffer light_tree`.
#ifndef WAVEPATH_LIGHT_TREE_GLSL
#define WAVEPATH_LIGHT_TREE_GLSL

#include "kernels/math.glsl"

// ---- one integer for many choices -------------------------------------------------------------------------------

// Uniform in [0, range). Where the range becomes short it is stretched, and hashed bits fill up the value, as in an
// arithmetic decoder: so ranges stay between 2^23 and 2^31, however many choices there are.
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

// Where to cut a range so that `share` of it lies below: both parts keep at least one integer.
uint cut_range(uint range, float share) {
  return clamp(uint(float(range) * min(share, kOneMinusEpsilon)), 1u, range - 1u);
}

// Goes on in [first, first + size) of the range.
void enter_part(inout Draw draw, uint first, uint size) {
  draw.value -= first;
  draw.range = size;
  if (size < 0x800000u) {
    uint shift = 30u - uint(findMSB(size)); // 8 to 30
    draw.spare = next_spare(draw.spare);
    draw.range = size << shift;
    draw.value = (draw.value << shift) | (draw.spare >> (32u - shift));
  }
}

// What is left, in [0, 1).
float remainder_of(Draw draw) { return min(float(draw.value) / float(draw.range), kOneMinusEpsilon); }

// ---- bounds -----------------------------------------------------------------------------------------------------

vec3 octahedral_direction(vec2 at) { // in [-1, 1]^2
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
  float importance = light_intensity(child.emission & 0xffffu) * max(emitted, kLeastCosine) * max(received, kLeastCosine) /
                     max(max(distance2, radius2), 1e-30);
  return dark ? 0.0 : max(importance, 1e-36);
}

// ---- walks ------------------------------------------------------------------------------------------------------

LightCluster fetch_light_cluster(uint record) {
  uvec4 lo_link = texelFetch(light_tree, int(kLightRecordTexels * record));
  uvec4 hi_depth = texelFetch(light_tree, int(kLightRecordTexels * record + 1u));
  return LightCluster(uintBitsToFloat(lo_link.xyz), lo_link.w, uintBitsToFloat(hi_depth.xyz), hi_depth.w);
}

// The two subtrees of the node that `at` stands for.
struct Fork {
  LightCluster child[2];
  float importance[2];
};

void look_at_child(Receiver receiver, LightCluster at, uvec4 words, uint k, inout Fork fork) {
  LightTreeChild child = LightTreeChild(words.x, words.y, words.z, words.w);
  vec4 box0 = unpackUnorm4x8(child.box0), box1 = unpackUnorm4x8(child.box1);
  vec3 size = at.hi - at.lo;
  LightCluster next = LightCluster(at.lo + size * box0.xyz, child.link & ~kLightTwoSided, at.lo + size * vec3(box0.w, box1.xy),
                                   at.depth + 1u);
  fork.importance[k] = subtree_importance(receiver, next.lo, next.hi, child);
  fork.child[k] = next;
}

Fork fetch_fork(Receiver receiver, LightCluster at) {
  int texel = int(kLightRecordTexels * at.link);
  Fork fork;
  look_at_child(receiver, at, texelFetch(light_tree, texel), 0u, fork);
  look_at_child(receiver, at, texelFetch(light_tree, texel + 1), 1u, fork);
  return fork;
}

// Part of `range` that belongs to the first child of a fork of which at least one is alive.
uint first_part(Fork fork, uint range) {
  if (fork.importance[0] == 0.0) return 0u;
  if (fork.importance[1] == 0.0) return range;
  return cut_range(range, fork.importance[0] / (fork.importance[0] + fork.importance[1]));
}

bool is_dead_end(Fork fork) { return fork.importance[0] == 0.0 && fork.importance[1] == 0.0; }

// Index of a light below `start`, kNone if none can contribute; `probability` is multiplied by that of the pick.
uint pick_below(Receiver receiver, LightCluster start, inout Draw draw, inout float probability) {
  LightCluster at = start;
  while ((at.link & kLightLeaf) == 0u) {
    Fork fork = fetch_fork(receiver, at);
    if (is_dead_end(fork)) return kNone;
    uint below = first_part(fork, draw.range);
    bool second = draw.value >= below;
    uint size = second ? draw.range - below : below;
    probability *= float(size) / float(draw.range);
    enter_part(draw, second ? below : 0u, size);
    if (second) at = fork.child[1]; else at = fork.child[0];
  }
  return at.link & kLightIndexMask;
}

// The probability with which pick_below() finds the light that `trail` leads to: bit d of it chooses between the
// children at depth d. `range`: that of the draw at the beginning.
float pick_probability_below(Receiver receiver, LightCluster start, uint trail, uint range) {
  LightCluster at = start;
  Draw draw = Draw(0u, range, 0u);
  float probability = 1.0;
  while ((at.link & kLightLeaf) == 0u && probability > 0.0) {
    Fork fork = fetch_fork(receiver, at);
    bool second = (trail >> at.depth & 1u) != 0u;
    if ((second ? fork.importance[1] : fork.importance[0]) == 0.0) return 0.0;
    uint below = first_part(fork, draw.range);
    uint size = second ? draw.range - below : below;
    probability *= float(size) / float(draw.range);
    enter_part(draw, 0u, size);
    if (second) at = fork.child[1]; else at = fork.child[0];
  }
  return probability;
}

#endif
