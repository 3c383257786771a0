// Occlusion as the fraction of a ball around the point that lies behind what the depth buffer shows (Mittring 2007,
// "Finding Next Gen: CryEngine 2"). The ball is whole: half of it lies in the surface itself, so that a plane is 0.5,
// and an edge that sticks out is brighter than the plane.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/occlusion/screen.glsl"

bool is_behind(Receiver receiver, vec3 position) {
  vec3 shown = shown_at(position);
  if (!(shown.z > 0.0) && !is_orthographic()) return false; // behind the eye
  float depth = depth_of(ivec2(floor(shown.xy)));
  // Surfaces farther away than the radius do not occlude; otherwise a body in front would darken everything that it
  // hides.
  return depth > 0.0 && depth < shown.z && abs(depth - receiver.depth) <= hybrid.ao_radius;
}

void main() {
  Receiver receiver;
  if (!find_receiver(receiver)) return;
  uint behind = 0u;
  for (uint i = 0u; i < hybrid.ao_samples; ++i) {
    Sampler point_sampler = occlusion_sampler(receiver.index, i);
    // The cube root makes points uniform in the ball.
    float distance_ = hybrid.ao_radius * pow(sample_2d(point_sampler, kDimensionOcclusionDistance).x, 1.0 / 3.0);
    vec3 direction = warp_uniform_sphere(sample_2d(point_sampler, kDimensionOcclusion));
    if (is_behind(receiver, receiver.position + distance_ * direction)) ++behind;
  }
  signals[receiver.index].w = 1.0 - float(behind) / float(hybrid.ao_samples);
}
