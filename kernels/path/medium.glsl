// Scattering within bodies (KHR_materials_volume_scatter): homogeneous, by a random walk. Include vertex.glsl first.
#ifndef WAVEPATH_PATH_MEDIUM_GLSL
#define WAVEPATH_PATH_MEDIUM_GLSL

#include "kernels/vertex.glsl"

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
  vec3 share = throughput * (scattering + vec3(1e-6) * extinction) / max(extinction, vec3(1e-20));
  float sum = share.x + share.y + share.z;
  share = sum > 0.0 ? share / sum : vec3(1.0 / 3.0);
  float pick = hash_unit(path_sampler, wave.bounce, kHashMedium);
  float chosen = pick < share.x ? extinction.x : pick < share.x + share.y ? extinction.y : extinction.z;
  float u = hash_unit(path_sampler, wave.bounce, kHashMedium + 1u);
  float distance_ = chosen > 0.0 ? -log(max(1.0 - u, 1e-10)) / chosen : end;
  bool scatters = distance_ < end;
  vec3 passed = exp(-extinction * min(distance_, end));
  float density = scatters ? dot(share, extinction * passed) : dot(share, passed);
  throughput *= (scatters ? scattering * passed : passed) / max(density, 1e-30);
  return min(distance_, end);
}

// A direction from the phase function of Henyey and Greenstein about the one that light goes on in.
vec3 sample_phase(float g, vec3 forward, vec2 u) {
  float t = (1.0 - g * g) / (1.0 - g + 2.0 * g * u.x);
  float cosine = abs(g) < 1e-3 ? 1.0 - 2.0 * u.x : clamp((1.0 + g * g - t * t) / (2.0 * g), -1.0, 1.0);
  vec3 tangent, bitangent;
  make_basis(forward, tangent, bitangent);
  float sine = sqrt(max(1.0 - cosine * cosine, 0.0));
  vec2 around = sine * cos_sin_turns(u.y);
  return normalize(tangent * around.x + bitangent * around.y + forward * cosine);
}

#endif
