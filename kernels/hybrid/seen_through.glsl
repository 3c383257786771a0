// Surfaces that the camera sees through in a hybrid frame, besides holes: BLEND surfaces, or those that transmit, as
// --transparency says. Include bindings.glsl with BIND_GEOMETRY, BIND_SURFACES and BIND_HYBRID first.
#ifndef WAVEPATH_SEEN_THROUGH_GLSL
#define WAVEPATH_SEEN_THROUGH_GLSL

#include "kernels/hybrid/hybrid.glsl"
#include "kernels/surface/surface.glsl"

// Bayer's matrix of 8x8 (1973): its position in the order in which pixels open, as a fraction. A position is made of
// two bits of x and y at a time, the coarsest last.
float screen_door(uvec2 pixel) {
  uint order = 0u;
  for (uint bit = 0u; bit < 3u; ++bit) {
    uint x = pixel.x >> bit & 1u, y = pixel.y >> bit & 1u;
    order |= ((x ^ y) << 1u | y) << (4u - 2u * bit);
  }
  return (float(order) + 0.5) / 64.0;
}

bool is_blended(Hit hit) {
  uint packed = floatBitsToUint(texelFetch(triangles, int(hit.triangle * kTriangleTexels)).w);
  return (fetch_material(packed & kTriangleMaterialMask).flags & kMaterialBlend) != 0u;
}

// True if the surface is a layer of glass, also of triangles without alpha; only rasterized frames ask.
bool is_layer_of_glass(uint packed) {
  return (hybrid.flags & kHybridRefractive) != 0u && fetch_material(packed & kTriangleMaterialMask).transmission > 0.0;
}

// True if the camera ray of the pixel passes through the hit: at random, unless a technique says otherwise.
bool is_seen_through(Hit hit, uvec2 pixel) {
  uint technique = hybrid.flags & (kHybridLayers | kHybridScreendoor);
  if (technique == 0u || !is_blended(hit)) return is_hole(hit, hybrid_sampler(pixel), kHashExtend);
  return technique == kHybridLayers || screen_door(pixel) >= hit_opacity(hit, true);
}

#endif
