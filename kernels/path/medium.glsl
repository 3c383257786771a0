// Light within bodies: scattering (KHR_materials_volume_scatter): homogeneous, by a random walk; and the channel that a
// path carries behind glass that disperses (KHR_materials_dispersion). Include bindings.glsl with BIND_PATHS first.
#ifndef WAVEPATH_PATH_MEDIUM_GLSL
#define WAVEPATH_PATH_MEDIUM_GLSL

#include "kernels/base/dimensions.glsl"
#include "kernels/path/crossing.glsl"
#include "kernels/path/records.glsl"
#include "kernels/path/path_sampler.glsl"
#include "kernels/surface/vertex.glsl"
#include "kernels/volume/phase.glsl"

#ifdef LAYERED

const uint kHashMedium = 0x6d656469u; // apart from the keys of alpha (dimensions.glsl)

// Where light scatters along a path, drawn by the extinction of one channel, which is chosen by the share that the path
// still carries; weights are over the density of all three together, so that no channel is noisier than the others.
// Returns the distance, or `end` where the path arrives; multiplies the throughput.
float travel(uint medium, float end, Sampler path_sampler, inout vec3 throughput) {
  vec3 scattering = uintBitsToFloat(fetch_layers(medium, 7u).xyz);
  vec3 extinction = fetch_material(medium).attenuation;
  if (max_component(scattering) <= 0.0) {
    throughput *= exp(-extinction * end);
    return end;
  }
  vec3 probability = throughput * (scattering + vec3(1e-6) * extinction) / max(extinction, vec3(1e-20));
  float sum = probability.x + probability.y + probability.z;
  probability = sum > 0.0 ? probability / sum : vec3(1.0 / 3.0);
  float pick = hash_unit(path_sampler, wave.bounce, kHashMedium);
  float chosen = pick < probability.x                   ? extinction.x
                 : pick < probability.x + probability.y ? extinction.y
                                                        : extinction.z;
  float u = hash_unit(path_sampler, wave.bounce, kHashMedium + 1u);
  float distance_ = chosen > 0.0 ? -log(max(1.0 - u, 1e-10)) / chosen : end;
  bool scatters = distance_ < end;
  vec3 passed = exp(-extinction * min(distance_, end));
  float density = scatters ? dot(probability, extinction * passed) : dot(probability, passed);
  throughput *= (scatters ? scattering * passed : passed) / max(density, 1e-30);
  return min(distance_, end);
}

float medium_anisotropy(uint slot) { return uintBitsToFloat(fetch_layers(current_body(slot), 5u).w); }

bool is_in_scattering_medium(uint slot) { return uses_lobe(kLobeScattering) && current_body(slot) != kNone; }

// Scatters the path within the body that it is in, before it arrives at `end` metres. False: it arrives.
bool scatter_in_medium(Ray ray, float end, inout PathState path, out Ray next) {
  Sampler path_sampler = fetch_sampler(ray.slot);
  uint medium = current_body(ray.slot);
  float distance_ = travel(medium, end, path_sampler, path.throughput);
  if (!(distance_ < end)) return false;
  uint dimension = bounce_dimension(wave.bounce);
  float g = medium_anisotropy(ray.slot);
  vec3 wi = sample_phase(g, ray.direction, sample_2d(path_sampler, dimension + kDimensionDirection));
  path.bsdf_pdf = kDirect == kDirectBsdf || frame.light_count == 0u ? -1.0 : phase_pdf(g, dot(wi, ray.direction));
  next = Ray(ray.origin + distance_ * ray.direction, ray.slot, wi, kFar);
  return true;
}

void choose_channel(uint slot) {
  if (uses_lobe(kLobeDispersion)) path_channel = (fetch_sample(slot) + fetch_sampler(slot).scramble % 3u) % 3u;
}

// From the first glass that disperses on, the path carries one channel alone, three times as strong. A negative
// eta_scale says that it does.
void disperse(Vertex v, inout PathState path) {
  if (!has_lobe(kLobeDispersion) || !v.bsdf.disperses || path.eta_scale < 0.0) return;
  path.throughput *= vec3(path_channel == 0u, path_channel == 1u, path_channel == 2u) * 3.0;
  path.eta_scale = -path.eta_scale;
}

#else // bodies neither scatter nor disperse

float medium_anisotropy(uint slot) { return 0.0; }
bool is_in_scattering_medium(uint slot) { return false; }
bool scatter_in_medium(Ray ray, float end, inout PathState path, out Ray next) { return false; }
void choose_channel(uint slot) {}
void disperse(Vertex v, inout PathState path) {}

#endif
#endif
