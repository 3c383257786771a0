// Writes how far from the light a texel's surface is.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#include "kernels/hybrid/shadows/bindings.glsl"
#include "kernels/hybrid/shadows/shadow_fragment.glsl"

layout(location = 0) out float depth;

void main() {
  ShadowView v = fetch_shadow_view(wave.first_pixel);
  if (is_behind(v) || (has(kFeatureAlpha) && is_passed_through(v))) discard;
  depth = view_depth(v, position);
}
