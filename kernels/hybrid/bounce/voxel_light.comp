// Light that leaves each surface voxel (Crassin, Neyret, Sainz, Green and Eisemann 2011, section 6; by rays where they
// have a map): direct light at the point of the voxel's triangle that is nearest to its middle, reflected by a matt
// surface. Random numbers are those of the voxel.
// Push constant: first_pixel = first voxel, pixel_count = how many.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_LIGHTS
#define BIND_ENVIRONMENT
#include "kernels/base/bindings.glsl"
#include "kernels/base/dimensions.glsl"
#include "kernels/base/records.glsl"
#include "kernels/base/sampler.glsl"
#include "kernels/bvh/instance.glsl"
#include "kernels/light/emission.glsl"
#include "kernels/light/shadow.glsl"
#include "kernels/surface/vertex.glsl"
#include "kernels/hybrid/voxels/cone.glsl"
#include "kernels/hybrid/bounce/voxel_light.glsl"

#define ALPHA_TEST(hit) lets_light_through(hit)
#define ANY_HIT
#include "kernels/bvh/trace.glsl"

layout(local_size_x = kWorkgroupSize) in;
layout(set = 0, binding = kBindVoxelPlaces) uniform usamplerBuffer voxel_places;

const uint kVoxelSeed = 0x3c6ef372u;

vec3 placed_corner(uvec2 place, uint corner) {
  vec3 p = texelFetch(triangles, int(place.x * kTriangleTexels + corner)).xyz;
  return has(kFeatureInstances) && frame.root_is_top != 0u ? transform_point(place.y * kInstanceTexels + 3u, p) : p;
}

// Weights of b and c at the point of the segment or triangle that is nearest to the origin (Ericson 2005, section
// 5.1.5).
vec2 nearest_weights(vec3 a, vec3 b, vec3 c) {
  vec3 ab = b - a, ac = c - a;
  float d1 = -dot(ab, a), d2 = -dot(ac, a), d3 = -dot(ab, b), d4 = -dot(ac, b), d5 = -dot(ab, c), d6 = -dot(ac, c);
  if (d1 <= 0.0 && d2 <= 0.0) return vec2(0.0);
  if (d3 >= 0.0 && d4 <= d3) return vec2(1.0, 0.0);
  if (d6 >= 0.0 && d5 <= d6) return vec2(0.0, 1.0);
  float va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return vec2(d1 / max(d1 - d3, 1e-30), 0.0);
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return vec2(0.0, d2 / max(d2 - d6, 1e-30));
  if (va <= 0.0 && d4 >= d3 && d5 >= d6) {
    float w = (d4 - d3) / max(d4 - d3 + d5 - d6, 1e-30);
    return vec2(1.0 - w, w);
  }
  return vec2(vb, vc) / max(va + vb + vc, 1e-30);
}

// Irradiance by one light sample, and whether it falls on the side of the geometric normal.
vec3 irradiance_of(Surface surface, Sampler s, out bool front) {
  LightSample light = sample_light(surface.position, sample_bits(s, bounce_dimension(0u) + kDimensionLight));
  float cosine = dot(surface.geometric_normal, light.direction);
  front = cosine > 0.0;
  if (cosine == 0.0 || !(light.pdf > 0.0) || !(max_component(light.radiance) > 0.0)) return vec3(0.0);
  Light lamp = fetch_light(light.light);
  bool shines = has(kFeatureTriangleLights) && lamp.kind == kLightTriangle;
  lift_surface(surface, front);
  vec3 origin = offset_ray_origin(surface.position, surface.position_error, surface.geometric_normal, light.direction);
  vec3 direction = light.distant ? light.direction : light.target - origin;
  begin_shadow();
  if (trace(origin, direction, light.distant ? kFar : 1.0, shines ? lamp.triangle_id : kNone,
            shines ? lamp.instance : 0u).triangle != kNone)
    return vec3(0.0);
  return light.radiance * (abs(cosine) / light.pdf) * light_passed();
}

void main() {
  if (gl_GlobalInvocationID.x >= wave.pixel_count) return;
  uint index = wave.first_pixel + gl_GlobalInvocationID.x;
  uint claim = voxel_normals[index]; // of voxel_owner.comp
  if (claim == 0u) return;
  SurfaceGrid grid = fetch_surface_grid();
  uvec3 size = uvec3(fetch_surface_level(0u).size);
  vec3 voxel = vec3(index % size.x, index / size.x % size.y, index / (size.x * size.y));
  vec3 middle = grid.lo + grid.voxel * (voxel + 0.5);
  uvec2 place = texelFetch(voxel_places, int(~claim)).xy;
  vec2 weights = nearest_weights(placed_corner(place, 0u) - middle, placed_corner(place, 1u) - middle,
                                 placed_corner(place, 2u) - middle);
  Surface surface = fetch_surface(Hit(place.x, place.y, weights.x, weights.y));
  Material material = fetch_material(surface.material);
  vec3 sides[2] = vec3[2](vec3(0.0), vec3(0.0));
  if (frame.light_count > 0u && (material.flags & kMaterialUnlit) == 0u) {
    for (uint i = 0u; i < kVoxelLightSamples; ++i) {
      bool front;
      vec3 irradiance = irradiance_of(surface, make_sampler(kVoxelSeed, index, i, kVoxelLightSamples), front);
      sides[front ? 0 : 1] += irradiance;
    }
    Bsdf b = make_bsdf(material, surface.uv, base_color(material, surface.uv, surface.color).rgb, true);
    vec3 reflected = b.base_color * ((1.0 - b.metallic) * (1.0 - b.transmission) / (kPi * float(kVoxelLightSamples)));
    sides[0] *= reflected;
    sides[1] *= reflected;
  }
  voxel_normals[index] = packSnorm4x8(vec4(surface.geometric_normal, 0.0));
  voxel_fronts[index] = pack_light(sides[0]);
  voxel_backs[index] = pack_light(sides[1]);
}
