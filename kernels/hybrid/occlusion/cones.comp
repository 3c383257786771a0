// Occlusion by cones through surface voxels (Crassin, Neyret, Sainz, Green and Eisemann 2011).
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/occlusion/screen.glsl"
#include "kernels/hybrid/occlusion/hemisphere_cone.glsl"

const float kWidest = 0.25; // wider voxels leak: see docs/occlusion.md

void main() {
  Receiver receiver;
  if (!find_receiver(receiver)) return;
  SurfaceGrid grid = fetch_surface_grid();
  float sum = 0.0;
  for (uint i = 0u; i < hybrid.ao_samples; ++i) {
    Sampler cone_sampler = occlusion_sampler(receiver.index, i);
    Cone cone = hemisphere_cone(grid, receiver, cone_sampler, hybrid.ao_radius, kWidest);
    sum += unblocked(grid, cone, cone_shift(cone_sampler, cone.direction), kConeSteps);
  }
  signals[receiver.index].w = sum / float(hybrid.ao_samples);
}
