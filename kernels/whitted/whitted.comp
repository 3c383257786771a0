// Whitted's ray tracer (Whitted, "An Improved Illumination Model for Shaded Display", CACM 23(6), 1980): one lane
// follows the whole tree of a camera ray. At every surface: emission, a shadow ray to every light, the ambient term;
// smooth metal and glass send reflected and refracted rays, weighted by Fresnel's equations.
//
// It finds the light of all paths with at most one scattering that is not a mirror's or a smooth interface's; a light
// with an extent is sampled at one point a ray, so that its shadows are soft. Rough lobes reflect lights alone.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_LIGHTS
#define BIND_ENVIRONMENT
#define BIND_PATHS
#define BIND_COUNTERS
#include "kernels/path/bindings.glsl"
#include "kernels/camera.glsl"
#include "kernels/dimensions.glsl"
#include "kernels/emission.glsl"
#include "kernels/filter.glsl"
#include "kernels/path/nonfinite.glsl"
#include "kernels/path/records.glsl"
#include "kernels/pixel.glsl"
#include "kernels/vertex.glsl"
#include "kernels/whitted/whitted_types.h"

layout(set = 0, binding = kBindWhitted, std140) uniform WhittedBlock { WhittedFrame whitted; };

Sampler path_sampler;
uint alpha_kind; // see alpha_key(): one for every ray of the tree
#define ALPHA_TEST(hit) is_hole(hit, path_sampler, alpha_kind)
#include "kernels/bvh.glsl"

layout(local_size_x = kWorkgroupSize) in;

// A ray that waits to be traced. With depth first, at most one sibling waits at each depth; where more than kPending
// would, one of two children is chosen at random.
struct Node {
  vec3 origin, direction;
  vec3 weight; // share of its radiance that reaches the eye
  uint depth;
  uint medium;
};
const uint kPending = 8u;
Node pending[kPending];
uint pending_count;

uint node_count;        // rays of the tree so far, each with random numbers of its own
uint shadow_ray_count;

uint node_dimension() { return 1u + node_count * (frame.light_count + 2u); }

// Whether the shadow ray is blocked, by anything but the light itself.
bool is_blocked(vec3 origin, LightSample light_sample, Light light) {
  vec3 direction = light_sample.distant ? light_sample.direction : light_sample.target - origin;
  alpha_kind = alpha_key(node_count, kHashConnect);
  ++shadow_ray_count;
  Hit hit = trace(origin, direction, light_sample.distant ? kFar : 1.0);
  if (hit.triangle == kNone) return false;
  if (!has(kFeatureTriangleLights) || light.kind != kLightTriangle) return true;
  uint id = floatBitsToUint(texelFetch(triangles, int(hit.triangle * kTriangleTexels + 1u)).w);
  return id != light.triangle_id || hit.instance != light.instance;
}

LightSample sample_one_light(Light light, vec3 from, vec2 u) {
  if (has(kFeatureEnvironment) && light.kind == kLightEnvironment) return sample_environment(u);
  if (has(kFeatureTriangleLights) && light.kind == kLightTriangle) return sample_triangle_light(light, from, u);
  if (has(kFeaturePunctualLights)) return sample_punctual_light(light, from);
  return no_light();
}

// Light of one light source that the surface reflects along v.wo, by all but its delta lobes.
vec3 lit_by(uint index, Vertex v, uint medium) {
  Light light = fetch_light(index);
  LightSample s = sample_one_light(light, v.surface.position, sample_2d(path_sampler, node_dimension() + index));
  float pdf = s.pdf / light.probability; // that of picking this light is 1 here
  if (max_component(s.radiance) <= 0.0 || !(pdf > 0.0) || !sides_agree(v, s.direction)) return vec3(0.0);
  float bsdf_pdf;
  vec3 wo = to_local(v.wo, v.tangent, v.bitangent, v.normal), wi = to_local(s.direction, v.tangent, v.bitangent, v.normal);
  vec3 value = bsdf_eval(v.bsdf, wo, wi, bsdf_pdf) * s.radiance / pdf;
  if (has(kFeatureVolume)) {
    bool crossing = dot(s.direction, v.normal) < 0.0 && !v.bsdf.thin;
    value *= medium_transmittance(crossing ? medium_behind(v) : medium,
                                  s.distant ? kFarAway : length(s.target - v.surface.position));
  }
  if (is_finite(value) && max_component(value) <= 0.0) return vec3(0.0);
  vec3 origin = offset_ray_origin(v.surface.position, v.surface.position_error, v.surface.geometric_normal, s.direction);
  return is_blocked(origin, s, light) ? vec3(0.0) : value;
}

const uint kLoopTrips = 1u << 14; // Mesa 22.3 ends loops silently after 65,535 trips

vec3 lit(Vertex v, uint medium) {
  vec3 sum = vec3(0.0);
  for (uint first = 0u; first < frame.light_count; first += kLoopTrips) {
    uint end = min(first + kLoopTrips, frame.light_count);
    for (uint i = first; i < end; ++i) sum += lit_by(i, v, medium);
  }
  return sum;
}

Node child(Vertex v, Node node, vec3 local, vec3 weight, bool transmitted) {
  vec3 wi = normalize(to_world(local, v.tangent, v.bitangent, v.normal));
  Node next;
  next.origin = offset_ray_origin(v.surface.position, v.surface.position_error, v.surface.geometric_normal, wi);
  next.direction = wi;
  next.weight = sides_agree(v, wi) ? node.weight * weight : vec3(0.0);
  next.depth = node.depth + 1u;
  next.medium = transmitted && !v.bsdf.thin ? medium_behind(v) : node.medium;
  return next;
}

bool is_worth_following(Node node) { return max_component(node.weight) > whitted.cutoff; }

// Reflected and refracted rays of a smooth interface wait from here on.
void branch(Vertex v, Node node) {
  vec3 wo = to_local(v.wo, v.tangent, v.bitangent, v.normal);
  if (!kMicrofacets || !(wo.z > 0.0)) return;
  Lobes lobes = lobes_of(v.bsdf, wo);
  vec3 up = vec3(0.0, 0.0, 1.0);
  Node reflected = child(v, node, vec3(-wo.xy, wo.z), facet_reflectance(v.bsdf, lobes.surface, wo.z), false);
  bool reflects = lobes.delta_reflection && is_worth_following(reflected);
  Node refracted = reflected;
  bool refracts = false;
  if (has(kFeatureTransmission) && lobes.delta_transmission) {
    vec3 transmittance = facet_transmittance(v.bsdf, lobes.surface, wo.z), local = -wo;
    float eta = lobes.surface.eta;
    refracts = v.bsdf.thin || refract_direction(wo, up, eta, local); // false: total internal reflection
    refracted = child(v, node, local, v.bsdf.thin ? transmittance : transmittance / (eta * eta), true);
    refracts = refracts && is_worth_following(refracted);
  }
  bool crowded = pending_count + uint(reflects) + uint(refracts) > kPending;
  if (reflects && refracts && (whitted.choice != 0u || crowded)) {
    float q = reflect_probability(reflected.weight, refracted.weight);
    float u = sample_2d(path_sampler, node_dimension() + frame.light_count).x;
    reflects = u < q;
    refracts = !reflects;
    reflected.weight /= q;
    refracted.weight /= 1.0 - q;
  }
  if (refracts) pending[pending_count++] = refracted;
  if (reflects) pending[pending_count++] = reflected;
}

void record_first_hit(uint slot, Vertex v, vec3 origin, vec3 direct) {
  path_aovs[slot].albedo = v.bsdf.base_color;
  path_aovs[slot].normal = v.normal;
  path_aovs[slot].position = v.surface.position;
  path_aovs[slot].depth = dot(v.surface.position - origin, frame.camera_forward);
  path_aovs[slot].hit = 1.0;
  path_aovs[slot].direct = direct;
}

// Radiance that the ray of a node brings, without that of its children, which wait from here on.
vec3 shade(Node node, uint slot) {
  alpha_kind = alpha_key(node_count, kHashExtend);
  Hit hit = trace(node.origin, node.direction, kFar);
  bool first = has(kFeatureAovs) && node.depth == 0u;
  if (hit.triangle == kNone) {
    float light_pdf;
    vec3 radiance = environment_emission(node.direction, light_pdf);
    if (has(kFeatureVolume)) radiance *= medium_transmittance(node.medium, kFarAway);
    if (first) path_aovs[slot].emission = radiance;
    return radiance;
  }
  Surface surface = fetch_surface(hit);
  Material material = fetch_material(surface.material);
  if (has(kFeatureVolume)) node.weight *= medium_transmittance(node.medium, length(surface.position - node.origin));
  Vertex v = make_vertex(surface, material, node.direction);
  bool unlit = has(kFeatureEmission) && (material.flags & kMaterialUnlit) != 0u;
  vec3 emitted = unlit ? v.bsdf.base_color : surface_emission(surface, material, v.front);
  vec3 direct = vec3(0.0), ambient = vec3(0.0);
  if (!unlit && node.depth < frame.max_depth) {
    if (bsdf_has_smooth(v.bsdf)) {
      direct = lit(v, node.medium);
      ambient = whitted.ambient * v.bsdf.base_color * ((1.0 - v.bsdf.metallic) * (1.0 - v.bsdf.transmission));
    }
    branch(v, node);
  }
  if (first) {
    record_first_hit(slot, v, node.origin, direct);
    path_aovs[slot].emission = emitted;
  }
  vec3 radiance = emitted + direct + ambient;
  return has(kFeatureVolume) ? radiance * medium_transmittance(node.medium, length(surface.position - node.origin)) : radiance;
}

void clear_aovs(uint slot) {
  path_aovs[slot].albedo = vec3(0.0);
  path_aovs[slot].depth = 0.0;
  path_aovs[slot].normal = vec3(0.0);
  path_aovs[slot].hit = 0.0;
  path_aovs[slot].position = vec3(0.0);
  path_aovs[slot].unoccluded = 0.0;
  path_aovs[slot].emission = vec3(0.0);
  path_aovs[slot].direct = vec3(0.0);
}

// Adds to a total of 64 bits.
#define COUNT(total, n)                                                      \
  {                                                                          \
    uint before_ = atomicAdd(total[0], n);                                   \
    if (before_ + n < before_) atomicAdd(total[1], 1u);                      \
  }

void main() {
  uint slot = gl_GlobalInvocationID.x;
  if (slot >= wave.pixel_count * wave.sample_count) return;
  path_sampler = slot_sampler(slot);
  Node node;
  camera_ray(vec2(slot_pixel(slot)) + 0.5 + sample_filter(sample_2d(path_sampler, kDimensionFilter)), node.origin,
             node.direction);
  node.weight = vec3(1.0);
  node.depth = 0u;
  node.medium = kNone;
  if (has(kFeatureAovs)) clear_aovs(slot);

  vec3 radiance = vec3(0.0);
  pending[0] = node;
  pending_count = 1u;
  node_count = shadow_ray_count = 0u;
  while (pending_count > 0u) {
    for (uint trip = 0u; trip < kLoopTrips && pending_count > 0u; ++trip) {
      node = pending[--pending_count];
      radiance += node.weight * shade(node, slot);
      ++node_count;
    }
  }
  if (!is_finite(radiance)) count_nonfinite(kMakerShade, slot);
  store_path(slot, PathState(vec3(0.0), -1.0, radiance, 1.0));
  COUNT(counters.camera_rays, 1u)
  COUNT(counters.bounce_rays, node_count - 1u)
  COUNT(counters.shadow_rays, shadow_ray_count)
}
