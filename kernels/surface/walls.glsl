// Walls of bodies of ior 1 along a shadow ray, which light passes unbent and unreflected, dimmed by the body: traversal
// meets them in any order, so that they are kept, and put in order once the ray has arrived. Include bindings.glsl with
// BIND_SURFACES first.
#ifndef WAVEPATH_WALLS_GLSL
#define WAVEPATH_WALLS_GLSL

#include "kernels/surface/bodies.glsl"

const uint kMostWalls = 16u; // most walls that a ray passes: each is a bounce, of which paths have 8 by default
uint wall_count;
float wall_distances[kMostWalls]; // along the ray
uint wall_bodies[kMostWalls];     // 2 * material, + 1 where the ray enters
vec3 wall_fractions[kMostWalls];  // fraction of light that the wall transmits, if no other body hides it

bool keep_wall(uint material, bool enters, float distance_, vec3 fraction) {
  if (wall_count == kMostWalls) return false;
  wall_distances[wall_count] = distance_;
  wall_fractions[wall_count] = fraction;
  wall_bodies[wall_count++] = 2u * material + (enters ? 1u : 0u);
  return true;
}

void sort_walls() {
  for (uint i = 1u; i < wall_count; ++i) {
    float distance_ = wall_distances[i];
    vec3 fraction = wall_fractions[i];
    uint body = wall_bodies[i], k = i;
    for (; k > 0u; --k) {
      bool is_same = wall_distances[k - 1u] == distance_;
      if (!(wall_distances[k - 1u] > distance_) && !(is_same && wall_bodies[k - 1u] > body)) break;
      wall_distances[k] = wall_distances[k - 1u];
      wall_bodies[k] = wall_bodies[k - 1u];
      wall_fractions[k] = wall_fractions[k - 1u];
    }
    wall_distances[k] = distance_;
    wall_bodies[k] = body;
    wall_fractions[k] = fraction;
  }
}

vec3 optical_depth(uint body, float distance_) {
  return body == kNoBody ? vec3(0.0) : fetch_material(body).attenuation * distance_;
}

// Transmittance of walls and bodies along a ray that begins within `bodies` and ends `end` metres away. `metre`: length
// in metres of a unit of wall_distances. 0 if a wall borders on a body that makes it bend light, since paths do not go
// straight on there.
vec3 bodies_passed(uvec4 bodies, float metre, float end) {
  sort_walls();
  vec3 depth = vec3(0.0), fraction = vec3(1.0);
  float from = 0.0;
  for (uint i = 0u; i < wall_count; ++i) {
    float distance_ = wall_distances[i] * metre;
    uint body = wall_bodies[i] >> 1u;
    bool enters = (wall_bodies[i] & 1u) != 0u;
    depth += optical_depth(bodies.x, distance_ - from);
    from = distance_;
    if (!is_nested()) {
      fraction *= wall_fractions[i];
      bodies = enters ? one_body(body) : uvec4(kNoBody);
      continue;
    }
    uvec4 others = enters ? bodies : without_body(bodies, body);
    bool is_hidden = others.x != kNoBody && body_priority(others.x) >= body_priority(body);
    if (!is_hidden)
      fraction *= others.x != kNoBody && fetch_material(others.x).ior != 1.0 ? vec3(0.0) : wall_fractions[i];
    bodies = enters ? with_body(bodies, body) : others;
  }
  depth += optical_depth(bodies.x, end - from);
  return fraction * exp(-depth);
}

#endif
