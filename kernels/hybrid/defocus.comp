// Depth of field after the frame (Potmesil and Chakravarty 1981): every pixel is spread over its spot, here gathered by
// the pixels that spots cover. Three layers about the depth of the gathering pixel, after McGuire et al. 2012: what is
// in front of it covers it by its spots' shares; what is as deep spreads by its own spot, and what is behind shows
// through the pixel's own.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/defocus.glsl"
#include "kernels/base/math.glsl"

layout(set = 0, binding = kFilterColorIn) uniform samplerBuffer color_in;
layout(set = 0, binding = kFilterColorOut, std430) writeonly buffer ColorBlock { vec4 color_out[]; };
layout(set = 0, binding = kFilterSpotTexels) uniform samplerBuffer spot_texels;
layout(set = 0, binding = kFilterTileSpotTexels) uniform samplerBuffer tile_spot_texels;

const float kSameDepth = 1.01; // ratio of depths up to which pixels are of one layer

vec4 near_layer, layer; // light and weight: in front of the pixel; as deep or behind

void gather(ivec2 pixel, vec3 own, ivec2 there) {
  vec3 spot = texelFetch(spot_texels, pixel_index(there)).xyz;
  bool in_front = spot.y * kSameDepth < own.y, behind = spot.y > own.y * kSameDepth;
  float radius = behind ? own.x : spot.x, share = behind ? own.z : spot.z;
  float weight = disc_cover(length(vec2(there - pixel)), radius) * share;
  if (weight <= 0.0) return;
  vec3 color = texelFetch(color_in, pixel_index(there)).rgb;
  if (!is_finite(color)) return;
  vec4 light = weight * vec4(color, 1.0);
  if (in_front)
    near_layer += light;
  else
    layer += light;
}

// The tile's nearest pixel is at that distance.
float distance_to(ivec2 corner, ivec2 pixel) {
  ivec2 last = corner + int(kFilterTile) - 1;
  return length(vec2(max(max(corner - pixel, pixel - last), ivec2(0))));
}

void main() {
  ivec2 pixel = lane_pixel();
  if (!in_picture(pixel)) return;
  int index = pixel_index(pixel);
  vec3 own = texelFetch(spot_texels, index).xyz;
  near_layer = layer = vec4(0.0);
  int side = int(kFilterTile), reach = int(kLargestSpot) / side + 1;
  ivec2 tile = pixel / side, tiles = (picture_size() + side - 1) / side;
  ivec2 first = max(tile - reach, ivec2(0)), last = min(tile + reach, tiles - 1);
  for (int y = first.y; y <= last.y; ++y)
    for (int x = first.x; x <= last.x; ++x) {
      ivec2 corner = side * ivec2(x, y);
      float radius = max(own.x, texelFetch(tile_spot_texels, y * tiles.x + x).x);
      if (distance_to(corner, pixel) >= radius + 0.5) continue;
      ivec2 end = min(corner + side, picture_size());
      for (int j = corner.y; j < end.y; ++j)
        for (int i = corner.x; i < end.x; ++i) gather(pixel, own, ivec2(i, j));
    }
  vec3 color = texelFetch(color_in, index).rgb;
  if (layer.w > 0.0) {
    float covered = min(near_layer.w, 1.0);
    color = layer.rgb / layer.w;
    if (covered > 0.0) color = mix(color, near_layer.rgb / near_layer.w, covered);
  }
  color_out[index] = vec4(color, 0.0);
}
