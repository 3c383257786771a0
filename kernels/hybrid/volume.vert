// Places the corners of a shadow volume's pieces in the picture of a hybrid frame: a triangle that casts a shadow, its
// sides that lead away from the light, and its image at infinity (Crow 1977; Everitt and Kilgard 2002).
//
// What is at infinity has w = 0 in space, so that it is placed like any point, and its depth is 0: nothing is farther.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_HYBRID
#include "kernels/hybrid/bindings.glsl"
#include "kernels/hybrid/frame_corner.glsl"
#include "kernels/hybrid/shadows/volume_types.h"

layout(set = 0, binding = kBindVolumePieces) uniform usamplerBuffer volume_pieces;
layout(set = 0, binding = kBindVolumeLights) uniform samplerBuffer volume_lights;

invariant gl_Position; // a cap lies where the depth of its triangle was drawn, to the bit

void main() {
  uvec2 piece = texelFetch(volume_pieces, gl_VertexIndex / 3).xy;
  uint corner = uint(gl_VertexIndex) % 3u, edge = piece.y & kVolumeEdgeMask;
  bool far = (piece.y & kVolumeFar) != 0u, reversed = (piece.y & kVolumeReversed) != 0u;
  bool at_infinity = far;
  if (edge == kVolumeCap) {
    if (reversed) corner = 2u - corner;
  } else { // of the edge from `first` to `second` the triangle second, first, first at infinity, or the rest of the
           // side
    uint first = reversed ? (edge + 1u) % 3u : edge, second = reversed ? edge : (edge + 1u) % 3u;
    at_infinity = corner == 2u || (far && corner == 1u);
    corner = corner == 0u || (far && corner == 2u) ? second : first;
  }
  vec3 p = corner_position(piece.x, corner, piece.y >> kVolumeBits);
  if (!at_infinity) {
    gl_Position = clip_point(p - frame.camera_position, 1.0);
    return;
  }
  vec4 light = texelFetch(volume_lights, int(wave.first_pixel));
  gl_Position = clip_point(light.w > 0.0 ? p - light.xyz : light.xyz, 0.0);
}
