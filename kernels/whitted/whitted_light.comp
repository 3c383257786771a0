// Sends kLightsAtOnce shadow rays from every surface that whitted_trace.comp found, from number wave.first_film_pixel
// on (the film plays no part here).
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_LIGHTS
#define BIND_ENVIRONMENT
#define BIND_PATHS
#define BIND_COUNTERS
#include "kernels/path/bindings.glsl"
#include "kernels/light/emission.glsl"
#include "kernels/path/records.glsl"
#include "kernels/base/pixel.glsl"
#include "kernels/surface/vertex.glsl"
#include "kernels/whitted/whitted.glsl"

Sampler path_sampler;
#define SHADOW_PASSES_PANES
#include "kernels/light/shadow.glsl"

#define ALPHA_TEST(hit) lets_light_through(hit, t_pending)
#define ANY_HIT
#include "kernels/bvh/trace.glsl"

layout(local_size_x = kWorkgroupSize) in;

uint shadow_ray_count = 0u;

LightSample sample_one_light(Light light, vec3 from, uvec2 u) {
  if (has(kFeatureEnvironment) && light.kind == kLightEnvironment) return sample_environment(u);
  if (has(kFeatureTriangleLights) && light.kind == kLightTriangle) return sample_triangle_light(light, from, u);
  if (has(kFeaturePunctualLights)) return sample_punctual_light(light, from);
  return no_light();
}

// A sky of one colour, which is no light in the list: paths find it by the BSDF alone.
LightSample sample_sky(uvec2 u) {
  LightSample s = no_light();
  s.distant = true;
  s.direction = warp_uniform_sphere(unit_float(u));
  s.pdf = warp_uniform_sphere_pdf();
  s.radiance = frame.environment_radiance;
  return s;
}

// Where shadow ray `number` goes, with the density of all such rays, and the triangle that it may end on.
LightSample sample_for_ray(uint number, vec3 from, uint dimension, out uvec2 triangle) {
  uvec2 u = sample_bits(path_sampler, dimension);
  triangle = uvec2(kNone, 0u);
  bool picks =
      has(kFeatureTriangleLights) && number < whitted.triangle_rays && whitted.triangle_rays < whitted.triangles;
  uint index = number < whitted.triangle_rays ? number : number - whitted.triangle_rays + whitted.triangles;
  if (picks) index = pick_light(u);
  if (has(kFeatureEnvironment) && index >= frame.light_count) return sample_sky(u);
  Light light = fetch_light(index);
  LightSample s = sample_one_light(light, from, u);
  float rays = picks ? float(whitted.triangle_rays) * light.probability : 1.0; // rays that go to this light
  s.pdf = picks && index >= whitted.triangles ? 0.0 : s.pdf / light.probability * rays; // others have rays of their own
  if (has(kFeatureTriangleLights) && light.kind == kLightTriangle) triangle = uvec2(light.triangle_id, light.instance);
  return s;
}

// Light of one shadow ray that the surface sends along v.wo, by its lobes that are no mirror.
vec3 lit_by(uint number, Vertex v, uint medium, uint path) {
  uvec2 triangle;
  LightSample s = sample_for_ray(number, v.surface.position, node_dimension(path) + number, triangle);
  precise float pdf = s.pdf;
  if (max_component(s.radiance) <= 0.0 || !(pdf > 0.0) || !sides_agree(v, s.direction)) return vec3(0.0);
  float bsdf_pdf;
  precise vec3 value = vertex_eval(v, s.direction, bsdf_pdf) * s.radiance / pdf;
  float distance_ = s.distant ? kFarAway : length(s.target - v.surface.position);
  if (is_below(v, s.direction) && !v.bsdf.thin) medium = medium_behind(v);
  if (has(kFeatureVolume) && !uses_walls()) value *= medium_transmittance(medium, distance_);
  if (is_finite(value) && max_component(value) <= 0.0) return vec3(0.0);
  vec3 origin =
      offset_ray_origin(v.surface.position, v.surface.position_error, v.surface.geometric_normal, s.direction);
  ++shadow_ray_count;
  vec3 direction = s.distant ? s.direction : s.target - origin;
  begin_shadow(direction);
  bool blocked = trace(origin, direction, s.distant ? kFar : 1.0, triangle.x, triangle.y).triangle != kNone;
  if (blocked) return vec3(0.0);
  if (has(kFeatureVolume) && uses_walls())
    value *= bodies_passed(one_body(medium), s.distant ? 1.0 : length(direction), distance_);
  return value * light_passed();
}

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= wave_slots() * whitted.width) return;
  WhittedNode node = nodes_of_trees[index];
  if (node.hit_depth != wave.bounce) return; // the surface of an earlier depth has been lit
  uint slot = index % wave_slots();
  path_sampler = slot_sampler(slot);
  Surface surface = fetch_surface(node.hit);
  Vertex v = make_vertex(surface, fetch_material(surface.material), node.arrival);
  precise vec3 sum = vec3(0.0);
  uint first = wave.first_film_pixel, end = min(first + kLightsAtOnce, whitted.shadow_rays);
  for (uint i = first; i < end; ++i) sum += lit_by(i, v, node.hit_medium, node.hit_path);
  PathState path = fetch_path(index);
  precise vec3 radiance = path.radiance + node.hit_weight * sum;
  path.radiance = radiance;
  store_radiance(index, path);
  if (has(kFeatureAovs) && wave.bounce == 0u) path_aovs[slot].direct += node.hit_weight * sum;
  COUNT(counters.shadow_rays, shadow_ray_count)
}
