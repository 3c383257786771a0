// What the mirrored rays have met becomes what shading takes for first hits. Paths gain the ambient term there, which
// has no occlusion.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_PATHS
#define BIND_RAYS
#define BIND_QUEUES
#define BIND_HYBRID
#include "kernels/hybrid/bindings.glsl"
#include "kernels/path/bindings.glsl"
#include "kernels/hybrid/frame_terms.glsl"
#include "kernels/path/records.glsl"
#include "kernels/base/records.glsl"
#include "kernels/surface/vertex.glsl"

layout(local_size_x = kWorkgroupSize) in;

vec3 ambient_light(Hit hit, vec3 direction) {
  Surface surface = fetch_surface(hit);
  Material material = fetch_material(surface.material);
  if ((material.flags & kMaterialUnlit) != 0u) return vec3(0.0);
  Vertex v = make_vertex(surface, material, direction);
  return v.bsdf.base_color * (1.0 - v.bsdf.metallic) * hybrid.ambient;
}

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index == 0u) queues.shadow_count[0] = 0u;
  if (index >= queues.ray_count[0]) return;
  Ray ray = fetch_ray(index);
  Hit hit = fetch_hit(index);
  if (hit.triangle == kNone || !wants_ambient()) return;
  PathState path = fetch_path(ray.slot);
  path.radiance += path.throughput * ambient_light(hit, ray.direction);
  store_radiance(ray.slot, path);
}
