// One diffuse bounce by rays: one ray for each light sample, cosine-weighted about the normal of the first hit, becomes
// the queue. What the frame has seen so far is put away, because shading what the rays meet writes to the same place;
// reflect_answer.comp puts it back.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_PATHS
#define BIND_RAYS
#define BIND_QUEUES
#define BIND_HYBRID
#define BIND_VISIBILITY
#define BIND_SEEN
#define BIND_REFLECTIONS
#include "kernels/hybrid/bindings.glsl"
#include "kernels/path/bindings.glsl"
#include "kernels/base/dimensions.glsl"
#include "kernels/base/pixel.glsl"
#include "kernels/bvh/known_triangle.glsl"
#include "kernels/hybrid/hybrid.glsl"
#include "kernels/path/bodies.glsl"
#include "kernels/path/queue.glsl"
#include "kernels/path/records.glsl"
#include "kernels/surface/ray_cone.glsl"
#include "kernels/surface/vertex.glsl"

layout(local_size_x = kWorkgroupSize) in;

// Its random numbers are those of a bounce that hybrid paths do not have; the bounces before are taken by occlusion and
// layers.
const uint kDiffuseBounce = 3u;

// False if the pixel shows nothing that light bounces off. `weight`: light that leaves for light along the ray, the
// cosine over the density of directions included.
bool find_bounce(uvec2 pixel, vec2 u, out Ray ray, out vec3 weight) {
  uvec2 visible = texelFetch(visibility, int(pixel.y * frame.width + pixel.x)).xy;
  if (visible.x == kNone) return false;
  vec3 eye, towards;
  hybrid_camera_ray(pixel, eye, towards);
  Hit hit = hit_of_triangle(visible.x, visible.y, eye, towards);
  Surface surface = fetch_surface(hit);
  Material material = fetch_material(surface.material);
  if ((material.flags & kMaterialUnlit) != 0u) return false;
  open_cone(hit, surface.position - eye);
  Vertex v = make_vertex(surface, material, towards);
  close_cone();
  weight = v.bsdf.base_color * ((1.0 - v.bsdf.metallic) * (1.0 - v.bsdf.transmission));
  ray.direction = normalize(to_world(warp_cosine_hemisphere(u), v.tangent, v.bitangent, v.normal));
  ray.t_max = kFar;
  ray.origin = offset_ray_origin(v.surface.position, v.surface.position_error, v.surface.geometric_normal,
                                 ray.direction);
  return max_component(weight) > 0.0 && sides_agree(v, ray.direction);
}

void main() {
  uint slot = gl_GlobalInvocationID.x;
  Ray ray;
  vec3 weight;
  bool found = false;
  if (slot < wave.pixel_count * wave.sample_count) {
    uvec2 pixel = slot_pixel(slot);
    uint pixel_index = pixel.y * frame.width + pixel.x;
    if (slot < wave.pixel_count) reflections[pixel_index] = seen[pixel_index];
    vec2 u = sample_2d(slot_sampler(slot), bounce_dimension(kDiffuseBounce) + kDimensionDirection);
    found = find_bounce(pixel, u, ray, weight);
    store_path(slot, PathState(found ? weight : vec3(0.0), -1.0, vec3(0.0), 1.0));
    begin_bodies(slot);
  }
  uint index;
  APPEND(queues.ray_count[0], found, index);
  if (!found) return;
  ray.slot = slot;
  store_ray(index, ray);
}
