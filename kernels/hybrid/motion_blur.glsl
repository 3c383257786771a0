// Velocities of a frame's pixels, for the filter of motion blur.
#ifndef WAVEPATH_MOTION_BLUR_GLSL
#define WAVEPATH_MOTION_BLUR_GLSL

#include "kernels/hybrid/reproject.glsl"

layout(set = 0, binding = kFilterVelocities) uniform usamplerBuffer velocity_texels;

// Pixels that a surface enters on its way, one after the other along the longer axis.
float pixels_passed(vec2 velocity) { return max(abs(velocity.x), abs(velocity.y)); }

// Velocity in pixels, from the opening of the shutter to its close; kLongestBlur at most.
vec2 velocity_of(int index) {
  vec2 velocity = uintBitsToFloat(texelFetch(velocity_texels, index).xy);
  float passed = pixels_passed(velocity);
  return passed > kLongestBlur ? velocity * (kLongestBlur / passed) : velocity;
}

#endif
