// From points of triangles to positions in the atlas of a lightmap, and back. Include
// kernels/hybrid/shadows/bindings.glsl first.
#ifndef WAVEPATH_LIGHTMAP_GLSL
#define WAVEPATH_LIGHTMAP_GLSL

#include "kernels/base/config.glsl"
#include "kernels/hybrid/shadows/lightmap_types.h"

layout(set = 0, binding = kBindLightmapFirst) uniform usamplerBuffer lightmap_first;
layout(set = 0, binding = kBindLightmapCharts) uniform usamplerBuffer lightmap_charts;

uvec2 fetch_chart(uint triangle, uint instance) {
  uint first = texelFetch(lightmap_first, has(kFeatureInstances) && frame.root_is_top != 0u ? int(instance) : 0).x;
  return texelFetch(lightmap_charts, int(first + triangle)).xy;
}

vec2 chart_corner(uvec2 chart) { return vec2(chart.x & 0xffffu, chart.x >> 16u); }
float chart_side(uvec2 chart) { return float(chart.y & kChartSideMask); }
// Texels along the triangle's edges.
float chart_scale(uvec2 chart) { return chart_side(chart) + ((chart.y & kChartSingle) != 0u ? 0.5 : 0.0); }
uint chart_apex(uvec2 chart) { return chart.y >> kChartApexShift & 3u; }

// Position in the atlas in texels; centres of texels are at halves.
vec2 position_in_atlas(uvec2 chart, vec3 weights) {
  uint apex = chart_apex(chart);
  vec2 at = vec2(weights[(apex + 1u) % 3u], weights[(apex + 2u) % 3u]);
  if ((chart.y & kChartUpper) != 0u) at = 1.0 - at;
  return chart_corner(chart) + at * chart_scale(chart);
}

// The point that a texel of the chart stands for.
vec3 weights_of_texel(uvec2 chart, uvec2 texel) {
  vec2 at = vec2(texel) + 0.5 - chart_corner(chart);
  if ((chart.y & kChartSingle) != 0u) at -= 0.5 * max(at.x + at.y - chart_side(chart), 0.0);
  at /= chart_scale(chart);
  if ((chart.y & kChartUpper) != 0u) at = 1.0 - at;
  uint apex = chart_apex(chart);
  vec3 weights;
  weights[apex] = 1.0 - at.x - at.y;
  weights[(apex + 1u) % 3u] = at.x;
  weights[(apex + 2u) % 3u] = at.y;
  return weights;
}

#endif
