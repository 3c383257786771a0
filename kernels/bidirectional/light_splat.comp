// Traces the rays from the camera to vertices of light paths: the film gains their light unless they are blocked.
// Dispatched for every band of the film; push constants `first_film_pixel` and `sample_count` say which pixels it
// holds.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_COUNTERS
#define BIND_CONNECTIONS
#define BIND_SPLATS
#define BIND_GROUPS
#include "kernels/bidirectional/bindings.glsl"
#include "kernels/bidirectional/records.glsl"
#include "kernels/bidirectional/volume_edge.glsl"
#include "kernels/film/splat.glsl"
#include "kernels/path/light_groups.glsl"
#include "kernels/path/nonfinite.glsl"
#include "kernels/base/pixel.glsl"
#include "kernels/base/records.glsl"
#define SHADOW_SEES_UNLIT true
#include "kernels/light/shadow.glsl"

#define ALPHA_TEST(hit) lets_light_through(hit)
#define ANY_HIT
#define CAMERA_RAYS true
#include "kernels/bvh/trace.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= connections.count) return;
  Connection ray = fetch_connection(index);
  uint pixel = ray.pixel - wave.first_film_pixel, band_pixels = wave.sample_count;
  if (pixel >= band_pixels) return;
  begin_shadow();
  uint id = floatBitsToUint(texelFetch(triangles, int(ray.triangle * kTriangleTexels + 1u)).w);
  if (trace(ray.origin, ray.direction, 1.0, id, ray.instance).triangle != kNone) return;
  vec3 light = ray.contribution * light_passed() * volume_passed(ray, slot_sampler(ray.slot));
  if (max_component(light) < kLargestSplat) {
    splat(pixel * kReplicates + slot_sample(ray.slot) % kReplicates, light);
    if (HAS_LIGHT_GROUPS) splat(band_pixels * kReplicates + pixel * group_count() + ray.group, light);
  } else {
    count_nonfinite(kMakerConnect, ray.slot);
  }
}
