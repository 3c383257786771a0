// Marks the pixels that show a plane mirror, which sees nothing yet: of the frame or, where it is that of a mirrored
// camera, of what the first mirror shows. Push constant: first_sample = the picture.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_HYBRID
#define BIND_VISIBILITY
#include "kernels/hybrid/bindings.glsl"
#include "kernels/hybrid/reflections/reflection_types.h"

layout(set = 0, binding = kBindReflectionFrame, std140) uniform ReflectionFrameBlock { ReflectionFrame reflection; };
#include "kernels/hybrid/reflections/plane_mirror.glsl"

layout(location = 0) out uvec2 seen;

void main() {
  if (!shows_plane_mirror(uvec2(gl_FragCoord.xy), reflection.mirrors[wave.first_sample])) discard;
  seen = uvec2(kNone);
}
