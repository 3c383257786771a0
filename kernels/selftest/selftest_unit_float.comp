// Converts every random word that a lane is given to a number, as the samplers do; writes the bits of the smallest and
// the largest one.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/base/sampler.glsl"

layout(local_size_x = kWorkgroupSize) in;
layout(set = 0, binding = 0, std430) writeonly buffer Results { uvec2 results[]; };
layout(push_constant) uniform Parameters {
  uint first_word;
  uint words_per_lane; // below 65,536 (Mesa 22.3 ends longer loops)
};

void main() {
  uint lane = gl_GlobalInvocationID.x, first = first_word + lane * words_per_lane;
  uint lowest = 0xffffffffu, highest = 0u;
  for (uint i = 0u; i < words_per_lane; ++i) {
    uint word = first + i;
    uint bits = floatBitsToUint(unit_float(word));
    uvec2 both = floatBitsToUint(unit_float(uvec2(word, ~word)));
    lowest = min(lowest, min(bits, min(both.x, both.y)));
    highest = max(highest, max(bits, max(both.x, both.y)));
  }
  results[lane] = uvec2(lowest, highest);
}
