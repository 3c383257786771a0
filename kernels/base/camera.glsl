// The camera ray through a position in the picture. Include bindings.glsl first.
#ifndef WAVEPATH_CAMERA_GLSL
#define WAVEPATH_CAMERA_GLSL

#include "kernels/base/camera_model.glsl"
#include "kernels/base/config.glsl"
#include "kernels/base/dimensions.glsl"
#include "kernels/base/math.glsl"
#include "kernels/base/sampler.glsl"

bool is_orthographic() { return has(kFeatureOrthographic) && frame.orthographic != 0u; }

// `position` in pixels from the top left corner; `direction` of unit length.
void camera_ray(vec2 position, out vec3 origin, out vec3 direction) {
  float x = 2.0 * position.x / float(frame.width) - 1.0;
  float y = 1.0 - 2.0 * position.y / float(frame.height);
  vec3 across = x * frame.camera_right + y * frame.camera_up;
  origin = frame.camera_position;
  direction = frame.camera_forward + across;
  if (is_orthographic()) {
    origin = frame.camera_position + across;
    direction = frame.camera_forward;
  }
  direction = normalize(direction);
}

// ---- a thin lens ----------------------------------------------------------------------------------------------------
// Pharr, Jakob, Humphreys, "Physically Based Rendering", section 5.2.3: all rays of one position in the picture meet in
// one point of the plane of focus, wherever they pass the aperture; a pinhole is its middle.

// A point of the unit disc, or of the regular polygon in it with a corner at the top; uniform over the area.
vec2 sample_aperture(vec2 u) {
  if (kLens == kLensDisc) return warp_disk(u);
  float blade = floor(u.x * float(kLens)), fraction = u.x * float(kLens) - blade;
  vec2 first = cos_sin_turns(fract(0.25 + blade / float(kLens))),
       second = cos_sin_turns(fract(0.25 + (blade + 1.0) / float(kLens)));
  return sqrt(u.y) * mix(first, second, fraction);
}

// A position on the lens, relative to its middle, in metres.
vec3 sample_lens(vec2 u) {
  vec2 position = frame.lens_radius * sample_aperture(u);
  return position.x * normalize(frame.camera_right) + position.y * normalize(frame.camera_up);
}

// The camera ray through a position in the picture, of a sample of `pixel` that draws its own point on the lens where
// there is one. `t_max`: where it ends; 0 where the camera sees nothing.
void camera_ray(uvec2 pixel, vec2 position, Sampler path_sampler, out vec3 origin, out vec3 direction,
                out float t_max) {
  t_max = kFar;
  if (uses_camera_model()) {
    bool sees = model_ray(position, eye_of(pixel), origin, direction);
    if (!sees) {
      t_max = 0.0;
      return;
    }
  } else {
    camera_ray(position, origin, direction);
  }
  if (kLens != kLensPinhole) {
    vec3 lens = sample_lens(sample_2d(path_sampler, kDimensionLens));
    float along = dot(direction, frame.camera_forward); // of the ray through the middle
    direction = normalize(direction * (frame.focus_distance / along) - lens);
    origin += lens;
  }
  if (uses_camera_model()) {
    t_max = clipped_length(direction);
    origin = clipped_origin(origin, direction);
  }
}

// How far a camera ray goes.
float camera_reach(vec3 direction) { return uses_camera_model() ? clipped_length(direction) : kFar; }

// Depth of a point that a camera ray from `origin` has found.
float camera_depth(vec3 point, vec3 origin) {
  return uses_camera_model() ? model_depth(point, origin) : dot(point - origin, frame.camera_forward);
}

#endif
