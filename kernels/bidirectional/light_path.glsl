// Where light paths begin: a light chosen by its power, a point on it and a direction from it. Include bindings.glsl
// with BIND_GEOMETRY, BIND_SURFACES, BIND_LIGHTS and BIND_ENVIRONMENT first.
#ifndef WAVEPATH_LIGHT_PATH_GLSL
#define WAVEPATH_LIGHT_PATH_GLSL

#include "kernels/bidirectional/weights.glsl"
#include "kernels/light/emission.glsl"
#include "kernels/base/pixel.glsl"

// Light paths draw from dimensions of their own: those of a sampler with another seed. As they do not belong to their
// pixels, those of a whole picture share one Sobol sequence for each replicate: what they bring to a pixel is
// stratified however few a pixel's own are.
//
// True if the light paths carry photons. They belong to no pixel: their wave counts them by `first_pixel`, and has a
// sample number for each map and replicate.
bool traces_photons() { return wave.first_film_pixel == kNone; }

Sampler light_sampler(uint slot) {
  uint seed = frame.seed ^ 0x4c494748u, owner, path, paths; // `paths`: of one sample of all pixels
  if (traces_photons()) {
    seed ^= 0x50484f54u;
    owner = path = wave.first_pixel + slot;
    paths = photon_frame.path_count;
  } else {
    uvec2 pixel = slot_pixel(slot);
    owner = pixel.y * frame.width + pixel.x;
    path = slot_entry(slot);
    paths = frame.width * frame.height;
  }
  Sampler s = make_sampler(seed, owner, slot_sample(slot), frame.sample_total);
  if (kSampler == kSamplerSobol) {
    uint high, low, carry;
    umulExtended(s.index, paths, high, low);
    s.index = uaddCarry(low, path, carry);
    s.scramble = pcg3d(uvec3(seed, high + carry, s.replicate + 0x80000000u)).x; // another sequence after 2^32 paths
  }
  return s;
}

bool is_single_sided(Hit hit) {
  return has(kFeatureCull) &&
         (floatBitsToUint(texelFetch(triangles, int(hit.triangle * kTriangleTexels)).w) & kTriangleSingleSided) != 0u;
}

struct LightStart {
  vec3 origin;
  vec3 direction;
  vec3 light; // radiance times cosine (or intensity, or irradiance) over the density of all choices
  float inverse_range; // inverse range of the light, see range_window()
  PathWeights weights;
  bool distant;
  uint index; // index of the light
};

// Density per solid angle of directions from a triangle: cosine-weighted, on both sides if both shine.
float triangle_direction_pdf(Material material, float cosine) {
  bool both = (material.flags & kMaterialDoubleSided) != 0u;
  return warp_cosine_hemisphere_pdf(cosine) * (both ? 0.5 : 1.0);
}

// Cosine of the cone of directions from a point or spot light.
float cone_cosine(Light light) { return light.kind == kLightSpot ? -light.spot_offset / light.spot_scale : -1.0; }
float cone_pdf(Light light) { return 0.5 * kInvPi / (1.0 - cone_cosine(light)); }

// Per area of the disk across the scene from which light of infinity is sent.
float disk_pdf() { return kInvPi / square(bidirectional.scene_radius); }

void start_on_triangle(Light light, uvec2 u_position, vec2 u_direction, inout LightStart start) {
  float density;
  vec2 weights = sample_light_triangle(light.parts, u_position, density);
  float pdf_area = light.pdf_area * density;
  Surface surface = fetch_surface(Hit(light.triangle, light.instance, weights.x, weights.y));
  Material material = fetch_material(surface.material);
  bool both = (material.flags & kMaterialDoubleSided) != 0u;
  bool front = !both || u_direction.x < 0.5;
  if (both) u_direction.x = min(front ? 2.0 * u_direction.x : 2.0 * u_direction.x - 1.0, kOneMinusEpsilon);
  vec3 normal = front ? surface.geometric_normal : -surface.geometric_normal, tangent, bitangent;
  make_basis(normal, tangent, bitangent);
  vec3 local = warp_cosine_hemisphere(u_direction);
  start.direction = normalize(to_world(local, tangent, bitangent, normal));
  float cosine = max(dot(start.direction, normal), 1e-7), direction_pdf = triangle_direction_pdf(material, cosine);
  start.origin = offset_ray_origin(surface.position, surface.position_error, surface.geometric_normal, start.direction);
  vec3 radiance = surface_emission(surface, material, front);
  if (has(kFeatureAlpha)) radiance *= opacity(material, base_color(material, surface.uv, surface.color).a);
  start.light = radiance * (cosine / (pdf_area * direction_pdf));
  start.weights = PathWeights(1.0 / square(direction_pdf), square(cosine / (pdf_area * direction_pdf)));
}

void start_at_point(Light light, vec2 u_direction, inout LightStart start) {
  float low = cone_cosine(light);
  float height = (1.0 - low) * u_direction.x; // below the pole
  vec3 tangent, bitangent, axis = light.kind == kLightSpot ? light.direction : vec3(0.0, 0.0, 1.0);
  make_basis(axis, tangent, bitangent);
  vec2 rim = sqrt(max(height * (2.0 - height), 0.0)) * cos_sin_turns(u_direction.y);
  start.direction = normalize(to_world(vec3(rim, 1.0 - height), tangent, bitangent, axis));
  start.origin = light.position;
  start.inverse_range = light.inverse_range;
  light.inverse_range = 0.0; // it dims what arrives
  light.position = vec3(0.0); // irradiance at unit distance is intensity
  vec3 ignored;
  start.light = punctual_irradiance(light, start.direction, ignored) / (light.probability * cone_pdf(light));
  start.weights = PathWeights(1.0 / square(cone_pdf(light)), 0.0);
}

// On a soft lamp: the direction as from a point, the position even over the disc that the sphere shows to it. The
// weight of a connection depends on where the path arrives: start_ratio().
void start_on_sphere(Light light, uvec2 u_position, vec2 u_direction, inout LightStart start) {
  start_at_point(light, u_direction, start);
  float radius = lamp_extent(light);
  vec2 place = warp_disk(unit_float(u_position));
  vec3 tangent, bitangent;
  make_basis(start.direction, tangent, bitangent);
  float ahead = sqrt(max(1.0 - dot(place, place), 0.0));
  start.origin += radius * (ahead * start.direction + place.x * tangent + place.y * bitangent);
  start.weights.others = square(kPi * square(radius) / (light.probability * cone_pdf(light)));
}

// What a light path that begins on a soft lamp has to scale its weight of a connection by, where it arrives at `at`:
// PathWeights then assume a point.
float start_ratio(Light light, vec3 at, float distance_squared) {
  return lamp_pdf(light, at) * kPi * square(lamp_extent(light)) / distance_squared;
}

// Density with which a light path begins where a camera path, on its way from `from`, meets a lamp, and takes the same
// way: per solid angle there and area across it.
float lamp_start_pdf(Light light, vec3 from) {
  if (light.kind == kLightDirectional) return light.probability * lamp_pdf(light, from) * disk_pdf();
  if (lamp_height(light, from) > 1.0) return 0.0; // light paths begin outwards
  return light.probability * cone_pdf(light) * kInvPi / square(lamp_extent(light));
}

// `to_light`: of unit length.
void start_at_infinity(vec3 to_light, vec2 u_position, inout LightStart start) {
  vec3 tangent, bitangent;
  make_basis(to_light, tangent, bitangent);
  vec2 position = warp_disk(u_position);
  start.direction = -to_light;
  start.origin = bidirectional.scene_centre +
                 bidirectional.scene_radius * (to_light + position.x * tangent + position.y * bitangent);
  start.distant = true;
  start.weights = PathWeights(1.0 / square(disk_pdf()), 0.0);
}

// False if the path begins without light.
bool start_light_path(Sampler path_sampler, out LightStart start) {
  start = LightStart(vec3(0.0), vec3(0.0, 0.0, 1.0), vec3(0.0), 0.0, PathWeights(0.0, 0.0), false, 0u);
  uvec2 u_light = sample_bits(path_sampler, kDimensionLight);
  vec2 u = sample_2d(path_sampler, kDimensionDirection); // random numbers of the direction; of the position if the
                                                         // direction is the light's
  start.index = pick_light(u_light);
  Light light = fetch_light(start.index);
  if (has(kFeatureEnvironment) && light.kind == kLightEnvironment) {
    LightSample s = sample_environment(u_light);
    start_at_infinity(s.direction, u, start);
    start.light = s.radiance / (s.pdf * disk_pdf());
    start.weights.others = 1.0 / square(s.pdf * disk_pdf());
    if (!(s.pdf > 0.0)) return false;
  } else if (has(kFeatureTriangleLights) && light.kind == kLightTriangle) {
    start_on_triangle(light, u_light, u, start);
  } else if (has_lobe(kFeatureSoftLamps) && is_soft(light) && light.kind == kLightDirectional) {
    LightSample s = sample_soft_lamp(light, vec3(0.0), u_light);
    start_at_infinity(s.direction, u, start);
    start.light = s.radiance / (s.pdf * disk_pdf());
    start.weights.others = 1.0 / square(s.pdf * disk_pdf());
  } else if (has_lobe(kFeatureSoftLamps) && is_soft(light)) {
    start_on_sphere(light, u_light, u, start);
  } else if (has(kFeaturePunctualLights) && light.kind == kLightDirectional) {
    start_at_infinity(light.direction, u, start);
    start.light = light.intensity / (light.probability * disk_pdf());
  } else if (has(kFeaturePunctualLights)) {
    start_at_point(light, u, start);
  }
  if (!uses_technique(kTechniqueLight)) start.weights.connect = 0.0;
  if (!uses_technique(kTechniqueHit)) start.weights.others = 0.0;
  start.weights = bounded(start.weights);
  return max_component(start.light) > 0.0;
}

// Density per area, at a surface with the given cosine, with which a light path that begins where `s` ends would find
// it.
float start_pdf_area(LightSample s, vec3 from, float cosine) {
  if (s.distant) return disk_pdf() * cosine;
  Light light = fetch_light(s.light);
  vec3 offset = light.position - from;
  float direction_pdf;
  if (has(kFeatureTriangleLights) && light.kind == kLightTriangle) {
    Surface surface = fetch_surface(Hit(light.triangle, light.instance, 1.0 / 3.0, 1.0 / 3.0));
    direction_pdf =
        triangle_direction_pdf(fetch_material(surface.material), abs(dot(surface.geometric_normal, s.direction)));
    offset = s.target - from;
  } else if (has_lobe(kFeatureSoftLamps) && is_soft(light)) {
    return lamp_start_pdf(light, from) * cosine / (light.probability * lamp_pdf(light, from));
  } else {
    direction_pdf = cone_pdf(light);
  }
  return direction_pdf * cosine / dot(offset, offset);
}

#endif
