// Traces the rays that connect camera paths to vertices of light paths: a path gains their light unless they are
// blocked.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_PATHS
#define BIND_COUNTERS
#define BIND_CONNECTIONS
#define BIND_GROUPS
#include "kernels/bidirectional/bindings.glsl"
#include "kernels/bidirectional/records.glsl"
#include "kernels/bidirectional/volume_edge.glsl"
#include "kernels/path/light_groups.glsl"
#include "kernels/path/nonfinite.glsl"
#include "kernels/path/records.glsl"
#include "kernels/base/pixel.glsl"
#include "kernels/base/records.glsl"
#include "kernels/light/shadow.glsl"

#define ALPHA_TEST(hit) lets_light_through(hit)
#define ANY_HIT
#include "kernels/bvh/trace.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= connections.count) return;
  Connection ray = fetch_connection(index);
  begin_shadow();
  uint id = floatBitsToUint(texelFetch(triangles, int(ray.triangle * kTriangleTexels + 1u)).w);
  if (trace(ray.origin, ray.direction, 1.0, id, ray.instance).triangle != kNone) return;
  PathState path = fetch_path(ray.slot);
  if (!is_finite(path.radiance)) return; // another kernel has counted it
  vec3 light = ray.contribution * light_passed() * volume_passed(ray, slot_sampler(ray.slot));
  path.radiance += light;
  if (!is_finite(path.radiance)) count_nonfinite(kMakerConnect, ray.slot);
  store_radiance(ray.slot, path);
  if (HAS_LIGHT_GROUPS) add_to_group(ray.group, ray.slot, light);
}
