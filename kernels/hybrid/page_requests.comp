// Marks the pages of virtual shadow maps in which the points that a frame shows are looked up: words by page, view by
// view.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/visible_point.glsl"
#include "kernels/hybrid/shadows/view.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  vec3 position;
  float depth;
  if (!visible_point(position, depth)) return;
  // Distance by which a bias or rounding may move the point.
  float reach = 1.0 + (shadow.bias_kind == kBiasNormal ? shadow.bias : 0.0);
  for (uint index = 0u; index < shadow.view_count; ++index) {
    ShadowView v = fetch_shadow_view(index);
    vec2 projected;
    if (!project_to_view(v, position, projected)) continue;
    uvec2 lo = page_of(ivec2(floor(projected - reach))), hi = page_of(ivec2(floor(projected + reach)));
    for (uint y = lo.y; y <= hi.y; ++y)
      for (uint x = lo.x; x <= hi.x; ++x) {
        uint page = v.first_texel + y * pages_across() + x;
        if (frame_words[page] == 0u) atomicOr(frame_words[page], 1u);
      }
  }
}
