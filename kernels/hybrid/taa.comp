// Temporal anti-aliasing: a frame joined to the frames before it, which follow the camera's motion (Karis 2014) and are
// clipped to the colours that surround the pixel now (Salvi 2016).
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/history.glsl"

// A pixel's motion: that of the nearest surface in its neighbourhood, so that outlines move with their object.
vec2 motion(ivec2 pixel) {
  ivec2 nearest = pixel;
  float depth = kFar;
  for (int i = 0; i < 9; ++i) {
    ivec2 there = pixel + ivec2(i % 3, i / 3) - 1;
    float found = seen_depth(pixel_index(there));
    if (in_picture(there) && found > 0.0 && found < depth) {
      depth = found;
      nearest = there;
    }
  }
  vec3 position = position_before(nearest, depth == kFar ? 0.0 : depth);
  return position.z > 0.0 || frames.still != 0u ? position.xy - vec2(nearest) : vec2(kFar);
}

void main() {
  ivec2 pixel = lane_pixel();
  if (!in_picture(pixel)) return;
  int index = pixel_index(pixel);
  Neighbourhood around = Neighbourhood(vec3(0.0), vec3(0.0), vec3(0.0), 0.0);
  for (int i = 0; i < 9; ++i) {
    ivec2 there = pixel + ivec2(i % 3, i / 3) - 1;
    if (in_picture(there)) add_neighbour(texelFetch(color_in, pixel_index(there)).xyz, around);
  }
  vec2 position = vec2(pixel) + motion(pixel);
  vec4 history = was_shown(position) ? history_at(position) : vec4(0.0);
  history.xyz = clip(history.xyz, around);

  vec3 color = texelFetch(color_in, index).xyz;
  if (usable(color))
    store(index, join(history, color));
  else if (history.w > 0.0)
    store(index, history);
  else
    store(index, vec4(around.plain / max(around.count, 1.0), 0.0));
}
