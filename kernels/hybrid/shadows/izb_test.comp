// Tests triangles with the shadow rays that are listed in the cells that they cover (Johnson et al. 2005; Aila and
// Laine 2004; Wyman et al. 2015), by the arithmetic and the rules that tracing has for any hit. Lists are in no order,
// and the result does not depend on one: a ray is blocked or it is not, and what surfaces take from it are integers.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_SHADOW_RAYS
#include "kernels/hybrid/shadows/bindings.glsl"
#include "kernels/path/bindings.glsl"
#include "kernels/path/records.glsl"
#include "kernels/base/pixel.glsl"
#include "kernels/base/records.glsl"
#include "kernels/hybrid/shadows/izb.glsl"

Sampler path_sampler;
#define SHADOW_PASSES_PANES
#include "kernels/light/shadow.glsl"

#define ALPHA_TEST(hit) lets_light_through(hit, t_pending)
#define ANY_HIT
#include "kernels/bvh/bvh.glsl"

layout(local_size_x = kWorkgroupSize) in;

const uint kMostTrips = 1u << 14; // limit of a loop: lavapipe ends loops silently after 65,535 rounds

// Tests a triangle of a leaf, for traverse().
void test(uint ray_index, uint triangle, uint of_instance) {
  uint link = link_word(ray_index);
  if (izb_links[link + 2u] != 0u) return;
  ShadowRay ray = fetch_shadow_ray(ray_index);
  if (has(kFeaturePanes) && has(kFeatureAlpha)) path_sampler = slot_sampler(ray.slot);
  begin_shadow(ray.direction);
  if (CULLS_BACKS) passed_sides = PASSES_BACKS ? kTriangleSingleSided : 0u;
  skipped_triangle = kNone; // lamps and suns have no surface
  skipped_instance = 0u;
  best = pending = Hit(kNone, 0u, 0.0, 0.0);
  instance = of_instance;
  if (has_levels()) {
    uint texel = instance * kInstanceTexels;
    local_ray = make_traversal_ray(transform_point(texel, ray.origin), transform_vector(texel, ray.direction));
  } else {
    local_ray = make_traversal_ray(ray.origin, ray.direction);
  }
  test_triangle(triangle, ray.t_max);
  // A loop, because Mesa 22.3 runs what is in a branch even where no lane of the subgroup takes it, but leaves loops.
  while (has(TESTED_FEATURES) && pending.triangle != kNone) look_up_alpha();
  bool blocked = best.triangle != kNone;
  // The one whose surface takes the last of the light says so; the sum may overflow only after that.
  if (!blocked && shadow_depth > 0u)
    blocked = atomicAdd(izb_links[link + 3u], shadow_depth) + shadow_depth >= kOpaqueShadow;
  if (blocked) atomicOr(izb_links[link + 2u], 1u);
}

void main() {
  uint index = wave.first_film_pixel + gl_GlobalInvocationID.x; // shadow rays have no use for it: the first item
  if (index >= uint(textureSize(izb_items))) return;
  uvec4 item = texelFetch(izb_items, int(index));
  uint columns = item.w & 0xffffu, rows = item.w >> 16u;
  for (uint row = 0u; row < rows; ++row)
    for (uint column = 0u; column < columns; ++column) {
      uint next = izb_cells[cell_word(item.z + row * shadow.size + column)];
      while (next != 0u)
        for (uint trip = 0u; trip < kMostTrips && next != 0u; ++trip) {
          test(next - 1u, item.x, item.y);
          next = izb_links[link_word(next - 1u)];
        }
    }
}
