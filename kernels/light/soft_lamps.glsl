// Punctual lights with an extent (kFeatureSoftLamps), of the same power as without. A directional light is a cone of
// directions of one radiance, E / (pi sin^2), so that a surface that faces its middle receives E. A point or spot light
// is a sphere that shows a disc of radiance I(direction) / (pi r^2) to every direction, whichever point of the sphere a
// ray leaves. Rays see it where they first meet the sphere, from inside too, and go on behind it. Include bindings.glsl
// with BIND_LIGHTS first.
#ifndef WAVEPATH_SOFT_LAMPS_GLSL
#define WAVEPATH_SOFT_LAMPS_GLSL

#include "kernels/light/light_sampling.glsl"

bool has_soft_lamps() { return has_lobe(kFeatureSoftLamps) && (frame.scene_lobes & kFeatureSoftLamps) != 0u; }

float lamp_extent(Light light) { return light.pdf_area; } // see Light
// False for triangles and the environment, which have other values in that place.
bool is_soft(Light light) {
  return has_lobe(kFeatureSoftLamps) && light.kind != kLightTriangle && light.kind != kLightEnvironment &&
         lamp_extent(light) > 0.0;
}

float square_of(float x) { return x * x; }

// Density of directions in a cone, by 1 minus the cosine of half its angle (the height of the cap that it cuts from a
// sphere of radius 1); and sin^2 of half its angle. Both hold their precision for the narrowest cones.
float cap_pdf(float height) { return 0.5 * kInvPi / height; }
float cap_sine2(float height) { return height * (2.0 - height); }

// The directions under which a point sees a lamp, as such a height: all of them from inside of a sphere.
float lamp_height(Light light, vec3 from) {
  if (light.kind == kLightDirectional) return lamp_extent(light);
  vec3 offset = light.position - from;
  float sine2 = square_of(lamp_extent(light)) / dot(offset, offset);
  return sine2 < 1.0 ? sine2 / (1.0 + sqrt(1.0 - sine2)) : 2.0;
}

// Density per solid angle with which such a point draws a direction to the lamp, once it has picked that.
float lamp_pdf(Light light, vec3 from) { return cap_pdf(lamp_height(light, from)); }

// Distance at which a ray first meets a lamp's sphere; kFar: nowhere.
float distance_to_lamp(vec3 centre, float radius, vec3 from, vec3 direction) {
  vec3 offset = centre - from;
  float along = dot(offset, direction), radius2 = square_of(radius), distance2 = dot(offset, offset);
  vec3 beside = offset - along * direction;
  float half2 = radius2 - dot(beside, beside); // of the chord
  bool inside = distance2 < radius2;
  if (!(half2 > 0.0) || (!inside && along < 0.0)) return kFar;
  float half_ = sqrt(half2);
  return inside ? along + half_ : max((distance2 - radius2) / (along + half_), 0.0);
}

// Radiance that a lamp sends along `direction`, away from it, over a distance.
vec3 lamp_radiance(Light light, vec3 direction, float distance_) {
  if (light.kind == kLightDirectional) return light.intensity * (kInvPi / cap_sine2(lamp_extent(light)));
  light.inverse_range *= distance_; // as that of a point at unit distance
  float fades = range_window(light.inverse_range, 1.0);
  light.inverse_range = 0.0;
  light.position = vec3(0.0);
  vec3 ignored;
  return punctual_irradiance(light, direction, ignored) * (fades * kInvPi / square_of(lamp_extent(light)));
}

#ifdef BIND_LIGHTS
// The radius of a local light by its index; 0 for triangles, which have other values in that place.
float sphere_radius(uint index) {
  if (texelFetch(light_texels, int(index * kLightTexels)).w == kLightTriangle) return 0.0;
  return uintBitsToFloat(texelFetch(light_texels, int(index * kLightTexels + 3u)).x);
}

vec3 light_position(uint index) { return uintBitsToFloat(texelFetch(light_texels, int(index * kLightTexels)).xyz); }
#endif

// True if the direction is one of a directional light's.
bool is_in_cone(Light light, vec3 direction) {
  vec3 beside = direction - light.direction; // its square: twice the height of a cap
  return light.kind == kLightDirectional && is_soft(light) && dot(beside, beside) <= 2.0 * lamp_extent(light);
}

#endif
