// The nearest layer behind the one that was peeled last (Everitt 2001). Layers are in order by the depth that the test
// keeps, and of equal depths by their index in the list, so that each of them is peeled once.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/transparency/layer_fragment.glsl"
#include "kernels/hybrid/frame_corner.glsl"
#include "kernels/hybrid/transparency/transparency_types.h"

layout(set = 0, binding = kBindLayerSeen) uniform usamplerBuffer layer_seen;

layout(location = 0) out uvec2 seen;

void main() {
  Fragment f;
  if (!is_in_front(f)) discard;
  float z = clamp(clip_depth(f.depth), 0.0, 1.0);
  if (wave.bounce > 0u) {
    uvec2 last = texelFetch(layer_seen, int(f.pixel.y * frame.width + f.pixel.x)).xy;
    float last_z = uintBitsToFloat(last.y);
    if (last.x == kNone || z > last_z || (z == last_z && layer <= last.x)) discard;
  }
  gl_FragDepth = z;
  seen = uvec2(layer, floatBitsToUint(z));
}
