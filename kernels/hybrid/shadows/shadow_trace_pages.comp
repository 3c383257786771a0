// The resident pages of virtual shadow maps by tracing, as shadow_trace.comp does. Push constant: first_pixel = first
// texel, counted over all resident pages, pixel_count = how many.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_SHADOW_MAP_WORDS
#define BIND_SHADOW_PAGES
#include "kernels/hybrid/shadows/bindings.glsl"
#include "kernels/hybrid/shadows/trace_texel.glsl"

layout(local_size_x = kWorkgroupSize) in;

void main() {
  if (gl_GlobalInvocationID.x >= wave.pixel_count) return;
  uint word = wave.first_pixel + gl_GlobalInvocationID.x, within = word % (kShadowPage * kShadowPage);
  uint view_pages = pages_across() * pages_across();
  uint page = page_words[shadow.view_count * view_pages + word / (kShadowPage * kShadowPage)],
       index = page % view_pages;
  uvec2 texel = uvec2(index % pages_across(), index / pages_across()) * kShadowPage +
                uvec2(within % kShadowPage, within / kShadowPage);
  if (all(lessThan(texel, uvec2(shadow.size)))) trace_texel(page / view_pages, texel, word, false);
}
