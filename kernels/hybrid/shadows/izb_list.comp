// Puts the shadow rays of a wave into lists, by the cell of their light's view that they start in.
//
// A ray that aims past its light, or starts where rounding moves it by more than half a cell, is in no list and will be
// traced: cover_cells() of host/integrators/hybrid/shadows/light_cells.h grows triangles by as much as the others may
// be off.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_SHADOW_RAYS
#define BIND_QUEUES
#define BIND_SHADOW_LIGHTS
#include "kernels/hybrid/shadows/bindings.glsl"
#include "kernels/path/bindings.glsl"
#include "kernels/path/records.glsl"
#include "kernels/hybrid/shadows/izb.glsl"
#include "kernels/hybrid/shadows/view.glsl"

layout(local_size_x = kWorkgroupSize) in;

const float kLargestCoordinate = 1e18; // rays beyond hit nothing when they are traced

bool aims_at_light(ShadowView v, ShadowRay ray) {
  vec3 aim = v.kind == kViewParallel ? ray.direction : ray.origin + ray.direction;
  return length(aim - v.light) <= v.texel; // false for NaN
}

uint find_cell(ShadowRay ray) {
  uvec2 views = texelFetch(shadow_lights, int(ray.light)).xy;
  if (views.x == kNone || !all(lessThanEqual(abs(ray.origin), vec3(kLargestCoordinate)))) return kNone;
  for (uint i = 0u; i < views.y; ++i) {
    ShadowView v = fetch_shadow_view(views.x + i);
    vec4 h = view_position(v, ray.origin);
    if (!(h.w >= v.near && all(lessThanEqual(abs(h.xy), vec2(h.w))))) continue;
    if (!aims_at_light(v, ray)) return kNone;
    uvec2 cell = min(uvec2((0.5 * h.xy / h.w + 0.5) * float(shadow.size)), uvec2(shadow.size - 1u));
    return v.first_texel + cell.y * shadow.size + cell.x;
  }
  return kNone;
}

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= queues.shadow_count[0]) return;
  uint cell = find_cell(fetch_shadow_ray(index)), link = link_word(index);
  izb_links[link + 1u] = cell;
  izb_links[link + 2u] = izb_links[link + 3u] = 0u;
  if (cell == kNone) return;
  izb_links[link] = atomicExchange(izb_cells[cell_word(cell)], index + 1u);
  atomicMax(izb_cells[0], atomicAdd(izb_cells[cell_word(cell) + 1u], 1u) + 1u);
}
