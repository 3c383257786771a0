// Cameras that are more than a pinhole or parallel rays about the picture's middle (kFeatureCameraModel): lens shift,
// clip planes, stereo pairs, equidistant fisheyes, full spheres, and motion nearly as fast as light. Rays through
// positions in the picture, and back.
// Included by camera.glsl.
//
//     plane:    perspective and orthographic, with x + camera_shift.x and y + camera_shift.y for x and y (Frame)
//     fisheye:  the angle from camera_forward is the distance from the axis in the picture (equidistant)
//     sphere:   x is the angle about camera_up from camera_forward to the right, y the angle above the horizon
//
// In the last two camera_right and camera_up are half the picture's extent in radians.
//
// Eyes of a stereo pair stand eye_offset to both sides, and look in parallel directions. On a sphere they turn with the
// direction: rays touch a circle about the middle (omni-directional stereo). Each eye has half of the picture.
#ifndef WAVEPATH_CAMERA_MODEL_GLSL
#define WAVEPATH_CAMERA_MODEL_GLSL

#include "kernels/base/config.glsl"
#include "kernels/base/math.glsl"
#include "kernels/base/relativity.glsl"

bool uses_camera_model() { return has_lobe(kFeatureCameraModel) && frame.camera_model != kCameraPlain; }
bool is_panorama() { return frame.camera_model >= kCameraFisheye; }
// True if depths count from the eye, not along the view axis.
bool measures_from_eye() { return is_panorama() || MOVES_FAST; }

// ---- stereo ---------------------------------------------------------------------------------------------------------

// 0 = the left eye, or the only one.
uint eye_of(uvec2 pixel) {
  if (frame.eyes == kEyesBeside) return 2u * pixel.x >= frame.width ? 1u : 0u;
  if (frame.eyes == kEyesStacked) return 2u * pixel.y >= frame.height ? 1u : 0u;
  return 0u;
}

// Of the part of the picture that an eye has, in pixels.
uvec2 eye_size() {
  return uvec2(frame.eyes == kEyesBeside ? frame.width / 2u : frame.width,
               frame.eyes == kEyesStacked ? frame.height / 2u : frame.height);
}
uvec2 eye_corner(uint eye) {
  return uvec2(frame.eyes == kEyesBeside ? eye * ((frame.width + 1u) / 2u) : 0u,
               frame.eyes == kEyesStacked ? eye * ((frame.height + 1u) / 2u) : 0u);
}

// Metres to the right of the middle.
float eye_aside(uint eye) {
  return frame.eyes == kEyesOne ? 0.0 : eye == 0u ? -frame.eye_offset : frame.eye_offset;
}

// ---- from the picture to rays ---------------------------------------------------------------------------------------

// The row above the top one of a sphere is the top one again, so that the pixel filter stays in its column.
float mirrored(float y) { return y > 1.0 ? 2.0 - y : y < -1.0 ? -2.0 - y : y; }

// `position` in pixels. False where the camera sees nothing; `direction` is of unit length then, too.
bool ray_at_rest(vec2 position, uint eye, out vec3 origin, out vec3 direction) {
  vec2 at = 2.0 * (position - vec2(eye_corner(eye))) / vec2(eye_size());
  float x = at.x - 1.0 + frame.camera_shift.x, y = 1.0 - at.y + frame.camera_shift.y;
  vec3 right = normalize(frame.camera_right), up = normalize(frame.camera_up);
  origin = frame.camera_position + eye_aside(eye) * right;
  if (frame.camera_model == kCameraFisheye) {
    vec2 aside = vec2(x * length(frame.camera_right), y * length(frame.camera_up));
    float angle = length(aside);
    vec2 turn = cos_sin_turns(min(angle * (0.5 * kInvPi), 0.5));
    direction = normalize(turn.x * frame.camera_forward +
                          (angle > 0.0 ? turn.y / angle : 0.0) * (aside.x * right + aside.y * up));
    return angle <= frame.angle_limit;
  }
  if (frame.camera_model == kCameraSphere) {
    vec2 about = cos_sin_turns(0.5 * x), above = cos_sin_turns(0.25 * mirrored(y));
    origin = frame.camera_position + eye_aside(eye) * (about.x * right - about.y * frame.camera_forward);
    direction = normalize(above.x * (about.x * frame.camera_forward + about.y * right) + above.y * up);
    return true;
  }
  vec3 across = x * frame.camera_right + y * frame.camera_up;
  direction = frame.camera_forward + across;
  if (has(kFeatureOrthographic) && frame.orthographic != 0u) {
    origin += across;
    direction = frame.camera_forward;
  }
  direction = normalize(direction);
  return true;
}

// The same of a camera that may move.
bool model_ray(vec2 position, uint eye, out vec3 origin, out vec3 direction) {
  bool sees = ray_at_rest(position, eye, origin, direction);
  if (MOVES_FAST) direction = scene_direction(direction);
  return sees;
}

// Length of a ray between two depths that are one apart.
float depth_step(vec3 direction) { return measures_from_eye() ? 1.0 : 1.0 / dot(direction, frame.camera_forward); }

// How far a camera ray goes from the near plane on.
float clipped_length(vec3 direction) {
  return frame.clip_far < kFar ? (frame.clip_far - frame.clip_near) * depth_step(direction) : kFar;
}

// The beginning of a camera ray, moved to the near plane.
vec3 clipped_origin(vec3 origin, vec3 direction) {
  return origin + direction * (frame.clip_near * depth_step(direction));
}

// Depth of a point that is seen by a ray from `origin`: along the view axis or from the eye.
float model_depth(vec3 point, vec3 origin) {
  if (measures_from_eye()) return length(point - origin) + frame.clip_near;
  return dot(point - frame.camera_position, frame.camera_forward);
}

// The reverse, along a ray that begins at the near plane.
vec3 point_at_depth(float depth, vec3 origin, vec3 direction) {
  return origin + direction * ((depth - frame.clip_near) * depth_step(direction));
}

// ---- back to the picture --------------------------------------------------------------------------------------------

// Where a point appears in the picture of a panorama's eye, in pixels, and the beginning of the ray that shows it.
bool project_panorama(vec3 point, uint eye, out vec2 position, out vec3 origin) {
  vec3 right = normalize(frame.camera_right), up = normalize(frame.camera_up);
  float aside = eye_aside(eye);
  vec3 offset = point - frame.camera_position;
  vec2 at;
  origin = frame.camera_position;
  position = vec2(0.0);
  if (frame.camera_model == kCameraFisheye) {
    origin += aside * right;
    offset -= aside * right;
    vec2 across = vec2(dot(offset, right), dot(offset, up));
    float sine = length(across), angle = atan2_exact(sine, dot(offset, frame.camera_forward));
    if (!(angle <= frame.angle_limit)) return false;
    at = (sine > 0.0 ? angle / sine : 0.0) * across / vec2(length(frame.camera_right), length(frame.camera_up));
    at -= frame.camera_shift;
  } else {
    vec2 level = vec2(dot(offset, right), dot(offset, frame.camera_forward));
    float distance_ = length(level), reach = distance_ * distance_ - aside * aside;
    if (!(reach > 0.0)) return false; // within the circle that the rays touch
    reach = sqrt(reach);
    float azimuth = atan2_exact(level.x, level.y) - (aside != 0.0 ? atan2_exact(aside, reach) : 0.0);
    vec2 about = cos_sin_turns(azimuth * (0.5 * kInvPi));
    origin += aside * (about.x * right - about.y * frame.camera_forward);
    at = vec2(azimuth * kInvPi, atan2_exact(dot(offset, up), reach) * (2.0 * kInvPi));
    if (at.x < -1.0) at.x += 2.0;
    if (at.x > 1.0) at.x -= 2.0;
  }
  position = vec2(eye_corner(eye)) + 0.5 * vec2(eye_size()) * vec2(1.0 + at.x, 1.0 - at.y);
  return true;
}

// Whether the clip planes leave a point that is seen from `origin`.
bool is_within_clip(vec3 point, vec3 origin) {
  float depth = measures_from_eye() ? length(point - origin) : dot(point - frame.camera_position, frame.camera_forward);
  return depth > frame.clip_near && depth < frame.clip_far;
}

// `offset` from the beginning of the ray becomes that from the eye.
vec3 unclipped(vec3 offset) {
  float depth = measures_from_eye() ? length(offset) : dot(offset, frame.camera_forward);
  return offset * (1.0 + frame.clip_near / depth);
}

// Solid angle that a panorama gives to a unit of its picture's area, in the direction of `offset`: in radians squared.
// Not zero at a pole either, so that densities are finite.
float panorama_stretch(vec3 offset) {
  const float kLeast = 1e-9;
  vec3 right = normalize(frame.camera_right), up = normalize(frame.camera_up);
  float across = dot(offset, right), above = dot(offset, up), ahead = dot(offset, frame.camera_forward);
  if (frame.camera_model == kCameraSphere) // the cosine of the angle above the horizon
    return max(length(vec2(across, ahead)) / length(offset), kLeast);
  float sine = length(vec2(across, above)), angle = atan2_exact(sine, ahead);
  return angle > 0.0 ? max(sine / (length(offset) * angle), kLeast) : 1.0;
}

#endif
