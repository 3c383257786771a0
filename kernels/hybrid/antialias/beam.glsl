// The beam of a pixel: triangles as it sees them, convex polygons in the pixel, and their areas.
//
// A camera ray through (x, y), in pixels from the pixel's middle, y downwards, meets a triangle if the weights of its
// corners there are positive. Each weight is dot(line, (x, y, 1)), where the line is the plane through the eye and an
// edge (Heckbert and Hanrahan 1984), so that corners behind the eye need no care. Include bindings.glsl with
// BIND_GEOMETRY and BIND_HYBRID first.
#ifndef WAVEPATH_BEAM_GLSL
#define WAVEPATH_BEAM_GLSL

#include "kernels/base/math.glsl"
#include "kernels/hybrid/antialias/beam_types.h"
#include "kernels/hybrid/frame_corner.glsl"

const float kDiscRadius = 0.564189584;  // of the disc of area 1
const float kSmallestArea = 1e-9;       // of a pixel; smaller pieces are dropped
const uint kMostCorners = 12u;

float beam_half() { return wave.bounce == kBeamDisc ? kDiscRadius : 0.5; }

struct Polygon { // convex
  vec2 corners[kMostCorners];
  uint count;
};

struct BeamTriangle {
  vec3 lines[3]; // weights of the corners
  vec3 depths;   // of the corners, along the view axis
  float orientation; // > 0: seen clockwise, < 0: counter-clockwise, 0: edge-on
};

// a b - c d, with the error of one rounding (Dekker 1971: the low parts of products, from halves of the factors).
float low_of_product(float a, float b, float product) {
  precise float scaled_a = 4097.0 * a, scaled_b = 4097.0 * b;
  precise float high_a = scaled_a - (scaled_a - a), high_b = scaled_b - (scaled_b - b);
  precise float low_a = a - high_a, low_b = b - high_b;
  precise float low = ((high_a * high_b - product) + high_a * low_b + low_a * high_b) + low_a * low_b;
  return low;
}
float difference_of_products(float a, float b, float c, float d) {
  precise float ab = a * b, cd = c * d;
  precise float difference = (ab - cd) + (low_of_product(a, b, ab) - low_of_product(c, d, cd));
  return difference;
}
// Neighbours see a shared edge with swapped ends, hence exactly negated: no gap is between them.
vec3 exact_cross(vec3 a, vec3 b) {
  return vec3(difference_of_products(a.y, b.z, a.z, b.y), difference_of_products(a.z, b.x, a.x, b.z),
              difference_of_products(a.x, b.y, a.y, b.x));
}

// A point in pixels from the pixel's middle, times its depth, and the depth; orthographic: times 1, and 1. `depth`:
// along the view axis, in any case.
vec3 beam_point(uvec2 pixel, vec3 point, out float depth) {
  vec3 offset = point - frame.camera_position;
  depth = dot(offset, frame.camera_forward);
  float w = is_orthographic() ? 1.0 : depth;
  vec2 size = 0.5 * vec2(frame.width, frame.height);
  vec2 scaled = vec2(dot(offset, frame.camera_right) / dot(frame.camera_right, frame.camera_right) * size.x,
                     -dot(offset, frame.camera_up) / dot(frame.camera_up, frame.camera_up) * size.y);
  return vec3(scaled - (vec2(pixel) + 0.5 - size) * w, w);
}

BeamTriangle beam_triangle(uvec2 pixel, uint triangle, uint instance) {
  BeamTriangle result;
  vec3 a = beam_point(pixel, corner_position(triangle, 0u, instance), result.depths.x),
       b = beam_point(pixel, corner_position(triangle, 1u, instance), result.depths.y),
       c = beam_point(pixel, corner_position(triangle, 2u, instance), result.depths.z);
  result.lines[0] = exact_cross(b, c);
  result.lines[1] = exact_cross(c, a);
  result.lines[2] = exact_cross(a, b);
  result.orientation = dot(a, result.lines[0]);
  float side = result.orientation < 0.0 ? -1.0 : 1.0;
  for (uint i = 0u; i < 3u; ++i) result.lines[i] *= side;
  return result;
}

float depth_at(BeamTriangle triangle, vec2 point) {
  vec3 at = vec3(point, 1.0);
  vec3 weights = vec3(dot(triangle.lines[0], at), dot(triangle.lines[1], at), dot(triangle.lines[2], at));
  return dot(weights, triangle.depths) / (weights.x + weights.y + weights.z);
}

Polygon square_of(float half_) {
  Polygon square;
  square.corners[0] = vec2(-half_, -half_);
  square.corners[1] = vec2(half_, -half_);
  square.corners[2] = vec2(half_, half_);
  square.corners[3] = vec2(-half_, half_);
  square.count = 4u;
  return square;
}

bool lost_corners = false; // a polygon had no room for all

void add_corner(inout Polygon polygon, vec2 corner) {
  if (polygon.count < kMostCorners)
    polygon.corners[polygon.count++] = corner;
  else
    lost_corners = true;
}

// The part where dot(line, (x, y, 1)) >= 0 (Sutherland and Hodgman 1974).
Polygon part_inside(Polygon polygon, vec3 line) {
  Polygon part;
  part.count = 0u;
  if (polygon.count == 0u) return part;
  vec2 from = polygon.corners[polygon.count - 1u];
  float height_from = dot(line, vec3(from, 1.0));
  for (uint i = 0u; i < polygon.count; ++i) {
    vec2 to = polygon.corners[i];
    float height = dot(line, vec3(to, 1.0));
    if ((height < 0.0) != (height_from < 0.0))
      add_corner(part, mix(from, to, clamp(height_from / (height_from - height), 0.0, 1.0)));
    if (height >= 0.0) add_corner(part, to);
    from = to;
    height_from = height;
  }
  return part;
}

Polygon part_inside(Polygon polygon, BeamTriangle triangle) {
  for (uint i = 0u; i < 3u; ++i) polygon = part_inside(polygon, triangle.lines[i]);
  if (!is_orthographic()) return polygon;
  return part_inside(polygon, triangle.lines[0] * triangle.depths.x + triangle.lines[1] * triangle.depths.y +
                                  triangle.lines[2] * triangle.depths.z); // not behind the eye
}

float cross_of(vec2 a, vec2 b) { return a.x * b.y - a.y * b.x; }

// Corners are taken from the first one, so that small polygons lose nothing.
float area_of(Polygon polygon) {
  float twice = 0.0;
  for (uint i = 2u; i < polygon.count; ++i)
    twice += cross_of(polygon.corners[i - 1u] - polygon.corners[0], polygon.corners[i] - polygon.corners[0]);
  return 0.5 * abs(twice);
}

float sector(vec2 a, vec2 b) {
  return 0.5 * kDiscRadius * kDiscRadius * atan2_exact(cross_of(a, b), dot(a, b));
}

// Area of the disc in the triangle between its middle and an edge from a to b; negative clockwise.
float disc_part(vec2 a, vec2 b) {
  vec2 d = b - a;
  float dd = dot(d, d), ad = dot(a, d), root = ad * ad - dd * (dot(a, a) - kDiscRadius * kDiscRadius);
  if (!(dd > 0.0) || root <= 0.0) return sector(a, b);
  float s = sqrt(root), enters = (-ad - s) / dd, leaves = (-ad + s) / dd;
  if (leaves <= 0.0 || enters >= 1.0) return sector(a, b);
  vec2 p = a + d * max(enters, 0.0), q = a + d * min(leaves, 1.0);
  return 0.5 * cross_of(p, q) + (enters > 0.0 ? sector(a, p) : 0.0) + (leaves < 1.0 ? sector(q, b) : 0.0);
}

// The fraction of the pixel that a polygon in it covers.
float fraction_in(Polygon polygon) {
  if (wave.bounce == kBeamSquare) return area_of(polygon);
  float sum = 0.0;
  for (uint i = 0u; i < polygon.count; ++i)
    sum += disc_part(polygon.corners[i == 0u ? polygon.count - 1u : i - 1u], polygon.corners[i]);
  return abs(sum);
}

#endif
