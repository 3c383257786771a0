// From rasterized visibility to the G-buffer, and to the queue that shading takes: the rays of the wave with their
// hits. The triangle of a pixel is known; the point on it is computed as for a traced ray, so that both are shaded
// alike.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_PATHS
#define BIND_RAYS
#define BIND_QUEUES
#define BIND_HYBRID
#define BIND_VISIBILITY
#define BIND_GBUFFER
#define BIND_SEEN
#define BIND_SHARED_COLORS
#define BIND_FRACTIONS
#include "kernels/hybrid/bindings.glsl"
#include "kernels/path/bindings.glsl"
#include "kernels/hybrid/fractions.glsl"
#include "kernels/hybrid/shared_colors.glsl"
#include "kernels/hybrid/frame_terms.glsl"
#include "kernels/hybrid/hybrid.glsl"
#include "kernels/bvh/known_triangle.glsl"
#include "kernels/path/bodies.glsl"
#include "kernels/path/records.glsl"
#include "kernels/base/pixel.glsl"
#include "kernels/surface/ray_cone.glsl"
#include "kernels/base/records.glsl"
#include "kernels/surface/surface.glsl"

layout(local_size_x = kWorkgroupSize) in;

// Mirror reflection is not part of the ambient term and gains nothing from filters: its light is found by following the
// reflection, with little noise, and changes from pixel to pixel. So smooth metal is kept apart from all others. (Not
// what is merely glossy: its diffuse light is as noisy as any; kept apart as well, Sponza's filtered relMSE is 6 times
// this. 2 frames, llvmpipe.)
const float kSmooth = 0.3; // roughness

GbufferPixel gbuffer_of(Hit hit, uint pixel_index, vec3 origin, vec3 direction, out float diffuse) {
  diffuse = 0.0;
  if (hit.triangle == kNone) return GbufferPixel(vec3(0.0), 0.0, vec3(0.0), kNone);
  Surface surface = fetch_surface(hit);
  Material material = fetch_material(surface.material);
  open_cone(hit, surface.position - origin);
  bool front = dot(surface.geometric_normal, direction) <= 0.0;
  uint placed =
      is_instanced() ? floatBitsToUint(texelFetch(instances, int(hit.instance * kInstanceTexels + 6u)).z) : 0u;
  GbufferPixel pixel;
  pixel.normal = shading_normal(surface, material, front, -direction);
  pixel.depth = camera_depth(surface.position, origin);
  float roughness = 1.0;
  diffuse = 1.0;
  if (has(kFeatureSpecular) && wants_lights()) {
    vec2 roughness_metallic = sample_value_or_1(kFeatureMetallicRoughnessTextures, material.metallic_roughness_texture,
                                                  surface.uv).gb * vec2(material.roughness, material.metallic);
    roughness = roughness_metallic.x;
    diffuse = 1.0 - roughness_metallic.y;
  }
  pixel.albedo = wants_lights() ? base_color(material, surface.uv, surface.color).rgb : vec3(1.0);
  pixel.surface = surface.material ^ placed * 0x9e3779b9u; // golden ratio: spreads instances over the words
  if (roughness < kSmooth && diffuse < 0.5) pixel.surface = ~pixel_index;
  return pixel;
}

void main() {
  uint local = gl_GlobalInvocationID.x;
  if (local == 0u) {
    queues.ray_count[0] = wave.pixel_count * wave.sample_count;
    queues.ray_count[1] = 0u;
    queues.shadow_count[0] = 0u;
  }
  if (local >= wave.pixel_count) return;

  uvec2 pixel = slot_pixel(local);
  uint pixel_index = pixel.y * frame.width + pixel.x;
  vec3 origin, direction;
  float t_max;
  hybrid_camera_ray(pixel, origin, direction, t_max);
  uvec2 visible = texelFetch(visibility, int(pixel_index)).xy;
  Hit hit = Hit(kNone, 0u, 0.0, 0.0);
  if (visible.x != kNone) hit = hit_of_triangle(visible.x, visible.y, origin, direction);
  float diffuse;
  gbuffer[pixel_index] = gbuffer_of(hit, pixel_index, origin, direction, diffuse);
  if (wants_lights()) seen[pixel_index] = vec4(vec3(0.0), diffuse);
  bool shades = multisamples() ? shared_color(pixel_index).shades : seen_fraction(pixel_index) > 0.0;
  if (!shades) hit.triangle = kNone; // its light is known, see share_shading.comp, or not seen
  for (uint s = 0u; s < wave.sample_count; ++s) {
    uint slot = s * wave.pixel_count + local;
    store_ray(slot, Ray(origin, slot, direction, kFar));
    store_hit(slot, hit);
    store_path(slot, PathState(vec3(shades && t_max > 0.0 ? 1.0 : 0.0), -1.0, vec3(0.0), 1.0));
    begin_bodies(slot);
  }
}
