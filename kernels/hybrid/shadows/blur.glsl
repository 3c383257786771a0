// A box filter of radius ShadowFrame::blur over what a technique makes of depths, first along rows, then along columns.
// Where depths are looked up between texels with linear weights, and 2 * blur is odd, that is the mean over the square
// of that radius around the position: what percentage-closer filtering looks at.
// Push constant: first_pixel = first texel, pixel_count = how many, sample_count = the view.
#ifndef WAVEPATH_SHADOW_BLUR_GLSL
#define WAVEPATH_SHADOW_BLUR_GLSL

#define BIND_SHADOW_DEPTHS
#define BIND_SHADOW_FILTERED_WORDS
#define BIND_SHADOW_SCRATCH
#include "kernels/hybrid/shadows/bindings.glsl"
#include "kernels/hybrid/shadows/view.glsl"
#include "kernels/hybrid/shadows/unit_depth.glsl"

layout(local_size_x = kWorkgroupSize) in;

float blur_radius() { return max(shadow.blur, 0.5); } // half a texel: the texel itself
int blur_reach() { return int(ceil(blur_radius() - 0.5)); }
// Weight of a texel at a distance; the weights of a row add up to 1.
float blur_weight(int away) { return clamp(blur_radius() + 0.5 - abs(float(away)), 0.0, 1.0) / (2.0 * blur_radius()); }

bool find_texel(out ShadowView v, out ivec2 texel) {
  uint index = wave.first_pixel + gl_GlobalInvocationID.x;
  v = fetch_shadow_view(wave.sample_count);
  texel = ivec2(index % shadow.size, index / shadow.size);
  return gl_GlobalInvocationID.x < wave.pixel_count;
}
// Index in the maps of the nearest texel that the view has.
int index_in_maps(ShadowView v, ivec2 texel) {
  texel = clamp(texel, ivec2(0), ivec2(shadow.size) - 1);
  return int(v.first_texel) + texel.y * int(shadow.size) + texel.x;
}

#endif
