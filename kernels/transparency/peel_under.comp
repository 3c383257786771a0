// Puts the layer that was peeled last under those before it.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_LIGHTS
#define BIND_ENVIRONMENT
#define BIND_HYBRID
#define BIND_LAYERS
#include "kernels/hybrid/bindings.glsl"
#include "kernels/known_triangle.glsl"
#include "kernels/transparency/layer_light.glsl"
#include "kernels/transparency/transparency_types.h"

layout(set = 0, binding = kBindLayerTriangles) uniform usamplerBuffer layer_triangles;
layout(set = 0, binding = kBindLayerSeen) uniform usamplerBuffer layer_seen;

layout(local_size_x = kWorkgroupSize) in;

// Push constant: first_pixel = the first one, row by row from the top left, pixel_count = how many, bounce = the layer.
void main() {
  if (gl_GlobalInvocationID.x >= wave.pixel_count) return;
  uint place = wave.first_pixel + gl_GlobalInvocationID.x;
  vec4 above = wave.bounce == 0u ? vec4(0.0, 0.0, 0.0, 1.0) : layers[place];
  uint layer = texelFetch(layer_seen, int(place)).x;
  if (layer != kNone) {
    uvec2 placed = texelFetch(layer_triangles, int(layer)).xy, pixel = uvec2(place % frame.width, place / frame.width);
    vec3 origin, direction;
    hybrid_camera_ray(pixel, origin, direction);
    vec4 light = layer_light(hit_of_triangle(placed.x, placed.y, origin, direction), pixel, origin, direction);
    above = vec4(above.rgb + above.a * light.a * light.rgb, above.a * (1.0 - light.a));
  }
  layers[place] = above;
}
