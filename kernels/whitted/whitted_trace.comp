// Traces the rays of one depth: emission, the ambient term, and the rays of the next depth. Surfaces that lights may
// light are left for whitted_light.comp.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_LIGHTS
#define BIND_ENVIRONMENT
#define BIND_PATHS
#define BIND_COUNTERS
#include "kernels/path/bindings.glsl"
#include "kernels/light/emission.glsl"
#include "kernels/path/first_hit.glsl"
#include "kernels/path/records.glsl"
#include "kernels/base/pixel.glsl"
#include "kernels/surface/vertex.glsl"
#include "kernels/whitted/whitted.glsl"

Sampler path_sampler;
uint alpha_kind; // see alpha_key(): one for every ray of the tree
#define ALPHA_TEST(hit) is_hole(hit, path_sampler, alpha_kind)
#define CAMERA_RAYS (wave.bounce == 0u)
#include "kernels/bvh/trace.glsl"

layout(local_size_x = kWorkgroupSize) in;

// `precise`: kernels for more than the scene needs give the same bits.
WhittedNode child(Vertex v, WhittedNode node, vec3 local, vec3 weight, bool transmitted) {
  vec3 wi = normalize(to_world(local, v.tangent, v.bitangent, v.normal));
  WhittedNode next = node;
  next.origin = offset_ray_origin(v.surface.position, v.surface.position_error, v.surface.geometric_normal, wi);
  next.direction = wi;
  precise vec3 through = node.weight * weight;
  next.weight = sides_agree(v, BsdfSample(local, weight, -1.0, 1.0, transmitted, false), wi) ? through : vec3(0.0);
  next.medium = transmitted && !v.bsdf.thin ? medium_behind(v) : node.medium;
  next.path = node.path * 1664525u + (transmitted ? 1013904223u : 0x3c6ef35bu); // no two rays of a tree should share it
  next.depth = node.depth + 1u;
  return next;
}

bool is_worth_following(WhittedNode node) { return max_component(node.weight) > whitted.cutoff; }

// Writes the reflected and refracted rays of a smooth interface to the nodes of the tree that this one may use.
void branch(Vertex v, WhittedNode node, uint index) {
  vec3 wo = to_local(v.wo, v.tangent, v.bitangent, v.normal);
  if (!kMicrofacets || !(wo.z > 0.0)) return;
  Lobes lobes = lobes_of(v.bsdf, wo);
  vec3 mirrored = vec3(-wo.xy, wo.z), reflectance = facet_reflectance(v.bsdf, lobes.surface, wo.z);
  bool mirrors = lobes.delta_reflection;
  if (mirrors) reflectance *= layers_pass(v.bsdf, lobes, mirrored);
  mirrors = mirror_in_coat(v.bsdf, wo, mirrors, reflectance, mirrored);
  WhittedNode reflected = child(v, node, mirrored, reflectance, false);
  bool reflects = mirrors && is_worth_following(reflected);
  WhittedNode refracted = reflected;
  bool refracts = false;
  if (has(kFeatureTransmission) && lobes.delta_transmission) {
    vec3 transmittance = facet_transmittance(v.bsdf, lobes.surface, wo.z), local = -wo;
    transmittance *= layers_pass(v.bsdf, lobes, local);
    float eta = lobes.surface.eta;
    // else total internal reflection
    bool passes = v.bsdf.thin || refract_direction(wo, vec3(0.0, 0.0, 1.0), eta, local);
    precise vec3 scaled = transmittance / (eta * eta); // radiance where it enters a denser body
    refracted = child(v, node, local, v.bsdf.thin ? transmittance : scaled, true);
    refracts = passes && is_worth_following(refracted);
  }
  uint width = node.width;
  if (reflects && refracts && width == 1u) {
    float q = reflect_probability(reflected.weight, refracted.weight);
    reflects = sample_2d(path_sampler, node_dimension(node.path) + whitted.shadow_rays).x < q;
    refracts = !reflects;
    reflected.weight /= q;
    refracted.weight /= 1.0 - q;
  }
  bool both = reflects && refracts;
  reflected.width = both ? width / 2u : width;
  refracted.width = both ? width - width / 2u : width;
  uint node_index = index + (both ? (width / 2u) * wave_slots() : 0u);
  if (both) refracted.hit_depth = kNone; // the surface is lit once
  if (refracts) nodes_of_trees[node_index] = refracted;
  if (reflects) nodes_of_trees[index] = reflected;
}

// Radiance that the ray brings, but for light that lights send to the surface and for its children.
vec3 follow(WhittedNode node, uint index, uint slot) {
  Hit hit = trace(node.origin, node.direction, wave.bounce == 0u ? camera_reach(node.direction) : kFar);
  if (hit.triangle == kNone) {
    float light_pdf;
    vec3 radiance = environment_emission(node.direction, light_pdf);
    return has(kFeatureVolume) ? radiance * medium_transmittance(node.medium, kFarAway) : radiance;
  }
  Surface surface = fetch_surface(hit);
  Material material = fetch_material(surface.material);
  vec3 passed =
      has(kFeatureVolume) ? medium_transmittance(node.medium, length(surface.position - node.origin)) : vec3(1.0);
  Vertex v = make_vertex(surface, material, node.direction);
  if (has(kFeatureAovs) && wave.bounce == 0u) record_first_hit(slot, hit, v, surface.position, node.origin);
  bool unlit = has(kFeatureEmission) && (material.flags & kMaterialUnlit) != 0u;
  precise vec3 radiance = unlit ? v.bsdf.base_color : surface_emission(surface, material, v.front);
  if (!unlit && wave.bounce < frame.max_depth) {
    precise vec3 weight = node.weight * passed;
    node.weight = weight;
    if (bsdf_has_smooth(v.bsdf)) {
      radiance += whitted.ambient * v.bsdf.base_color * ((1.0 - v.bsdf.metallic) * (1.0 - v.bsdf.transmission));
      node.hit = hit;
      node.hit_weight = weight;
      node.hit_medium = node.medium;
      node.hit_path = node.path;
      node.hit_depth = wave.bounce;
      node.arrival = node.direction;
      nodes_of_trees[index] = node;
      nodes_of_trees[index].width = 0u;
    }
    branch(v, node, index);
  }
  return radiance * passed;
}

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= wave_slots() * whitted.width) return;
  WhittedNode node = nodes_of_trees[index];
  // A ray that another lane puts here meanwhile is of the next depth; read while it is written, it has that depth or
  // none.
  if (node.width == 0u || node.depth != wave.bounce) return;
  uint slot = index % wave_slots();
  path_sampler = slot_sampler(slot);
  alpha_kind = alpha_key(node.path, kHashExtend);
  nodes_of_trees[index].width = 0u;
  precise vec3 radiance = node.weight * follow(node, index, slot);
  PathState path = fetch_path(index);
  path.radiance += radiance;
  store_radiance(index, path);
  if (has(kFeatureAovs) && wave.bounce == 0u) path_aovs[slot].emission = radiance;
  if (wave.bounce == 0u) COUNT(counters.camera_rays, 1u) else COUNT(counters.bounce_rays, 1u)
}
