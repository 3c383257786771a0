// Adds the light that lamps without a surface and the environment send to the faces of the wave, by kPatchLightSamples
// shadow rays from number wave.first_sample on, of wave.sample_count in all. Each goes from a point of its own on the
// patch; the lights take turns: wave.first_film_pixel of them, from number wave.bounce on.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_LIGHTS
#define BIND_ENVIRONMENT
#define BIND_COUNTERS
#define BIND_PATCHES
#include "kernels/path/bindings.glsl"
#include "kernels/light/emission.glsl"
#include "kernels/base/records.glsl"
#include "kernels/radiosity/patches.glsl"

Sampler path_sampler;
#include "kernels/light/shadow.glsl"

#define ALPHA_TEST(hit) lets_light_through(hit)
#define ANY_HIT
#include "kernels/bvh/trace.glsl"

layout(set = 0, binding = kBindPatchLight, std430) buffer PatchLightBlock { vec4 patch_light[]; };

layout(local_size_x = kWorkgroupSize) in;

// Irradiance by one light of the list, or by a sky of one colour, which is none of them; not yet shadowed. `n`: of the
// face.
vec3 unshadowed(uint light, vec3 from, vec3 n, uvec2 u, out LightSample s) {
  if (light >= frame.light_count) {
    vec3 tangent, bitangent;
    make_basis(n, tangent, bitangent);
    s = no_light();
    s.distant = true;
    s.direction = to_world(warp_cosine_hemisphere(unit_float(u)), tangent, bitangent, n);
    return kPi * frame.environment_radiance;
  }
  float probability = fetch_light(light).probability;
  s = sample_picked_light(light, from, u);
  float cosine = dot(n, s.direction);
  return s.pdf > 0.0 && cosine > 0.0 ? s.radiance * (cosine * probability / s.pdf) : vec3(0.0);
}

void main() {
  if (gl_GlobalInvocationID.x >= wave.pixel_count) return;
  uint face = wave.first_pixel + gl_GlobalInvocationID.x;
  uint first_light = wave.bounce, lights = wave.first_film_pixel, rays = 0u;
  uint end = min(wave.first_sample + kPatchLightSamples, wave.sample_count);
  vec3 sum = wave.first_sample == 0u ? vec3(0.0) : patch_light[face].rgb;
  path_sampler = make_replicate_sampler(frame.seed, face, 1u, 0u, wave.sample_count);
  for (uint i = wave.first_sample; i < end; ++i) {
    path_sampler.index = i / lights;
    uint turn = i % lights;
    Surface surface = fetch_surface(point_of_patch(face / 2u, sample_2d(path_sampler, 2u * turn)));
    vec3 n = (face & 1u) != 0u ? -surface.geometric_normal : surface.geometric_normal;
    LightSample s;
    vec3 light = unshadowed(first_light + turn, surface.position, n, sample_bits(path_sampler, 2u * turn + 1u), s);
    if (!(max_component(light) > 0.0)) continue;
    vec3 origin = offset_ray_origin(surface.position, surface.position_error, surface.geometric_normal, n);
    vec3 direction = s.distant ? s.direction : s.target - origin;
    begin_shadow();
    ++rays;
    if (trace(origin, direction, s.distant ? kFar : 1.0, kNone, 0u).triangle != kNone) continue;
    sum += light * light_passed() * (float(lights) / float(wave.sample_count));
  }
  patch_light[face] = vec4(sum, 0.0);
  COUNT(counters.shadow_rays, rays)
}
