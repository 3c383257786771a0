// Tables of directional albedo, made by the host: see kTableCells in kernels/base/scene_types.h. The includer defines
// vec4 fetch_table(uint texel); records.glsl does where BIND_SURFACES is.
#ifndef WAVEPATH_ALBEDO_TABLE_GLSL
#define WAVEPATH_ALBEDO_TABLE_GLSL

#include "kernels/base/scene_types.h"

vec4 fetch_table(uint texel);

float table_albedo(uint table, float cosine, float roughness) {
  vec2 position = vec2(sqrt(clamp(cosine, 0.0, 1.0)), clamp(roughness, 0.0, 1.0)) * float(kTableCells);
  uvec2 cell = min(uvec2(position), uvec2(kTableCells - 1u));
  vec4 corners = fetch_table(table + cell.y * kTableCells + cell.x);
  vec2 weight = position - vec2(cell);
  vec2 column = mix(corners.xy, corners.zw, weight.y);
  return mix(column.x, column.y, weight.x);
}

vec4 table_average(uint table, float roughness) {
  float position = clamp(roughness, 0.0, 1.0) * float(kTableCells);
  uint row = min(uint(position), kTableCells - 1u);
  uint first = table + kTableCells * kTableCells + row;
  return mix(fetch_table(first), fetch_table(first + 1u), position - float(row));
}

#endif
