// The spots of a frame's pixels, for defocus.comp: radius, depth, and the reciprocal of what all their pixels cover.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/defocus.glsl"
#include "kernels/base/math.glsl"

layout(set = 0, binding = kFilterSpots, std430) writeonly buffer SpotBlock { vec4 spots[]; };
layout(set = 0, binding = kFilterTileSpots, std430) writeonly buffer TileBlock { float tile_spots[]; };

shared float radii[kWorkgroupSize];

// In pixels. Pharr, Jakob and Humphreys, section 5.2.3, from the two triangles before and behind the sharp plane: the
// spot of depth d is |d - f| / d of that at infinity; parallel rays drift apart with |d - f|, by 1 / f of the lens.
float spot_radius(float depth) {
  if (depth == 0.0) return lens.orthographic != 0u ? 0.0 : min(lens.blur, kLargestSpot); // nothing, infinitely far
  float apart = abs(depth - lens.focus) / (lens.orthographic != 0u ? lens.focus : depth);
  return min(apart * lens.blur, kLargestSpot);
}

// The sum of disc_cover() over all pixels, from a quarter of the disc.
float whole_cover(float radius) {
  float sum = 0.0;
  int last = int(ceil(radius));
  for (int y = 0; y <= last; ++y)
    for (int x = 1; x <= last; ++x) sum += disc_cover(length(vec2(x, y)), radius);
  return 4.0 * sum + disc_cover(0.0, radius);
}

void main() {
  ivec2 pixel = lane_pixel();
  bool inside = in_picture(pixel);
  float radius = 0.0;
  if (inside) {
    int index = pixel_index(pixel);
    float depth = seen_depth(index);
    radius = spot_radius(depth);
    spots[index] = vec4(radius, depth == 0.0 ? kFar : depth, 1.0 / whole_cover(radius), 0.0);
  }
  radii[gl_LocalInvocationID.x] = radius;
  barrier();
  if (gl_LocalInvocationID.x != 0u) return;
  float largest = 0.0;
  for (uint i = 0u; i < kWorkgroupSize; ++i) largest = max(largest, radii[i]);
  tile_spots[gl_WorkGroupID.x + band.first_tile] = largest;
}
