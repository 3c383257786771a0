// Looks reflections up in a map, as if what it shows were infinitely far away, or on the sides of a box (Lagarde and
// Zanuttini 2012). Push constant: first_pixel = the first one, row by row from the top left, pixel_count = how many.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_HYBRID
#define BIND_VISIBILITY
#define BIND_REFLECTIONS
#include "kernels/hybrid/bindings.glsl"
#include "kernels/hybrid/reflections/bindings.glsl"
#include "kernels/hybrid/reflections/map.glsl"
#include "kernels/hybrid/reflections/mirror.glsl"

layout(local_size_x = kWorkgroupSize) in;

// The direction from the map's centre to where the ray leaves the box.
vec3 to_side_of_box(Mirror mirror) {
  vec3 inverse = 1.0 / mix(mirror.direction, vec3(1e-20), equal(mirror.direction, vec3(0.0)));
  vec3 far_ = max((reflection.box_low - mirror.origin) * inverse, (reflection.box_high - mirror.origin) * inverse);
  float along = max(min(far_.x, min(far_.y, far_.z)), 0.0);
  return normalize(mirror.origin + along * mirror.direction - reflection.centre);
}

void main() {
  Mirror mirror;
  bool asked = false;
  uint pixel_index = wave.first_pixel + gl_GlobalInvocationID.x;
  if (gl_GlobalInvocationID.x < wave.pixel_count) {
    asked = find_mirror(uvec2(pixel_index % frame.width, pixel_index / frame.width), vec2(0.0), false, mirror);
    vec3 light = vec3(0.0);
    if (asked)
      light = mirror.weight *
              look_up_map(reflection.map_kind == kMapBox ? to_side_of_box(mirror) : mirror.direction);
    reflections[pixel_index] = vec4(light, 0.0);
  }
  count_reflections(kCountAsked, asked);
  count_reflections(kCountAnswered, asked);
}
