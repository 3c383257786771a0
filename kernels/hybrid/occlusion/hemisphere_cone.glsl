// Cones that share the hemisphere above a receiver evenly: cosine-weighted axes, and none so wide that it would see the
// surface that it starts from. Include screen.glsl first.
#ifndef WAVEPATH_HEMISPHERE_CONE_GLSL
#define WAVEPATH_HEMISPHERE_CONE_GLSL

#include "kernels/hybrid/voxels/cone.glsl"

const float kLowestAxis = 0.07; // sine of the elevation: cones near the surface would have to be rays
const uint kConeSteps = 250u; // of each of 256 cones: lavapipe ends loops after 65,535 rounds

// One of hybrid.ao_samples. `reach`: metres from the receiver. `widest`: the most that voxels are wide, over the
// distance: walls seem up to a voxel nearer and larger, and wide voxels leak.
Cone hemisphere_cone(SurfaceGrid grid, Receiver receiver, Sampler s, float reach, float widest) {
  vec3 normal = receiver.normal, tangent, bitangent;
  make_basis(normal, tangent, bitangent);
  float clearance = kClearance * l1_norm(normal);
  // Caps of 1 / n of the hemisphere: cos = 1 - 1 / n.
  float cosine = 1.0 - 1.0 / float(hybrid.ao_samples);
  float fair = min(2.0 * sqrt(1.0 - cosine * cosine) / max(cosine, 0.25), widest);
  vec3 local = warp_cosine_hemisphere(sample_2d(s, kDimensionOcclusion));
  local = normalize(vec3(local.xy, max(local.z, kLowestAxis)));
  Cone cone;
  cone.origin = receiver.position + clearance * grid.voxel * normal;
  cone.direction = normalize(to_world(local, tangent, bitangent, normal));
  cone.t_max = reach - clearance * grid.voxel * local.z;
  cone.widening = min(fair, local.z / clearance) / grid.voxel;
  cone.narrowing = kFar;
  return cone;
}

#endif
