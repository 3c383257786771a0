// Measures multiply-adds a second: eight independent chains of four, so that neither latency nor memory matters.
#version 460

layout(local_size_x = 64) in;
layout(set = 0, binding = 1, std430) writeonly buffer Sums { uint sums[]; };
layout(push_constant) uniform Parameters {
  uint unused;
  uint step_count;
};

void main() {
  uint count = step_count;
  vec4 x = vec4(float(gl_LocalInvocationID.x)) * 1e-3;
  vec4 a = x, b = x + 1.0, c = x + 2.0, d = x + 3.0, e = x + 4.0, f = x + 5.0, g = x + 6.0, h = x + 7.0;
  vec4 factor = vec4(0.999), term = vec4(1e-3);
  for (uint i = 0u; i < count; ++i) {
    a = fma(a, factor, term);
    b = fma(b, factor, term);
    c = fma(c, factor, term);
    d = fma(d, factor, term);
    e = fma(e, factor, term);
    f = fma(f, factor, term);
    g = fma(g, factor, term);
    h = fma(h, factor, term);
  }
  vec4 sum = a + b + c + d + e + f + g + h;
  sums[gl_GlobalInvocationID.x] = floatBitsToUint(sum.x + sum.y + sum.z + sum.w);
}
