// Local illumination of what the camera sees, in the place of the path tracer's shading: no direction is drawn, so that
// all light comes by one light sample and its shadow ray. A kernel defines SHINES if its model has highlights, includes
// this, and defines reflected().
//
// Colours are those of the glTF material: diffuse * (1 - metallic), and F0 of the highlights; a model without
// highlights has the base colour alone, of metal too. Emission, unlit surfaces and the environment behind all are as
// ever.
#ifndef WAVEPATH_LOCAL_GLSL
#define WAVEPATH_LOCAL_GLSL

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_LIGHTS
#define BIND_LIGHT_TREE
#define BIND_ENVIRONMENT
#define BIND_PATHS
#define BIND_RAYS
#define BIND_SHADOW_RAYS
#define BIND_QUEUES
#define BIND_COUNTERS
#define BIND_SEEN
#include "kernels/path/bindings.glsl"
#include "kernels/base/dimensions.glsl"
#include "kernels/light/emission.glsl"
#include "kernels/path/nonfinite.glsl"
#include "kernels/path/queue.glsl"
#include "kernels/path/records.glsl"
#include "kernels/base/pixel.glsl"
#include "kernels/surface/ray_cone.glsl"
#include "kernels/base/records.glsl"
#include "kernels/hybrid/shading/shading_types.h"
#include "kernels/surface/vertex.glsl"

layout(set = 0, binding = kBindShading, std140) uniform ShadingBlock { ShadingFrame shading; };

layout(local_size_x = kWorkgroupSize) in;

// Light that a white surface reflects to wo from irradiance out of wi; both have unit length and are above it. Returns
// diffuse part and highlight. `exponent`: Blinn's, for the cosine between normal and half vector.
vec2 reflected(vec3 n, vec3 wi, vec3 wo, float exponent);

// ---- the material ---------------------------------------------------------------------------------------------------

struct Paint {
  vec3 diffuse, highlight;
  float exponent;
};

// The exponent for which a Blinn lobe is as wide as Beckmann's of the same roughness (Walter et al. 2007, section 5.3:
// alpha^2 = 2 / (n + 2)). As far as numbers allow: a mirror's would be infinite.
const float kMostExponent = 1e5;
float exponent_of(float alpha) { return clamp(2.0 / (alpha * alpha) - 2.0, 0.0, kMostExponent); }

Paint paint_of(Surface surface, Material material, bool front) {
  vec3 base = base_color(material, surface.uv, surface.color).rgb;
#ifdef SHINES
  Bsdf b = make_bsdf(material, surface.uv, base, front);
  vec3 f0 = make_interface(b.ior, b.specular_color, b.specular, true).f0;
  return Paint(base * (1.0 - b.metallic), mix(f0, base, b.metallic), exponent_of(b.alpha));
#else
  return Paint(base, vec3(0.0), 0.0);
#endif
}

// ---- positions where the model is evaluated -------------------------------------------------------------------------

uint point_count() { return shading.interpolation == kInterpolateGouraud ? 3u : 1u; }

// Barycentric weights of the i-th position on the triangle: its middle, a corner, or the point that is seen.
vec2 point_weights(Hit hit, uint i) {
  if (shading.interpolation == kInterpolateFlat) return vec2(1.0 / 3.0);
  if (shading.interpolation == kInterpolatePhong) return vec2(hit.b1, hit.b2);
  return vec2(i == 1u ? 1.0 : 0.0, i == 2u ? 1.0 : 0.0);
}

// Weight of corner i at the point that is seen: barycentric in the triangle itself, not in its image, hence
// perspective-correct.
float point_fraction(Hit hit, uint i) {
  if (shading.interpolation != kInterpolateGouraud) return 1.0;
  return i == 0u ? 1.0 - hit.b1 - hit.b2 : i == 1u ? hit.b1 : hit.b2;
}

// Normals of corners know nothing of normal maps, as those of old had none. `seen_normal`: at the point that is seen.
vec3 point_normal(Surface surface, Material material, bool front, vec3 wo, vec3 seen_normal) {
  if (shading.interpolation == kInterpolatePhong) return seen_normal;
  if (shading.interpolation == kInterpolateFlat) return front ? surface.geometric_normal : -surface.geometric_normal;
  material.normal_texture = kNone;
  return shading_normal(surface, material, front, wo);
}

// ---- light ----------------------------------------------------------------------------------------------------------

// Attenuation relative to the inverse square of the distance.
float attenuation(LightSample light, vec3 from) {
  if ((shading.flags & kShadingAttenuates) == 0u || light.distant) return 1.0;
  vec3 offset = light.target - from;
  float d2 = dot(offset, offset);
  return d2 / (shading.attenuation.x + shading.attenuation.y * sqrt(d2) + shading.attenuation.z * d2);
}

// Fraction of the surface that depth leaves.
float cue_fraction(float depth) {
  if ((shading.flags & kShadingCues) == 0u) return 1.0;
  return clamp((shading.cue.y - depth) / (shading.cue.y - shading.cue.x), 0.0, 1.0);
}

// Diffuse and highlight that a point of the light brings to a position, of white surfaces.
mat2x3 lit_point(Ray ray, Hit at, Material material, bool front, vec3 seen_normal, float exponent, uint light,
                 uvec2 u) {
  Surface surface = fetch_surface(at);
  vec3 wo = is_orthographic() ? -ray.direction : safe_normalize(ray.origin - surface.position, -ray.direction);
  vec3 n = point_normal(surface, material, front, wo, seen_normal);
  LightSample s = sample_picked_light(light, surface.position, u);
  float cosine = dot(n, s.direction);
  if (!(s.pdf > 0.0) || !(cosine > 0.0)) return mat2x3(0.0);
  vec3 irradiance = s.radiance * (cosine * attenuation(s, surface.position) / s.pdf);
  vec2 fraction = reflected(n, s.direction, wo, exponent);
  return mat2x3(irradiance * fraction.x, irradiance * fraction.y);
}

// Next-event estimation: true if there is a shadow ray worth tracing. The ray leaves from the point that is seen,
// wherever light is evaluated; what faces away from the light is in its own shadow.
bool connect_to_light(Ray ray, Hit hit, Surface surface, Material material, bool front, float fraction,
                      out ShadowRay shadow) {
  vec3 facing = front ? surface.geometric_normal : -surface.geometric_normal;
  vec3 normal = shading_normal(surface, material, front, -ray.direction);
  Paint paint = paint_of(surface, material, front);
  if (shading.shininess >= 0.0) paint.exponent = shading.shininess;
  close_cone();
  Receiver receiver = unpack_receiver(uvec4(floatBitsToUint(surface.position), pack_normal(normal)));
  uvec2 u = sample_bits(slot_sampler(ray.slot), bounce_dimension(0u) + kDimensionLight);
  float ratio;
  uint index = pick_light_for(receiver, u, ratio);
  if (index == kNone) return false;
  LightSample seen_light = sample_picked_light(index, surface.position, u);
  if (!(seen_light.pdf > 0.0) || !(dot(seen_light.direction, facing) > 0.0)) return false;

  mat2x3 lit = mat2x3(0.0);
  for (uint i = 0u; i < point_count(); ++i) {
    vec2 weights = point_weights(hit, i);
    Hit at = Hit(hit.triangle, hit.instance, weights.x, weights.y);
    lit += point_fraction(hit, i) * lit_point(ray, at, material, front, normal, paint.exponent, index, u);
  }
  // Throughput: of the mirror that shows the surface.
  shadow.contribution = fetch_path(ray.slot).throughput *
                        ((paint.diffuse * lit[0] + paint.highlight * lit[1]) * (fraction / ratio));
  if (is_finite(shadow.contribution) && max_component(shadow.contribution) <= 0.0) return false;

  lift_surface(surface, front);
  shadow.slot = ray.slot;
  shadow.light = index;
  shadow.origin =
      offset_ray_origin(surface.position, surface.position_error, surface.geometric_normal, seen_light.direction);
  shadow.direction = seen_light.distant ? seen_light.direction : seen_light.target - shadow.origin;
  shadow.t_max = seen_light.distant ? kFar : 1.0;
  return true;
}

// Light that reaches the eye without a bounce, for all light samples of the frame, and the surface's part in the
// ambient term.
void see(uint slot, vec3 radiance, float ambient) {
  if (slot >= wave.pixel_count) return;
  uvec2 pixel = slot_pixel(slot);
  uint pixel_index = pixel.y * frame.width + pixel.x;
#ifdef SHINES
  ambient *= seen[pixel_index].w;
#endif
  seen[pixel_index] = vec4(radiance, ambient);
}

bool shade(Ray ray, Hit hit, out ShadowRay shadow) {
  float pdf;
  vec3 background = environment_emission(ray.direction, pdf);
  if (hit.triangle == kNone) {
    see(ray.slot, background, 0.0);
    return false;
  }
  Surface surface = fetch_surface(hit);
  Material material = fetch_material(surface.material);
  vec3 offset = surface.position - ray.origin;
  open_cone(hit, offset);
  bool front = dot(surface.geometric_normal, ray.direction) <= 0.0;
  bool unlit = has(kFeatureEmission) && (material.flags & kMaterialUnlit) != 0u;
  float fraction = cue_fraction(dot(offset, frame.camera_forward));
  vec3 emitted =
      unlit ? base_color(material, surface.uv, surface.color).rgb : surface_emission(surface, material, front);
  // Unlit surfaces take the ambient term no more than path tracing gives them light of a second bounce.
  see(ray.slot, fraction * emitted + (1.0 - fraction) * background, unlit ? 0.0 : fraction);
  if (unlit || fraction == 0.0 || frame.max_depth == 0u || frame.light_count == 0u) return false;
  return connect_to_light(ray, hit, surface, material, front, fraction, shadow);
}

void main() {
  uint index = gl_GlobalInvocationID.x;
  bool wants_shadow = false;
  ShadowRay shadow;
  if (index < queues.ray_count[0]) {
    Ray ray = fetch_ray(index);
    if (kMoves) open_shutter(slot_sampler(ray.slot));
    wants_shadow = shade(ray, fetch_hit(index), shadow);
  }
  uint append_index;
  APPEND(queues.shadow_count[0], wants_shadow, append_index);
  if (wants_shadow) store_shadow_ray(append_index, shadow);
}

#endif
