// A reflection map: what is seen around a point (Blinn and Newell 1976), on the faces of a cube or as on a mirrored
// ball. Include reflections/bindings.glsl first.
#ifndef WAVEPATH_REFLECTION_MAP_GLSL
#define WAVEPATH_REFLECTION_MAP_GLSL

#include "kernels/base/math.glsl"

layout(set = 0, binding = kBindReflectionMap, std430) buffer ReflectionMapBlock { vec4 reflection_map[]; };

bool is_ball() { return reflection.map_kind == kMapBall; }
uint map_faces() { return is_ball() ? 1u : 6u; }
uint map_texels() { return map_faces() * reflection.map_side * reflection.map_side; }

// Face 2 i + s is that of axis i, s = 1: its negative half.
vec3 cube_direction(uint face, vec2 p) {
  uint axis = face / 2u;
  vec3 direction;
  direction[axis] = (face & 1u) == 0u ? 1.0 : -1.0;
  direction[(axis + 1u) % 3u] = p.x;
  direction[(axis + 2u) % 3u] = p.y;
  return normalize(direction);
}

// The direction that a mirrored ball shows at `p`, seen from `axis`; false outside of the ball.
bool ball_direction(vec2 p, out vec3 direction) {
  float r2 = dot(p, p);
  vec3 n = vec3(p, sqrt(max(1.0 - r2, 0.0))), tangent, bitangent;
  make_basis(reflection.axis, tangent, bitangent);
  direction = normalize(to_world(2.0 * n.z * n - vec3(0.0, 0.0, 1.0), tangent, bitangent, reflection.axis));
  return r2 < 1.0;
}

// The direction of a texel's middle; false if it shows none.
bool texel_direction(uint texel, out vec3 direction) {
  uint side = reflection.map_side, face = texel / (side * side), in_face = texel % (side * side);
  vec2 p = 2.0 * (vec2(in_face % side, in_face / side) + 0.5) / float(side) - 1.0;
  if (is_ball()) return ball_direction(p, direction);
  direction = cube_direction(face, p);
  return true;
}

// Face and position in it, from -1 to 1, that show a direction. The inverse of texel_direction().
uint map_position(vec3 direction, out vec2 p) {
  if (is_ball()) {
    vec3 tangent, bitangent;
    make_basis(reflection.axis, tangent, bitangent);
    vec3 n = direction + reflection.axis; // the half vector
    p = vec2(dot(n, tangent), dot(n, bitangent)) / max(length(n), 1e-6);
    return 0u;
  }
  vec3 size = abs(direction);
  uint axis = size.x >= size.y && size.x >= size.z ? 0u : size.y >= size.z ? 1u : 2u;
  p = vec2(direction[(axis + 1u) % 3u], direction[(axis + 2u) % 3u]) / size[axis];
  return 2u * axis + (direction[axis] > 0.0 ? 0u : 1u);
}

// Interpolated between four texels of a face.
vec3 look_up_map(vec3 direction) {
  vec2 p;
  uint side = reflection.map_side, first = map_position(direction, p) * side * side;
  vec2 at = clamp(0.5 * (p + 1.0) * float(side) - 0.5, vec2(0.0), vec2(float(side) - 1.0));
  uvec2 low = uvec2(at), high = min(low + 1u, uvec2(side - 1u));
  vec2 part = at - vec2(low);
  vec3 a = reflection_map[first + low.y * side + low.x].rgb, b = reflection_map[first + low.y * side + high.x].rgb,
       c = reflection_map[first + high.y * side + low.x].rgb, d = reflection_map[first + high.y * side + high.x].rgb;
  return mix(mix(a, b, part.x), mix(c, d, part.x), part.y);
}

#endif
