// Points that the camera rays of a hybrid frame find, for kernels that reduce a frame to the data that its shadow maps
// need.
#ifndef WAVEPATH_VISIBLE_POINT_GLSL
#define WAVEPATH_VISIBLE_POINT_GLSL

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_HYBRID
#define BIND_VISIBILITY
#include "kernels/hybrid/bindings.glsl"
#include "kernels/hybrid/hybrid.glsl"
#include "kernels/bvh/known_triangle.glsl"
#include "kernels/hybrid/shadows/bindings.glsl"
#include "kernels/surface/surface.glsl"

layout(set = 0, binding = kBindShadowScratch, std430) buffer FrameWordBlock { uint frame_words[]; };

// Of the invocation's pixel: push constant first_pixel = the first one, row by row from the top left, pixel_count = how
// many. The same bits as `resolve` finds. False where nothing is seen.
bool visible_point(out vec3 position, out float depth) {
  if (gl_GlobalInvocationID.x >= wave.pixel_count) return false;
  uint pixel_index = wave.first_pixel + gl_GlobalInvocationID.x;
  uvec2 visible = texelFetch(visibility, int(pixel_index)).xy;
  if (visible.x == kNone) return false;
  vec3 origin, direction;
  hybrid_camera_ray(uvec2(pixel_index % frame.width, pixel_index / frame.width), origin, direction);
  position = fetch_surface(hit_of_triangle(visible.x, visible.y, origin, direction)).position;
  depth = dot(position - origin, frame.camera_forward);
  return true;
}

// Keeps the order of floats. Inverse of float_of() in host/integrators/hybrid/shadows/sdsm.cpp.
uint ordered_bits(float x) {
  uint bits = floatBitsToUint(x);
  return (bits & 0x80000000u) != 0u ? ~bits : bits | 0x80000000u;
}

// Takes a number into a least and a largest one. Integers, so that the order does not matter; words only ever move one
// way, so that a look at them before saves nearly all atomics.
void take_in(uint word, float x) {
  uint bits = ordered_bits(x);
  if (bits < frame_words[word]) atomicMin(frame_words[word], bits);
  if (bits > frame_words[word + 1u]) atomicMax(frame_words[word + 1u], bits);
}

#endif
