// Traces the rays from the camera to vertices of light paths: the film gains their light unless they are blocked. Dispatched
// for every band of the film; push constants `first_film_pixel` and `sample_count` say which pixels it holds.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_LIGHTS
#define BIND_ENVIRONMENT
#define BIND_COUNTERS
#define BIND_CONNECTIONS
#define BIND_SPLATS
#include "kernels/bidirectional/bindings.glsl"
#include "kernels/bidirectional/light_path.glsl"
#include "kernels/bidirectional/records.glsl"
#include "kernels/film/splat.glsl"
#include "kernels/path/nonfinite.glsl"

Sampler path_sampler;
#define ALPHA_TEST(hit) is_hole(hit, path_sampler, kHashConnect)
#define ANY_HIT
#include "kernels/bvh.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= connections.count) return;
  Connection ray = fetch_connection(index);
  uint pixel = ray.pixel - wave.first_film_pixel, band_pixels = wave.sample_count;
  if (pixel >= band_pixels) return;
  if (has(kFeatureAlpha)) path_sampler = light_sampler(ray.slot);
  uint id = floatBitsToUint(texelFetch(triangles, int(ray.triangle * kTriangleTexels + 1u)).w);
  if (trace(ray.origin, ray.direction, 1.0, id, ray.instance).triangle != kNone) return;
  if (max_component(ray.contribution) < kLargestSplat)
    splat(pixel * kReplicates + slot_sample(ray.slot) % kReplicates, ray.contribution);
  else
    count_nonfinite(kMakerConnect, ray.slot);
}
