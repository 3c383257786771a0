// Weighs the light of each path's second vertex for the pixels of its quad: by what of it they see, and how likely
// their own paths would have found it (reuse.glsl). One lane a sender.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_RECEIVERS
#define BIND_PATHS
#define BIND_REUSE
#define BIND_QUEUES
#define BIND_COUNTERS
#include "kernels/path/bindings.glsl"
#include "kernels/surface/bsdf_types.glsl"
#include "kernels/base/dimensions.glsl"
#include "kernels/path/path_sampler.glsl"
#include "kernels/path/queue_item.glsl"
#include "kernels/path/reuse.glsl"
#include "kernels/base/records.glsl"
#include "kernels/light/shadow.glsl"

#define ALPHA_TEST(hit) lets_light_through(hit)
#define ANY_HIT
#include "kernels/bvh/trace.glsl"

layout(local_size_x = kWorkgroupSize) in;

const float kLeastCosine = 1e-3; // below it the normal of a vertex would be held (held_normal())

struct Sender {
  vec3 position, plane, normal;
  Coupling coupling;
  uint triangle, instance;
};

Sender fetch_sender(uint slot, uvec4 head) {
  vec4 position = fetch_reuse(slot, kReuseSender), plane = fetch_reuse(slot, kReuseSenderPlane);
  vec3 normal = TURNS_NORMALS ? fetch_reuse(slot, kReuseSenderNormal).xyz : plane.xyz;
  Coupling coupling = unpack_coupling(position.w, plane.w, kMicrofacets ? fetch_reuse(slot, kReuseOwn).w : 0.0);
  return Sender(position.xyz, plane.xyz, normal, coupling, head.w, head.y - 1u);
}

// Between the receiver of a slot and the sender.
struct Link {
  vec3 origin, offset;
  float density;                        // K
  float receiver_passes, sender_passes; // T
};

// Cosine at the receiver of the mirror image of a direction, 0 if it has none, and that of the direction itself, 0
// below the surface that a map stands for: as has_image() and has_itself() in
// kernels/surface/world_scattering.glsl.
float mirrored_cosine(uint slot, vec3 normal, vec3 direction, inout float cosine) {
  vec3 mirror = fetch_reuse(slot, kReuseReceiverMirror).xyz;
  if (mirror == vec3(0.0)) return 0.0;
  float above = dot(mirror, direction);
  cosine = above > 0.0 ? max(cosine, 0.0) : 0.0;
  return above > 0.0 ? max(dot(direction - 2.0 * above * mirror, normal), 0.0) : 0.0;
}

// False if they face away from each other.
bool link_to(uint slot, Sender y, out Link link) {
  vec4 position = fetch_reuse(slot, kReuseReceiver), normal = fetch_reuse(slot, kReuseReceiverNormal);
  vec3 plane = TURNS_NORMALS ? fetch_reuse(slot, kReuseReceiverPlane).xyz : normal.xyz;
  link.origin = position.xyz;
  link.offset = y.position - position.xyz;
  float squared = dot(link.offset, link.offset);
  vec3 direction = link.offset * inversesqrt(squared);
  float cosine = dot(normal.xyz, direction), mirrored = 0.0, cosine_y = -dot(y.plane, direction),
        shading_y = -dot(y.normal, direction);
  if (has(kFeatureNormalMaps)) mirrored = mirrored_cosine(slot, normal.xyz, direction, cosine);
  link.density = kInvPi * (cosine + mirrored) * cosine_y / squared;
  link.receiver_passes = link.sender_passes = 1.0;
  if (kMicrofacets) {
    Coupling x = unpack_coupling(position.w, fetch_reuse(slot, kReuseReceiverColor).w, normal.w);
    link.receiver_passes = coupling_passes(x, max(cosine, 0.0));
    if (has(kFeatureNormalMaps) && mirrored > 0.0)
      link.receiver_passes =
          mix(link.receiver_passes, coupling_passes(x, mirrored), mirrored / (max(cosine, 0.0) + mirrored));
    link.sender_passes = coupling_passes(y.coupling, max(shading_y, 0.0));
  }
  return cosine + mirrored > 0.0 && dot(plane, direction) > 0.0 && cosine_y > 0.0 && shading_y > kLeastCosine &&
         is_finite(link.density);
}

// Counts the rays of all lanes, each of which has traced 0 to 4.
void count_rays(uint traced) {
  uint rays = subgroupBallotBitCount(subgroupBallot((traced & 1u) != 0u));
  rays += 2u * subgroupBallotBitCount(subgroupBallot((traced & 2u) != 0u));
  rays += 4u * subgroupBallotBitCount(subgroupBallot((traced & 4u) != 0u));
  if (rays == 0u || !subgroupElect()) return;
  uint before = atomicAdd(counters.shadow_rays[0], rays);
  if (before + rays < before) atomicAdd(counters.shadow_rays[1], 1u);
}

// True if nothing at all lies between.
bool is_clear(Link link, Sender y) {
  restart_shadow();
  Hit hit = trace(link.origin, link.offset, 1.0, y.triangle, y.instance);
  return hit.triangle == kNone && shadow_depth == 0u;
}

// Weights of a sender's light for each pixel of the quad. Returns the number of rays traced.
uint weigh(uint slot, out vec4 weights) {
  weights = vec4(0.0);
  uvec4 head = texelFetch(reuse_texels, int(reuse_index(slot, kReuseHead)));
  uint at = head.z % kQuadPixels, count = head.z / kQuadPixels, traced = 0u;
  Sender y = fetch_sender(slot, head);
  float density = 0.0, receiver_passes = 1.0, sender_passes = 1.0; // of this path's own technique
  for (uint i = 0u; i < count; ++i) {
    uint receiver = slot - at + i;
    float probability = abs(fetch_reuse(receiver, kReuseHead).x);
    if (!(probability > 0.0)) continue;
    Link link;
    bool sees = link_to(receiver, y, link);
    if (i == at) {
      receiver_passes = link.receiver_passes;
      sender_passes = link.sender_passes;
    }
    if (!sees) continue;
    // The path itself has come there; but where surfaces let paths pass by chance it may have passed some.
    if (i != at || uses(kFeatureAlpha)) {
      ++traced;
      if (!is_clear(link, y)) continue;
    }
    weights[i] = link.density * link.receiver_passes * link.sender_passes;
    density += probability * link.density;
  }
  if (weights[at] > 0.0 && density > 0.0 && sender_passes > 0.0) {
    weights /= density * sender_passes;
  } else { // its light stays its own
    weights = vec4(0.0);
    weights[at] = receiver_passes / uintBitsToFloat(head.x);
  }
  return traced;
}

void main() {
  uint index = queue_item(), traced = 0u;
  if (index < queues.sender_count) {
    uint slot = texelFetch(reuse_texels, int(reuse_index(index, kReuseList))).x;
    vec4 weights;
    traced = weigh(slot, weights);
    reuse_words[reuse_index(slot, kReuseWeights)] = floatBitsToUint(weights);
  }
  count_rays(traced);
}
