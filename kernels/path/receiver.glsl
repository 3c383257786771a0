// The vertex that a path was scattered at, as it receives light. Include bindings.glsl with BIND_SURFACES,
// BIND_LIGHT_TREE, BIND_ENVIRONMENT and BIND_RECEIVERS first.
#ifndef WAVEPATH_PATH_RECEIVER_GLSL
#define WAVEPATH_PATH_RECEIVER_GLSL

#include "kernels/light/learned_sky.glsl"
#include "kernels/surface/vertex.glsl"

// True if the vertex is stored for its scattered ray. The hit needs it to compute the probability of the light there,
// or because the ray begins elsewhere after panes.
bool keeps_receivers() {
  bool found_behind_panes = has(kFeatureTriangleLights) || has_lobe(kFeatureSoftLamps);
  return uses_light_tree() || uses_learned_sky() || (uses(kFeaturePanes) && found_behind_panes);
}

// Stores the vertex for the weight of what the scattered ray may hit.
Receiver store_receiver(uint slot, Vertex v) {
  if (!keeps_receivers()) return Receiver(v.surface.position, vec3(0.0));
  // A map may bend the normal so far that what is folded at its surface leaves below the normal.
  bool any_side = lets_light_pass(v) || (is_bent(v) && !(dot(v.plane, v.normal) > 0.0));
  uvec4 words = uvec4(floatBitsToUint(v.surface.position), any_side ? 0u : pack_normal(v.normal));
  receiver_words[receiver_index(slot)] = words;
  return unpack_receiver(words);
}

Receiver fetch_receiver(uint slot) {
  if (!keeps_receivers()) return Receiver(vec3(0.0), vec3(0.0));
  return unpack_receiver(texelFetch(receiver_texels, int(receiver_index(slot))));
}

#endif
