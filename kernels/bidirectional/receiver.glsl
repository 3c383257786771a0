// Receivers of light: the data of a surface by which next-event estimation selects lights, which both ends of a path
// must know. Include bindings.glsl with BIND_LIGHTS, BIND_LIGHT_TREE and BIND_RECEIVERS first.
#ifndef WAVEPATH_BIDIRECTIONAL_RECEIVER_GLSL
#define WAVEPATH_BIDIRECTIONAL_RECEIVER_GLSL

#include "kernels/light/light_selection.glsl"
#include "kernels/surface/vertex.glsl"

// Uses the geometric normal: the shading normal is turned towards the viewer, so that the two ends of a path would
// disagree. No light comes from below either (see sides_agree()).
uvec4 receiver_words_of(Vertex v) {
  vec3 facing = v.front ? v.surface.geometric_normal : -v.surface.geometric_normal;
  return uvec4(floatBitsToUint(v.surface.position), lets_light_pass(v) ? 0u : pack_normal(facing));
}

Receiver receiver_at(Vertex v) {
  return uses_light_tree() ? unpack_receiver(receiver_words_of(v)) : Receiver(v.surface.position, vec3(0.0));
}

// The vertex that the camera path was scattered at, for the weight of what it meets next.
void store_receiver(uint slot, Vertex v) {
  if (uses_light_tree()) receiver_words[slot] = receiver_words_of(v);
}
Receiver fetch_receiver(uint slot) { return unpack_receiver(texelFetch(receiver_texels, int(slot))); }

#endif
