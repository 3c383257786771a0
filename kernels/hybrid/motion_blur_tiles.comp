// The longest velocity in each tile of a frame (TileMax of McGuire et al. 2012), for motion_blur.comp.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/motion_blur.glsl"

layout(set = 0, binding = kFilterTileVelocities, std430) writeonly buffer TileBlock { vec2 tile_velocities[]; };

shared vec2 velocities[kWorkgroupSize];

void main() {
  ivec2 pixel = lane_pixel();
  velocities[gl_LocalInvocationID.x] = in_picture(pixel) ? velocity_of(pixel_index(pixel)) : vec2(0.0);
  barrier();
  if (gl_LocalInvocationID.x != 0u) return;
  vec2 longest = vec2(0.0);
  for (uint i = 0u; i < kWorkgroupSize; ++i)
    if (pixels_passed(velocities[i]) > pixels_passed(longest)) longest = velocities[i];
  tile_velocities[gl_WorkGroupID.x + band.first_tile] = longest;
}
