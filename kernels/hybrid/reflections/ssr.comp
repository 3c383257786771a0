// Reflections in screen space: mirrored rays go over the picture, from cell to cell of the pyramid of nearness, coarser
// where all is behind them and finer where something is not (Uludag 2014, "Hi-Z Screen-Space Cone-Traced Reflections"),
// and take the light of the pixel that they meet. What the picture does not show they miss.
//
// Push constant: first_pixel = the first one, row by row from the top left, pixel_count = how many.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_HYBRID
#define BIND_VISIBILITY
#define BIND_GBUFFER
#define BIND_SIGNALS
#define BIND_SEEN
#define BIND_REFLECTIONS
#include "kernels/hybrid/bindings.glsl"
#include "kernels/path/bindings.glsl"
#include "kernels/hybrid/reflections/bindings.glsl"
#include "kernels/hybrid/frame_terms.glsl"
#include "kernels/hybrid/reflections/mirror.glsl"
#include "kernels/hybrid/reflections/screen.glsl"

layout(local_size_x = kWorkgroupSize) in;

const uint kMostSteps = 512u;
const float kPastEdge = 1e-3; // pixels that a step goes beyond the edge of its cell

// The image of a ray: a + t b of pixels and nearness, up to t = end.
struct Image {
  vec3 a, b;
  float end;
};

Image image_of(Mirror mirror) {
  float depth = dot(mirror.origin - frame.camera_position, frame.camera_forward),
        facing = dot(mirror.direction, frame.camera_forward), reach = reflection.reach;
  // Towards the eye it ends in front of it.
  if (facing < 0.0 && !is_orthographic()) reach = min(reach, 0.99 * depth / -facing);
  Image image;
  image.a = shown_at(mirror.origin);
  image.b = shown_at(mirror.origin + reach * mirror.direction) - image.a;
  vec2 edge = mix(image.a.xy, vec2(frame.width, frame.height) - image.a.xy, greaterThan(image.b.xy, vec2(0.0)));
  vec2 to_edge = edge / max(abs(image.b.xy), vec2(1e-6));
  image.end = min(1.0, min(to_edge.x, to_edge.y));
  return image;
}

// Where the image leaves a cell, a little past its edge.
float leaves(Image image, uvec2 cell, uint level) {
  vec2 low = vec2(cell << level), high = vec2((cell + 1u) << level);
  vec2 edge = mix(low, high, greaterThan(image.b.xy, vec2(0.0)));
  vec2 inverse = 1.0 / max(abs(image.b.xy), vec2(1e-6));
  vec2 t = abs(edge - image.a.xy) * inverse;
  return min(t.x, t.y) + kPastEdge * min(inverse.x, inverse.y);
}

// Surfaces have a thickness, since nobody knows what is behind them; their backs reflect nothing.
bool meets(uint pixel_index, float near_end, vec3 direction) {
  GbufferPixel g = gbuffer[pixel_index];
  return g.depth > 0.0 && near_end >= nearness_of(g.depth + reflection.thickness) && dot(g.normal, direction) < 0.0;
}

// The pixel that the mirrored ray meets, kNone if none.
uint met_pixel(Mirror mirror) {
  Image image = image_of(mirror);
  uint level = 0u, top = top_level();
  float t = leaves(image, uvec2(image.a.xy), 0u);
  for (uint step_ = 0u; step_ < kMostSteps && t < image.end; ++step_) {
    vec2 at = image.a.xy + t * image.b.xy;
    if (any(lessThan(at, vec2(0.0))) || any(greaterThanEqual(at, vec2(frame.width, frame.height)))) return kNone;
    uvec2 cell = uvec2(at) >> level;
    float next = max(leaves(image, cell, level), t + kPastEdge / max(length(image.b.xy), 1e-6));
    float here = image.a.z + t * image.b.z, there = image.a.z + min(next, image.end) * image.b.z;
    bool in_front = min(here, there) > nearness[level_start(level) + cell.y * level_size(level).x + cell.x];
    if (!in_front && level > 0u) {
      --level;
      continue;
    }
    uint pixel_index = cell.y * frame.width + cell.x; // of the finest level
    if (!in_front && meets(pixel_index, max(here, there), mirror.direction)) return pixel_index;
    t = next;
    level = in_front ? min(level + 1u, top) : 0u;
  }
  return kNone;
}

// Light of the surface that a pixel shows, as composite.comp adds it up, without what it emits.
vec3 lit_surface(uint pixel_index) {
  GbufferPixel g = gbuffer[pixel_index];
  vec4 signal = signals[pixel_index];
  vec3 light = demodulation(g.albedo) * signal.rgb;
  if (wants_ambient()) light += g.albedo * seen[pixel_index].w * hybrid.ambient * signal.w;
  return is_finite(light) ? light : vec3(0.0);
}

void main() {
  Mirror mirror;
  bool asked = false;
  uint met = kNone;
  uint pixel_index = wave.first_pixel + gl_GlobalInvocationID.x;
  if (gl_GlobalInvocationID.x < wave.pixel_count) {
    asked = find_mirror(uvec2(pixel_index % frame.width, pixel_index / frame.width), vec2(0.0), false, mirror);
    if (asked) met = met_pixel(mirror);
    reflections[pixel_index] = vec4(met == kNone ? vec3(0.0) : mirror.weight * lit_surface(met), 0.0);
  }
  count_reflections(kCountAsked, asked);
  count_reflections(kCountAnswered, met != kNone);
}
