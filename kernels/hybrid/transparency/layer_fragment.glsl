// A fragment of a layer, BLEND or glass: whether it lies in front of what is opaque, and where the camera ray meets it.
#ifndef WAVEPATH_LAYER_FRAGMENT_GLSL
#define WAVEPATH_LAYER_FRAGMENT_GLSL

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_LIGHTS
#define BIND_ENVIRONMENT
#define BIND_HYBRID
#include "kernels/hybrid/bindings.glsl"
#include "kernels/hybrid/hybrid.glsl"
#include "kernels/bvh/known_triangle.glsl"
#include "kernels/surface/surface.glsl"

// Fragment shaders that could write it need an optional feature.
layout(set = 0, binding = kBindGbuffer, std430) readonly buffer OpaqueBlock { GbufferPixel opaque[]; };

layout(location = 0) flat in uint triangle;
layout(location = 1) flat in uint instance;
layout(location = 2) flat in uint hidden_sides; // see hidden_sides_of()
layout(location = 3) flat in uint layer;        // index in the list

struct Fragment {
  uvec2 pixel;
  vec3 origin, direction; // of the camera ray
  Hit hit;
  float depth; // along the view axis
};

// False where there is nothing to be seen of it. What lies in the plane of an opaque surface is in front of that, as it
// is for rays that pass through it at random where its triangle comes first.
bool is_in_front(out Fragment f) {
  if (CULLS_BACKS && (hidden_sides & (gl_FrontFacing ? 2u : 1u)) != 0u) return false;
  f.pixel = uvec2(gl_FragCoord.xy);
  hybrid_camera_ray(f.pixel, f.origin, f.direction);
  f.hit = hit_of_triangle(triangle, instance, f.origin, f.direction);
  if (has(kFeatureAlpha) && (hybrid.flags & kHybridRefractive) != 0u &&
      is_hole(f.hit, hybrid_sampler(f.pixel), kHashExtend))
    return false;
  f.depth = dot(fetch_surface(f.hit).position - f.origin, frame.camera_forward);
  float behind = opaque[f.pixel.y * frame.width + f.pixel.x].depth;
  return f.depth > 0.0 && (behind == 0.0 || f.depth <= behind);
}

#endif
