// Measures independent random loads a second, through the path that traversal uses: one or four adjacent texels of 16
// bytes. Nothing else is done but the index arithmetic; the sums keep compilers from removing the loads.
#version 460

layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kTexelsPerLoad = 1u;
layout(set = 0, binding = 0) uniform usamplerBuffer memory;
layout(set = 0, binding = 1, std430) writeonly buffer Sums { uint sums[]; };
layout(push_constant) uniform Parameters {
  uint block_count; // of kTexelsPerLoad texels
  uint load_count;
};

void main() {
  uint count = load_count, blocks = block_count;
  uint state = gl_GlobalInvocationID.x * 2891336453u + 1u;
  uvec4 sum = uvec4(0u);
  for (uint i = 0u; i < count; ++i) {
    state = state * 747796405u + 2891336453u; // a linear congruential generator; its top bits pick the block
    uint block, low;
    umulExtended(state, blocks, block, low);
    int texel = int(block * kTexelsPerLoad);
    sum ^= texelFetch(memory, texel);
    if (kTexelsPerLoad == 4u)
      sum ^= texelFetch(memory, texel + 1) ^ texelFetch(memory, texel + 2) ^ texelFetch(memory, texel + 3);
  }
  sums[gl_GlobalInvocationID.x] = sum.x ^ sum.y ^ sum.z ^ sum.w;
}
