// The layer that was found for a pixel, for kernels that go over the frame: push constant: first_pixel = the first one,
// row by row from the top left, pixel_count = how many, bounce = the pass, sample_count = how many passes there are.
#ifndef WAVEPATH_FOUND_LAYER_GLSL
#define WAVEPATH_FOUND_LAYER_GLSL

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_LIGHTS
#define BIND_ENVIRONMENT
#define BIND_HYBRID
#define BIND_LAYERS
#include "kernels/hybrid/bindings.glsl"
#include "kernels/bvh/known_triangle.glsl"
#include "kernels/hybrid/transparency/layer_light.glsl"
#include "kernels/hybrid/transparency/transparency_types.h"

layout(set = 0, binding = kBindLayerTriangles) uniform usamplerBuffer layer_triangles;
layout(set = 0, binding = kBindLayerSeen) uniform usamplerBuffer layer_seen;

layout(local_size_x = kWorkgroupSize) in;

// Light of the layer by layer_light(); false if there is none.
bool found_layer(uint pixel_index, out vec4 light) {
  uint layer = texelFetch(layer_seen, int(pixel_index)).x;
  if (layer == kNone) return false;
  uvec2 placed = texelFetch(layer_triangles, int(layer)).xy,
        pixel = uvec2(pixel_index % frame.width, pixel_index / frame.width);
  vec3 origin, direction;
  hybrid_camera_ray(pixel, origin, direction);
  light = layer_light(hit_of_triangle(placed.x, placed.y, origin, direction), pixel, origin, direction);
  return true;
}

#endif
