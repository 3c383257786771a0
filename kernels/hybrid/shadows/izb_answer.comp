// Answers the shadow rays that were in lists, and empties the lists for the next wave.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_PATHS
#define BIND_SHADOW_RAYS
#define BIND_QUEUES
#include "kernels/hybrid/shadows/bindings.glsl"
#include "kernels/path/bindings.glsl"
#include "kernels/path/records.glsl"
#include "kernels/base/records.glsl"
#include "kernels/light/shadow.glsl"
#include "kernels/hybrid/shadows/izb.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= queues.shadow_count[0]) return;
  uint link = link_word(index), cell = izb_links[link + 1u];
  if (cell == kNone) return;
  izb_cells[cell_word(cell)] = izb_cells[cell_word(cell) + 1u] = 0u; // all rays of a list write the same
  bool blocked = izb_links[link + 2u] != 0u;
  shadow_depth = izb_links[link + 3u];
  ShadowRay ray = fetch_shadow_ray(index);
  if (!blocked || shadow.ambient > 0.0) { // as in tracing, a blocked path gains nothing
    PathState path = fetch_path(ray.slot);
    path.radiance += ray.contribution * mix(vec3(shadow.ambient), vec3(1.0), blocked ? vec3(0.0) : light_passed());
    store_radiance(ray.slot, path);
  }
  ray.contribution = vec3(0.0);
  ray.t_max = -1.0; // ends its walk at the root
  store_shadow_ray(index, ray);
}
