// Functions of occlusion techniques in screen space: the pixel of an invocation, the G-buffer at a position in the
// picture, and the image of a direction in space. They know only surfaces that are seen.
#ifndef WAVEPATH_SCREEN_GLSL
#define WAVEPATH_SCREEN_GLSL

#define BIND_HYBRID
#define BIND_GBUFFER
#define BIND_SIGNALS
#include "kernels/hybrid/bindings.glsl"
#include "kernels/base/camera.glsl"
#include "kernels/base/dimensions.glsl"
#include "kernels/hybrid/frame_terms.glsl"
#include "kernels/base/math.glsl"
#include "kernels/base/pixel.glsl"

layout(local_size_x = kWorkgroupSize) in;

// Positions on the way from a pixel to the edge of what may occlude it, in each direction.
const uint kSteps = 16u;

// Where a pixel's point lies, and how it is seen. All in the coordinates of rays.
struct Receiver {
  uint index;    // row-major from the top left
  vec2 centre;   // in pixels
  float depth;   // along the view axis
  vec3 position;
  vec3 normal;
  vec3 to_eye;   // of unit length
};

vec2 picture_size() { return vec2(frame.width, frame.height); }

vec3 point_at(vec2 position, float depth) {
  vec3 origin, direction;
  camera_ray(position + hybrid.jitter, origin, direction);
  return origin + direction * (depth / dot(direction, frame.camera_forward));
}

// The point of the invocation's pixel. False where there is none, or nothing to occlude.
bool find_receiver(out Receiver receiver) {
  uint local = gl_GlobalInvocationID.x;
  if (local >= wave.pixel_count) return false;
  uvec2 pixel = slot_pixel(local);
  receiver.index = pixel.y * frame.width + pixel.x;
  receiver.depth = gbuffer[receiver.index].depth;
  if (receiver.depth <= 0.0) {
    signals[receiver.index].w = 0.0;
    return false;
  }
  receiver.centre = vec2(pixel) + 0.5;
  vec3 origin, direction;
  camera_ray(receiver.centre + hybrid.jitter, origin, direction);
  receiver.position = origin + direction * (receiver.depth / dot(direction, frame.camera_forward));
  receiver.normal = gbuffer[receiver.index].normal;
  receiver.to_eye = -direction;
  return true;
}

Sampler occlusion_sampler(uint index, uint i) {
  return make_sampler(frame.seed, index, hybrid_sample(hybrid.ao_samples, i), frame_total() * hybrid.ao_samples);
}

// The position in the picture that shows a point, in pixels, and its depth. The inverse of point_at().
vec3 shown_at(vec3 position) {
  vec3 q = position - frame.camera_position;
  float depth = dot(q, frame.camera_forward);
  vec2 xy = vec2(dot(q, frame.camera_right) / dot(frame.camera_right, frame.camera_right),
                 dot(q, frame.camera_up) / dot(frame.camera_up, frame.camera_up));
  if (!is_orthographic()) xy /= max(depth, 1e-30);
  return vec3((xy * vec2(1.0, -1.0) + 1.0) * 0.5 * picture_size() - hybrid.jitter, depth);
}

// Pixels that a point at the receiver passes for every metre that it moves along `direction`.
vec2 pixels_per_metre(Receiver receiver, vec3 direction) {
  vec2 rate = vec2(dot(direction, frame.camera_right) / dot(frame.camera_right, frame.camera_right),
                   dot(direction, frame.camera_up) / dot(frame.camera_up, frame.camera_up));
  if (!is_orthographic()) {
    vec2 xy = (2.0 * (receiver.centre + hybrid.jitter) / picture_size() - 1.0) * vec2(1.0, -1.0);
    rate = (rate - xy * dot(direction, frame.camera_forward)) / receiver.depth;
  }
  return rate * vec2(1.0, -1.0) * 0.5 * picture_size();
}

float depth_of(ivec2 pixel) {
  bool inside = all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, ivec2(picture_size())));
  return inside ? gbuffer[uint(pixel.y) * frame.width + uint(pixel.x)].depth : 0.0;
}

// The surface seen at `position`, relative to the receiver; false where nothing is seen. Between four pixels whose
// depths make up one surface it is interpolated, in 1 / depth, in which a plane is linear, so that planes stay planes;
// elsewhere it is the pixel's own point. One surface: depths within 16 widths of a pixel, which is a slope of 86
// degrees.
bool surface_at(Receiver receiver, vec2 position, out vec3 offset) {
  ivec2 corner = clamp(ivec2(floor(position - 0.5)), ivec2(0), max(ivec2(picture_size()) - 2, 0));
  vec4 depths = vec4(depth_of(corner), depth_of(corner + ivec2(1, 0)), depth_of(corner + ivec2(0, 1)),
                     depth_of(corner + ivec2(1, 1)));
  float nearest = min(min(depths.x, depths.y), min(depths.z, depths.w));
  float farthest = max(max(depths.x, depths.y), max(depths.z, depths.w));
  float width = 2.0 * length(frame.camera_right) / float(frame.width) * (is_orthographic() ? 1.0 : nearest);
  float depth;
  if (nearest > 0.0 && farthest - nearest <= 16.0 * width) {
    vec2 part = position - 0.5 - vec2(corner);
    if (!is_orthographic()) depths = 1.0 / depths;
    depth = mix(mix(depths.x, depths.y, part.x), mix(depths.z, depths.w, part.x), part.y);
    if (!is_orthographic()) depth = 1.0 / depth;
  } else {
    depth = depth_of(ivec2(floor(position)));
    position = floor(position) + 0.5;
  }
  offset = point_at(position, depth) - receiver.position;
  return depth > 0.0;
}

// A way across the picture from the receiver, towards a direction at right angles to its view.
struct March {
  vec2 direction; // of unit length, in pixels
  float length_;  // until the radius or the outermost pixels' centres
  uint steps;
};

March march_of(Receiver receiver, vec3 direction) {
  vec2 rate = pixels_per_metre(receiver, direction);
  float speed = max(length(rate), 1e-30);
  March march;
  march.direction = rate / speed;
  vec2 edge = mix(receiver.centre, picture_size() - receiver.centre, greaterThan(march.direction, vec2(0.0))) - 0.5;
  vec2 to_edge = edge / max(abs(march.direction), vec2(1e-6));
  march.length_ = min(min(to_edge.x, to_edge.y), hybrid.ao_radius * speed);
  march.steps = march.length_ < 1.0 ? 0u : min(kSteps, uint(ceil(march.length_)));
  return march;
}

// Position of a step, at random within its stretch. Stretches grow with their distance, from one pixel on.
vec2 step_position(March march, Receiver receiver, uint step, float u) {
  float fraction = (float(step) + u) / float(march.steps);
  return receiver.centre + march.direction * (1.0 + (march.length_ - 1.0) * fraction * fraction);
}

#endif
