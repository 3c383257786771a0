// Occlusion by cones through surface voxels (Crassin, Neyret, Sainz, Green and Eisemann 2011): cosine-weighted axes,
// and cones that share the hemisphere evenly, but none so wide that it would see the surface that it starts from.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/occlusion/screen.glsl"
#include "kernels/hybrid/voxels/cone.glsl"

const float kLowestAxis = 0.07; // sine of the elevation: cones near the surface would have to be rays
// Width of voxels over the distance. Wider ones leak: see docs/occlusion.md.
const float kWidest = 0.25;
const uint kOcclusionSteps = 250u; // of each of 256 cones: lavapipe ends loops after 65,535 rounds

void main() {
  Receiver receiver;
  if (!find_receiver(receiver)) return;
  SurfaceGrid grid = fetch_surface_grid();
  vec3 normal = receiver.normal, tangent, bitangent;
  make_basis(normal, tangent, bitangent);
  float clearance = kClearance * l1_norm(normal);
  // Caps of 1 / n of the hemisphere: cos = 1 - 1 / n.
  float cosine = 1.0 - 1.0 / float(hybrid.ao_samples);
  float fair = min(2.0 * sqrt(1.0 - cosine * cosine) / max(cosine, 0.25), kWidest);
  float sum = 0.0;
  for (uint i = 0u; i < hybrid.ao_samples; ++i) {
    Sampler cone_sampler = occlusion_sampler(receiver.index, i);
    vec3 local = warp_cosine_hemisphere(sample_2d(cone_sampler, kDimensionOcclusion));
    local = normalize(vec3(local.xy, max(local.z, kLowestAxis)));
    Cone cone;
    cone.origin = receiver.position + clearance * grid.voxel * normal;
    cone.direction = normalize(to_world(local, tangent, bitangent, normal));
    cone.t_max = hybrid.ao_radius - clearance * grid.voxel * local.z;
    cone.widening = min(fair, local.z / clearance) / grid.voxel;
    cone.narrowing = kFar;
    sum += unblocked(grid, cone, cone_shift(cone_sampler, cone.direction), kOcclusionSteps);
  }
  signals[receiver.index].w = sum / float(hybrid.ao_samples);
}
