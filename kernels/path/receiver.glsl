// The vertex that a path was scattered at, as it receives light. Include bindings.glsl with BIND_SURFACES, BIND_LIGHT_TREE and
// BIND_RECEIVERS first.
#ifndef WAVEPATH_PATH_RECEIVER_GLSL
#define WAVEPATH_PATH_RECEIVER_GLSL

#include "kernels/light_selection.glsl"
#include "kernels/surface.glsl"

// Whether a ray that a vertex scatters must know it when it arrives: for the choice of the light, or because panes between
// make the ray begin elsewhere.
bool keeps_receivers() { return uses_light_tree() || (uses(kFeaturePanes) && has(kFeatureTriangleLights)); }

Receiver fetch_receiver(uint slot) {
  if (!keeps_receivers()) return Receiver(vec3(0.0), vec3(0.0));
  return unpack_receiver(texelFetch(receiver_texels, int(slot)));
}

#endif
