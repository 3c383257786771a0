// Evaluates kernels/base/camera_model.glsl and its inverse: positions in the picture become rays, points on these
// become positions again, and each goes to a pixel whose filter holds it.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernels/base/config.glsl"
#include "kernels/base/frame_types.h"

layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Push { uint invocations; };
layout(set = 0, binding = 0, std430) readonly buffer FrameBlock { Frame frame; };
#include "kernels/bidirectional/projection.glsl"

struct Seen {
  vec2 position; // in pixels
  uint eye;
  uint sees;
  vec3 origin;
  float length_; // of a clipped ray
  vec3 direction;
  float stretch; // of a panorama
  vec2 again;    // where the picture shows a point of the ray; below 0 where nothing does
  uint pixel;    // that was picked for it by `u`, counted from the top left, row by row
  float weight;  // filter over the probability of that
  vec2 u;
  vec2 pad;
};
layout(set = 0, binding = 1, std430) buffer SeenBlock { Seen all[]; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= invocations) return;
  Seen s = all[i];
  vec3 origin, direction;
  s.sees = model_ray(s.position, s.eye, origin, direction) ? 1u : 0u;
  vec3 seen = MOVES_FAST ? seen_direction(direction) : direction;
  s.stretch = is_panorama() ? panorama_stretch(3.0 * seen) : 0.0;
  s.again = vec2(-1.0);
  s.origin = clipped_origin(origin, direction);
  vec3 found, towards;
  if (s.sees != 0u && !project(s.origin + 0.4 * direction, vec3(0.0), s.eye, s.again, found, towards))
    s.again = vec2(-2.0);
  uvec2 pixel = uvec2(0u);
  s.weight = s.again.x >= 0.0 ? pick_pixel(s.again, s.eye, s.u, pixel) : 0.0;
  s.pixel = pixel.y * frame.width + pixel.x;
  if (s.again.x >= 0.0 && length(found - s.origin) + length(towards - direction) > 1e-4) s.again = vec2(-3.0);
  s.direction = direction;
  s.length_ = clipped_length(direction);
  all[i] = s;
}
