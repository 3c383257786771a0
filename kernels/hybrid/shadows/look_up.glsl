// Answers the shadow rays of a frame that go to lights with views: the path gains the fraction of the light that
// lit_fraction() tells, and nothing is left for the ray to bring. A kernel defines lit_fraction() after this.
#ifndef WAVEPATH_LOOK_UP_GLSL
#define WAVEPATH_LOOK_UP_GLSL

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_PATHS
#define BIND_RAYS
#define BIND_SHADOW_RAYS
#define BIND_QUEUES
#define BIND_SHADOW_LIGHTS
#define BIND_SHADOW_DEPTHS
#ifdef PAGED_MAPS // virtual ones
#define BIND_SHADOW_PAGES
#endif
#include "kernels/hybrid/shadows/bindings.glsl"
#include "kernels/path/bindings.glsl"
#include "kernels/path/records.glsl"
#include "kernels/hybrid/shadows/answer.glsl"
#include "kernels/hybrid/shadows/view.glsl"
#include "kernels/surface/surface.glsl"

layout(local_size_x = kWorkgroupSize) in;

// A point that asks a light's view whether it is lit.
struct Receiver {
  vec3 position;  // device world
  vec3 normal;    // geometric normal, on the side of the light
  vec3 to_light;  // unit length: to the origin of the view
  Hit hit;        // hit of the camera ray
  uint slot;
  uvec2 views;    // views of the light: first, count
  uint view_index;
  ShadowView view;
  vec2 map_position; // position in texels of the view
  float depth;       // depth as stored in maps
};

// From 0, in shadow, to 1; below 0 where only the ray itself can tell.
float lit_fraction(Receiver r);

#ifdef TINTS_LIGHT
vec3 light_tint(Receiver r); // factor of the light on its way, besides shadows
#endif

// Turns to a view of the light. False if it does not show the point.
bool look_through(uint view_index, inout Receiver r) {
  r.view_index = view_index;
  r.view = fetch_shadow_view(view_index);
  if (!project_to_view(r.view, r.position, r.map_position)) return false;
  if (r.view.texel == 0.0) r.view.texel = warped_texel(r.view, r.position);
  r.depth = view_depth(r.view, r.position);
  r.to_light = r.view.kind == kViewParallel ? r.view.light : normalize(r.view.light - r.position);
  return true;
}

// A view that shows the point, the first of those of its light.
bool find_view(inout Receiver r) {
  for (uint i = 0u; i < r.views.y; ++i)
    if (look_through(r.views.x + i, r)) return true;
  return false;
}

// Where a map has a texel, the nearest one of the view; of virtual maps, below 0 where it is not resident.
int map_texel(ShadowView v, ivec2 texel) {
  texel = clamp(texel, ivec2(0), ivec2(shadow.size) - 1);
#ifdef PAGED_MAPS
  uvec2 page = page_of(texel), within = uvec2(texel) % kShadowPage;
  uint slot = page_words[v.first_texel + page.y * pages_across() + page.x];
  return slot == kNone ? -1 : int((slot * kShadowPage + within.y) * kShadowPage + within.x);
#else
  return int(v.first_texel) + texel.y * int(shadow.size) + texel.x;
#endif
}
float map_depth(ShadowView v, ivec2 texel) { return texelFetch(shadow_depths, map_texel(v, texel)).x; }

#ifdef BIND_SHADOW_COUNTS
#define ADD64(counter, count)                                         \
  {                                                                   \
    uint before = atomicAdd(counter[0], count);                       \
    if (before + count < before) atomicAdd(counter[1], 1u);           \
  }
void count_answers(bool answered) {
  uint yes = subgroupBallotBitCount(subgroupBallot(answered)), no = subgroupBallotBitCount(subgroupBallot(!answered));
  if (!subgroupElect()) return;
  ADD64(shadow_counts.answered, yes)
  ADD64(shadow_counts.left, no)
}
#endif

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= queues.shadow_count[0]) return;
  ShadowRay ray = fetch_shadow_ray(index);
  Receiver r;
  r.views = texelFetch(shadow_lights, int(ray.light)).xy;
  if (r.views.x == kNone) return;
  r.hit = fetch_hit(ray.slot);
  r.slot = ray.slot;
  Surface surface = fetch_surface(r.hit);
  r.position = surface.position;
  r.normal = dot(surface.geometric_normal, ray.direction) < 0.0 ? -surface.geometric_normal : surface.geometric_normal;
  if (!find_view(r)) return;
#ifdef TINTS_LIGHT
  ray.contribution *= light_tint(r);
#endif
  float lit = lit_fraction(r);
#ifdef BIND_SHADOW_COUNTS
  count_answers(lit >= 0.0);
#endif
  if (!(lit >= 0.0)) return;
  answer_shadow_ray(index, ray, min(lit, 1.0));
}

#endif
