// Which pixel shows a point, and by which ray: the inverse of camera_ray() and of the pixel filter. Include
// bindings.glsl first.
#ifndef WAVEPATH_PROJECTION_GLSL
#define WAVEPATH_PROJECTION_GLSL

#include "kernels/base/camera.glsl"
#include "kernels/base/filter.glsl"

// Where a point appears in the picture of an eye, in pixels from the top left corner, and the ray that shows it:
// `to_point` of unit length. `lens`: the point of the aperture that the ray passes, from its middle. False if it is
// behind the camera.
bool project_at_rest(vec3 point, vec3 lens, uint eye, out vec2 position, out vec3 origin, out vec3 to_point) {
  if (uses_camera_model() && is_panorama()) {
    bool sees = project_panorama(point, eye, position, origin);
    to_point = safe_normalize(point - origin, frame.camera_forward);
    if (!sees || !is_within_clip(point, origin)) return false;
    origin = clipped_origin(origin, to_point);
    return true;
  }
  vec3 middle = frame.camera_position;
  if (uses_camera_model()) middle += eye_aside(eye) * normalize(frame.camera_right);
  vec3 offset = point - middle;
  float depth = dot(offset, frame.camera_forward);
  if (kLens != kLensPinhole) { // the middle of the lens sees in the same position where the ray meets the plane of
                               // focus
    if (is_orthographic())
      offset -= lens * (1.0 - depth / frame.focus_distance);
    else
      offset = lens + (offset - lens) * (frame.focus_distance / depth);
  }
  vec2 across = vec2(dot(offset, frame.camera_right) / dot(frame.camera_right, frame.camera_right),
                     dot(offset, frame.camera_up) / dot(frame.camera_up, frame.camera_up));
  origin = middle;
  to_point = normalize(offset);
  if (is_orthographic()) {
    origin = point - depth * frame.camera_forward;
    to_point = frame.camera_forward;
  } else {
    across /= dot(offset, frame.camera_forward);
  }
  if (kLens != kLensPinhole) {
    origin = middle + lens;
    if (is_orthographic()) origin += across.x * frame.camera_right + across.y * frame.camera_up;
    to_point = normalize(point - origin);
  }
  if (uses_camera_model()) {
    across -= frame.camera_shift;
    position = vec2(eye_corner(eye)) + 0.5 * vec2(eye_size()) * vec2(1.0 + across.x, 1.0 - across.y);
    if (!is_within_clip(point, origin)) return false;
    origin = clipped_origin(origin, to_point);
    return depth > 0.0;
  }
  position = 0.5 * vec2(float(frame.width) * (1.0 + across.x), float(frame.height) * (1.0 - across.y));
  return depth > 0.0;
}

// The same of a camera that may move: it sees the point elsewhere, by a ray that comes from where it is.
bool project(vec3 point, vec3 lens, uint eye, out vec2 position, out vec3 origin, out vec3 to_point) {
  if (!MOVES_FAST) return project_at_rest(point, lens, eye, position, origin, to_point);
  vec3 offset = point - frame.camera_position, towards = safe_normalize(offset, frame.camera_forward);
  vec3 seen = frame.camera_position + length(offset) * seen_direction(towards);
  bool sees = project_at_rest(seen, lens, eye, position, origin, to_point);
  to_point = towards;
  origin = clipped_origin(frame.camera_position, to_point);
  return sees;
}

// Density of the filter along one axis for the pixels before, at and after `cell`; none beyond the borders, unless
// there are none.
vec3 axis_weights(float position, float cell, uint size, bool endless) {
  vec3 weights = vec3(0.0);
  for (int i = 0; i < 3; ++i) {
    float at = cell + float(i - 1);
    if (endless || (at >= 0.0 && at < float(size))) weights[i] = filter_density(position - (at + 0.5));
  }
  return weights;
}

// Picks one of three in proportion to their weights.
int pick_weighted(vec3 weights, float total, float u) {
  float rest = u * total;
  return rest < weights.x ? 0 : rest < weights.x + weights.y || weights.z <= 0.0 ? 1 : 2;
}

// One of the pixels whose filter reaches the position, and its filter over the probability of being picked; 0 for none.
float pick_pixel(vec2 position, uint eye, vec2 u, out uvec2 pixel) {
  uvec2 corner = uvec2(0u), size = uvec2(frame.width, frame.height);
  bool is_sphere = false;
  if (uses_camera_model()) {
    corner = eye_corner(eye);
    size = eye_size();
    is_sphere = frame.camera_model == kCameraSphere;
    position -= vec2(corner);
  }
  vec2 cell = floor(position);
  vec3 x = axis_weights(position.x, cell.x, size.x, is_sphere), y = axis_weights(position.y, cell.y, size.y, is_sphere);
  float total_x = x.x + x.y + x.z, total_y = y.x + y.y + y.z;
  pixel = uvec2(0u);
  if (!(total_x * total_y > 0.0)) return 0.0;
  vec2 at = cell + vec2(pick_weighted(x, total_x, u.x), pick_weighted(y, total_y, u.y)) - 1.0;
  if (is_sphere) at.x -= float(size.x) * floor(at.x / float(size.x)); // past the right border comes the left one
  pixel = corner + uvec2(clamp(at, vec2(0.0), vec2(float(size.x - 1u), float(size.y - 1u))));
  return total_x * total_y;
}

#endif
