// Evaluates kernels/light/light_sampling.glsl on the buffers that the renderer binds: one function by mode
// (wave.bounce).
#version 460
#extension GL_GOOGLE_include_directive : require
#define BIND_LIGHTS
#define BIND_ENVIRONMENT
#include "kernels/base/bindings.glsl"
#include "kernels/film/film_types.h"
#include "kernels/light/light_sampling.glsl"

layout(local_size_x = kWorkgroupSize) in;
struct Element {
  vec4 a, b;
};
layout(set = 0, binding = kBindFilm, std430) buffer Elements { Element elements[]; };

uvec2 bits(vec2 u) { return uvec2(u * 4294967296.0); }

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= wave.pixel_count) return;
  Element e = elements[i];
  uint width = frame.environment_width, height = frame.environment_height;
  if (wave.bounce == 0u) { // world direction a -> b: uv, and whether the way back ends where it began
    vec3 d = environment_from_world(e.a.xyz, frame.environment_rotation);
    e.b.xy = environment_uv(d);
    e.b.z = distance(world_from_environment(environment_direction(e.b.xy), frame.environment_rotation), e.a.xyz);
    environment_map_radiance(environment_point(d), e.b.w);
  } else if (wave.bounce == 1u) { // u in a.xy -> a: direction, density; b: texel, that of the direction
    EnvironmentPoint at;
    e.a.xyz = sample_environment_map(bits(e.a.xy), at);
    environment_map_radiance(at, e.a.w);
    e.b.xy = vec2(at.texel);
    e.b.zw = vec2(environment_point(environment_from_world(e.a.xyz, frame.environment_rotation)).texel);
  } else if (wave.bounce == 2u) { // u in a.xy -> b: light, what is left of u.x
    uvec2 u = bits(e.a.xy);
    e.b.x = float(pick_light(u));
    e.b.y = unit_float(u.x);
  } else if (wave.bounce == 3u) { // texel a.xy of a map of the size in `frame`, u in a.zw -> b: direction, solid angle
    vec2 position;
    e.b.xyz = environment_texel_direction(uint(e.a.x), uint(e.a.y), width, height, e.a.zw, position);
    e.b.w = environment_texel_solid_angle(uint(e.a.y), width, height);
  } else if (wave.bounce == 4u) { // light a.w seen from a.xyz -> a: irradiance; b: towards it
    vec3 to_light;
    e.a.xyz = punctual_irradiance(fetch_light(uint(e.a.w)), e.a.xyz, to_light);
    e.b.xyz = to_light;
  } else if (wave.bounce == 5u) { // pdf_area a.w, offset a.xyz, normal b.xyz -> b.w
    e.b.w = solid_angle_pdf(e.a.w, e.a.xyz, e.b.xyz);
  } else if (wave.bounce == 6u) { // offset and width in the bits of a.xy -> bits of b.x
    e.b.x = uintBitsToFloat(stretch(floatBitsToUint(e.a.x), floatBitsToUint(e.a.y)));
  } else if (wave.bounce == 8u) { // bits of u in a.xy -> a: radiance, density; b: texel, radiance by the direction
                                  // alone, its sine
    EnvironmentPoint at;
    vec3 d = environment_from_world(sample_environment_map(floatBitsToUint(e.a.xy), at), frame.environment_rotation);
    e.a.x = environment_map_radiance(at, e.a.y).x;
    float pdf;
    e.b = vec4(at.texel, environment_map_radiance(environment_point(d), pdf).x, length(d.xz));
  } else { // bits of a: depth, first cell, cells, none; weights in the part b.xy -> weights in the triangle b.xy, bits
           // of b.z: its cell
    uvec4 part = floatBitsToUint(e.a);
    e.b.xy = weights_in_part(part.x, part.y, part.z, e.b.xy);
    e.b.z = uintBitsToFloat(cell_at(part.x, e.b.xy));
  }
  elements[i] = e;
}
