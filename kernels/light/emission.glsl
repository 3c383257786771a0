// Emitted light: the radiance of a direction or a point on a light, and the density with which next-event estimation
// would have found it. Include bindings.glsl with BIND_GEOMETRY, BIND_SURFACES, BIND_LIGHTS and BIND_ENVIRONMENT first.
#ifndef WAVEPATH_EMISSION_GLSL
#define WAVEPATH_EMISSION_GLSL

#include "kernels/light/light_sampling.glsl"
#include "kernels/light/soft_lamps.glsl"
#ifdef BIND_LIGHT_TREE
#include "kernels/light/learned_sky.glsl"
#endif
#include "kernels/surface/surface.glsl"

// Weight of a technique with density `pdf` against another that would have had `other` (power heuristic, Veach 1997).
// As a ratio: squares of densities near a delta light would overflow.
float mis_weight(float pdf, float other) {
  float ratio = other / pdf;
  return 1.0 / (1.0 + ratio * ratio);
}

// Weight of light that the BSDF found by chance, where next-event estimation could have found it with density
// `light_pdf` per solid angle (0: never).
float emission_weight(float bsdf_pdf, float light_pdf) {
  if (kDirect == kDirectBsdf || bsdf_pdf < 0.0 || light_pdf <= 0.0) return 1.0;
  return kDirect == kDirectNee ? 0.0 : mis_weight(bsdf_pdf, light_pdf);
}

// Light that the point of the hit is on; kNone: none.
uint light_at(Surface surface, Hit hit) {
  if (!has(kFeatureTriangleLights) || surface.light == kNone) return kNone;
  if (!is_instanced()) return surface.light;
  return surface.light + floatBitsToUint(texelFetch(instances, int(hit.instance * kInstanceTexels + 6u)).w);
}

// Density per unit area with which next-event estimation picks the point of the hit by power; 0: not a light.
float light_pdf_area(Surface surface, Hit hit) {
  uint index = light_at(surface, hit);
  if (index == kNone) return 0.0;
  float mean = uintBitsToFloat(texelFetch(light_texels, int(index * kLightTexels + 3u)).x);
  if (!has(kFeatureEmissionTextures)) return mean;
  return mean *
         light_triangle_density(texelFetch(light_texels, int(index * kLightTexels + 4u)).z, vec2(hit.b1, hit.b2));
}

// Radiance leaving the surface on the side that the viewer sees.
vec3 surface_emission(Surface surface, Material material, bool front) {
  if (!has(kFeatureEmission)) return vec3(0.0);
  if (!front && (material.flags & kMaterialDoubleSided) == 0u) return vec3(0.0);
  return material.emission * sample_color_or_1(kFeatureEmissionTextures, material.emission_texture, surface.uv).rgb;
}

bool has_environment_map() { return has(kFeatureEnvironmentMap) && frame.environment_width > 0u; }

// Radiance from infinity, and the density per solid angle with which next-event estimation picks the direction.
vec3 environment_emission(vec3 direction, out float pdf) {
  pdf = 0.0;
  if (!has(kFeatureEnvironment)) return vec3(0.0);
  if (has_environment_map()) {
    vec3 radiance =
        environment_map_radiance(environment_point(environment_from_world(direction, frame.environment_rotation)), pdf);
    pdf *= frame.environment_probability;
    return frame.environment_radiance * radiance;
  }
  pdf = frame.environment_probability * warp_uniform_sphere_pdf();
  return frame.environment_radiance;
}

// A point or direction on a light as next-event estimation draws it.
struct LightSample {
  vec3 direction; // unit length, towards the light
  float pdf;      // per solid angle, the choice of the light included; punctual lights: of the choice alone
  vec3 radiance;  // arriving; of punctual lights the irradiance at normal incidence; zero: nothing to gain
  bool delta;     // no other technique can find it
  vec3 target;    // end of the shadow ray
  bool distant;   // the light is at infinity, in `direction`
  uint light;     // its index
};

LightSample no_light() { return LightSample(vec3(0.0), 0.0, vec3(0.0), false, vec3(0.0), false, 0u); }

LightSample sample_triangle_light(Light light, vec3 from, uvec2 u) {
  float density;
  vec2 weights = sample_light_triangle(light.parts, u, density);
  Surface surface = fetch_surface(Hit(light.triangle, light.instance, weights.x, weights.y));
  vec3 offset = surface.position - from;
  float distance_squared = dot(offset, offset);
  LightSample s = no_light();
  if (distance_squared == 0.0) return s;
  s.direction = offset / sqrt(distance_squared);
  float cosine = dot(surface.geometric_normal, s.direction);
  Material material = fetch_material(surface.material);
  s.radiance = surface_emission(surface, material, cosine < 0.0);
  if (has(kFeatureAlpha)) s.radiance *= opacity(material, base_color(material, surface.uv, surface.color).a);
  s.pdf = solid_angle_pdf(light.pdf_area * density, offset, surface.geometric_normal);
  s.target = offset_ray_origin(surface.position, surface.position_error, surface.geometric_normal, -s.direction);
  return s;
}

// By solid angle. The shadow ray ends where it meets the lamp.
LightSample sample_soft_lamp(Light light, vec3 from, uvec2 u) {
  LightSample s = no_light();
  s.distant = light.kind == kLightDirectional;
  vec3 offset = light.position - from, tangent, bitangent;
  vec3 axis = s.distant ? light.direction : safe_normalize(offset, vec3(0.0, 0.0, 1.0));
  float height = lamp_height(light, from);
  vec2 place = warp_disk(unit_float(u)); // of a cap as of a disc: area goes by the square of the radius
  float below = height * dot(place, place), sine2 = below * (2.0 - below);
  make_basis(axis, tangent, bitangent);
  s.direction =
      normalize(to_world(vec3(sqrt(height * (2.0 - below)) * place, 1.0 - below), tangent, bitangent, axis));
  float distance_ = 0.0;
  if (!s.distant) {
    float distance2 = dot(offset, offset), radius2 = square_of(lamp_extent(light)),
          along = sqrt(distance2) * (1.0 - below), half_ = sqrt(max(radius2 - distance2 * sine2, 0.0));
    bool inside = distance2 < radius2;
    distance_ = inside ? along + half_ : max((distance2 - radius2) / (along + half_), 0.0);
    s.target = from + distance_ * s.direction;
  }
  s.radiance = lamp_radiance(light, -s.direction, distance_);
  s.pdf = light.probability * cap_pdf(height);
  return s;
}

LightSample sample_punctual_light(Light light, vec3 from) {
  LightSample s = no_light();
  vec3 to_light;
  s.radiance = punctual_irradiance(light, from, to_light);
  s.delta = true;
  s.pdf = light.probability;
  s.distant = light.kind == kLightDirectional;
  s.direction = safe_normalize(to_light, light.direction);
  s.target = light.position;
  return s;
}

LightSample sample_environment(uvec2 u) {
  LightSample s = no_light();
  s.distant = true;
  if (has_environment_map()) {
    EnvironmentPoint at;
    s.direction = sample_environment_map(u, at);
    s.radiance = frame.environment_radiance * environment_map_radiance(at, s.pdf);
  } else {
    s.direction = warp_uniform_sphere(unit_float(u));
    s.pdf = warp_uniform_sphere_pdf();
    s.radiance = frame.environment_radiance;
  }
  s.pdf *= frame.environment_probability;
  return s;
}

// A point on a light that was picked by power, by what the pick left of u: both by one point of a net.
LightSample sample_picked_light(uint index, vec3 from, uvec2 u) {
  Light light = fetch_light(index);
  LightSample s = no_light();
  if (has(kFeatureEnvironment) && light.kind == kLightEnvironment)
    s = sample_environment(u);
  else if (has(kFeatureTriangleLights) && light.kind == kLightTriangle)
    s = sample_triangle_light(light, from, u);
  else if (has(kFeaturePunctualLights))
    s = sample_punctual_light(light, from);
  if (has_lobe(kFeatureSoftLamps) && is_soft(light))
    s = sample_soft_lamp(light, from, u);
  s.light = index;
  return s;
}

LightSample sample_light(vec3 from, uvec2 u) {
  uint index = pick_light(u);
  return sample_picked_light(index, from, u);
}

#ifdef BIND_LIGHT_TREE
// Samples a light, by the best selection available for the receiver. `ratio`: probability of the light, relative to
// selection by power.
LightSample sample_light(Receiver receiver, uvec2 u, out float ratio) {
  uint index = pick_light_for(receiver, u, ratio);
  if (index == kNone) return no_light();
  if (uses_learned_sky() && index >= placed_lights()) ratio *= pick_sky_part(receiver, u);
  LightSample s = sample_picked_light(index, receiver.position, u);
  s.pdf *= ratio;
  return s;
}

LightSample sample_light(Receiver receiver, uvec2 u) {
  float ratio;
  return sample_light(receiver, u, ratio);
}
#endif

#endif
