// Writes the middle between the nearest surface of a texel, which the map holds already, and the next one behind it
// (Woo 1992): a depth that is far from both, so that neither shades itself. What has nothing behind it shades nothing.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_SHADOW_DEPTHS
#include "kernels/hybrid/shadows/bindings.glsl"
#include "kernels/hybrid/shadows/shadow_fragment.glsl"

layout(location = 0) out float middle;

// Relative: what is no deeper than that is the nearest surface itself, whose depth another pipeline rounded.
const float kSameDepth = 1e-6;

void main() {
  ShadowView v = fetch_shadow_view(wave.first_pixel);
  if (is_behind(v) || (has(kFeatureAlpha) && is_passed_through(v))) discard;
  uvec2 texel = uvec2(gl_FragCoord.xy);
  float depth = view_depth(v, position);
  float nearest = texelFetch(shadow_depths, int(v.first_texel + texel.y * shadow.size + texel.x)).x;
  if (depth <= nearest * (1.0 + kSameDepth)) discard;
  middle = 0.5 * (nearest + depth);
}
