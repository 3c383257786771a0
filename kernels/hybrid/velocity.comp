// The velocity of what a hybrid frame shows, for motion blur: how far a surface moves in the picture from the opening
// of the shutter to its close.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_HYBRID
#define BIND_VISIBILITY
#define BIND_VELOCITIES
#include "kernels/hybrid/bindings.glsl"
#include "kernels/base/camera.glsl"
#include "kernels/hybrid/hybrid.glsl"
#include "kernels/bvh/known_triangle.glsl"
#include "kernels/surface/surface.glsl"

layout(local_size_x = kWorkgroupSize) in;

// Fraction of a point's depth: an end of its way that is nearer, or behind the eye, is shown as if it were so deep.
const float kNearest = 0.01;

// Position in pixels from the middle of the picture, of what lies at `offset` from the eye.
vec2 shown_at(vec3 offset, float least_depth) {
  vec2 position = vec2(dot(offset, frame.camera_right) / dot(frame.camera_right, frame.camera_right),
                       -dot(offset, frame.camera_up) / dot(frame.camera_up, frame.camera_up));
  if (!is_orthographic()) position /= max(dot(offset, frame.camera_forward), least_depth);
  return 0.5 * vec2(frame.width, frame.height) * position;
}

// World displacement of the point of a hit while the shutter is open.
vec3 displacement_of(Hit hit) {
  int texel = int(frame.motion_texel + hit.triangle * kTriangleTexels);
  vec3 displacement = interpolated(texelFetch(triangles, texel).xyz, texelFetch(triangles, texel + 1).xyz,
                                   texelFetch(triangles, texel + 2).xyz, vec3(0.0, hit.b1, hit.b2));
  return is_instanced() ? transform_vector(hit.instance * kInstanceTexels + 3u, displacement) : displacement;
}

// Push constant: first_pixel = the first one, row by row from the top left, pixel_count = how many.
void main() {
  if (gl_GlobalInvocationID.x >= wave.pixel_count) return;
  uint pixel_index = wave.first_pixel + gl_GlobalInvocationID.x;
  uvec2 visible = texelFetch(visibility, int(pixel_index)).xy;
  vec2 velocity = vec2(0.0);
  if (visible.x != kNone) {
    vec3 origin, direction;
    hybrid_camera_ray(uvec2(pixel_index % frame.width, pixel_index / frame.width), origin, direction);
    Hit hit = hit_of_triangle(visible.x, visible.y, origin, direction);
    vec3 offset = fetch_surface(hit).position - frame.camera_position, half_way = 0.5 * displacement_of(hit);
    float least_depth = kNearest * dot(offset, frame.camera_forward);
    velocity = shown_at(offset + half_way, least_depth) - shown_at(offset - half_way, least_depth);
  }
  velocities[pixel_index] = velocity;
}
