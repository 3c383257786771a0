// The point that a camera ray has met, and the light that it gains. Include bindings.glsl with BIND_PATHS first.
#ifndef WAVEPATH_SEEN_POINT_GLSL
#define WAVEPATH_SEEN_POINT_GLSL

#include "kernels/base/dimensions.glsl"
#include "kernels/base/pixel.glsl"
#include "kernels/path/records.glsl"
#include "kernels/radiosity/patches.glsl"

layout(set = 0, binding = kBindSeenPoints, std430) readonly buffer SeenPointBlock { SeenPoint seen_points[]; };

bool gains_light(SeenPoint seen) { return seen.hit.triangle != kNone && max_component(seen.weight) > 0.0; }

// Shading normal on the side that is seen.
vec3 seen_normal(Surface surface, SeenPoint seen) {
  return bumped_normal(surface, fetch_material(surface.material), seen.back == 0u);
}

void add_light(uint slot, SeenPoint seen, vec3 irradiance) {
  PathState path = fetch_path(slot);
  path.radiance += seen.weight * (kInvPi * irradiance);
  store_radiance(slot, path);
}

#endif
