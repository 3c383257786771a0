// One step of a light path: arrival at a surface, and departure from it. Include bindings.glsl with BIND_GEOMETRY,
// BIND_SURFACES, BIND_PATHS and BIND_PATH_WEIGHTS first.
#ifndef WAVEPATH_LIGHT_STEP_GLSL
#define WAVEPATH_LIGHT_STEP_GLSL

#include "kernels/bidirectional/light_path.glsl"
#include "kernels/bidirectional/records.glsl"
#include "kernels/bidirectional/scattering.glsl"
#include "kernels/path/crossing.glsl"
#include "kernels/path/records.glsl"
#include "kernels/volume/bindings.glsl"
#include "kernels/volume/transmittance.glsl"

// Vertex where the ray met a surface; `cosine`: of the ray there. False if no camera path would find the light there.
bool light_arrives(Ray ray, Hit hit, inout PathState path, out Vertex v, out float cosine, out PathWeights weights) {
  if (hit.triangle == kNone) return false;
  Surface surface = fetch_surface(hit);
  Material material = fetch_material(surface.material);
  cosine = abs(dot(surface.geometric_normal, ray.direction));
  if (!(cosine > 0.0)) return false;
  vec3 offset = surface.position - ray.origin;
  v = make_vertex(surface, material, ray.direction);
  if (CULLS_ALL_BACKS && !v.front && is_single_sided(hit)) return false; // no camera path sees this side
  if (has(kFeatureVolume)) path.throughput *= medium_transmittance(current_body(ray.slot), length(offset));
  if (HAS_VOXELS && !is_in_body(ray.slot)) {
    begin_random(light_sampler(ray.slot), wave.bounce, kWalkOfLight);
    path.throughput *= volume_transmittance(ray.origin, ray.direction, length(offset), 1.0);
  }
  float distance_squared = path.bsdf_pdf != 0.0 ? dot(offset, offset) : 1.0;
  if (path.bsdf_pdf < 0.0) path.throughput *= range_window(path.bsdf_pdf, distance_squared);
  weights = arrived(fetch_weights(ray.slot), distance_squared, cosine);
  return true;
}

// Through a delta lobe, towards `w`: flux is not scaled by refraction as radiance is. False where a mirror shows an
// unlit surface instead of the light.
bool light_passes_delta(Vertex v, vec3 local, BsdfSample s, vec3 w, inout PathState path, inout PathWeights weights) {
  if (path.eta_scale < 0.0) return false;
  float out_cosine = surface_cosine(v, w), in_cosine = surface_cosine(v, v.wo), bend = abs(local.z) / abs(s.wi.z);
  path.throughput *= s.weight * (s.eta_scale * bend * out_cosine / in_cosine);
  weights = scattered_delta(weights, out_cosine, bend / s.eta_scale);
  return true;
}

// Straight on through a surface that another body hides, as camera paths go. False where these see an unlit surface
// instead.
bool light_passes_hidden(Ray ray, Vertex v, float cosine, inout PathState path, inout PathWeights weights,
                         out Ray next) {
  if (path.eta_scale < 0.0) return false;
  path.bsdf_pdf = 1.0;
  weights = scattered_delta(weights, cosine, 1.0);
  cross_surface(v, ray.slot);
  next = Ray(offset_ray_origin(v.surface.position, v.surface.position_error, v.surface.geometric_normal, ray.direction),
             ray.slot, ray.direction, kFar);
  return true;
}

// Departure towards `w`: false if Russian roulette ends the path.
bool light_departs(Vertex v, bool transmitted, vec3 w, float u, uint slot, inout PathState path, out Ray ray) {
  path.eta_scale = 1.0;
  path.bsdf_pdf = 1.0;
  float survival = sqrt(max_component(path.throughput)); // as bidirectional_shade.comp has it
  if (survival < 1.0 && wave.bounce > 2u) {
    if (!(u < survival)) return false;
    path.throughput /= survival;
  }
  if (!(max_component(path.throughput) > 0.0)) return false;

  if (has(kFeatureVolume) && transmitted && !v.bsdf.thin) cross_surface(v, slot);
  ray = Ray(offset_ray_origin(v.surface.position, v.surface.position_error, v.surface.geometric_normal, w), slot, w,
            kFar);
  return true;
}

#endif
