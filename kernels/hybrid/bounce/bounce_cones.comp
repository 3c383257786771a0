// One diffuse bounce by cones through surface voxels (Crassin, Neyret, Sainz, Green and Eisemann 2011): the light that
// leaves voxels is composed front to back along cones above each first hit.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_SEEN
#define BIND_REFLECTIONS
#include "kernels/hybrid/occlusion/screen.glsl"
#include "kernels/path/bindings.glsl"
#include "kernels/hybrid/occlusion/hemisphere_cone.glsl"
#include "kernels/hybrid/bounce/voxel_light.glsl"

// With voxels as wide as those of occlusion, a wall beside a floor brings 19 % more light than it does, with these
// 10 %.
const float kWidest = 0.1;

// Light that comes along a cone. `steps`: the most voxels that it visits.
vec3 light_through(SurfaceGrid grid, Cone cone, vec3 shift, uint steps) {
  ConeWalk walk = begin_walk(grid, cone);
  uvec3 against = uvec3(lessThan(walk.direction, vec3(0.0)));
  vec3 light = vec3(0.0);
  float passed = 1.0;
  for (uint step = 0u; step < steps && passed > kNothing && step_cone(grid, shift, walk); ++step) {
    bool has_bits = walk.level_index == 0u;
    vec3 opacity = opacity_of(walk.level, has_bits, walk.voxel);
    if (opacity == vec3(0.0)) continue;
    if (has_bits) return light + passed * side_light(index_of_voxel(walk.level, walk.voxel), walk.direction);
    // Of what blocks the way, walls across an axis have a share by their opacity and how much of them is crossed.
    vec3 crossed = abs(walk.direction);
    vec3 met = axis_light(walk.level, false, walk.voxel, against) * crossed / max(dot(opacity, crossed), 1e-6);
    float passes = passing(opacity, walk.crossed_in, walk.crossed_out);
    light += passed * (1.0 - passes) * met;
    passed *= passes;
  }
  return light;
}

void main() {
  Receiver receiver;
  if (gl_GlobalInvocationID.x >= wave.pixel_count) return;
  vec3 sum = vec3(0.0);
  bool found = find_receiver(receiver);
  if (found) {
    SurfaceGrid grid = fetch_surface_grid();
    for (uint i = 0u; i < hybrid.ao_samples; ++i) {
      Sampler cone_sampler = occlusion_sampler(receiver.index, i);
      Cone cone = hemisphere_cone(grid, receiver, cone_sampler, kFar, kWidest);
      sum += light_through(grid, cone, cone_shift(cone_sampler, cone.direction), kConeSteps);
    }
    sum *= gbuffer[receiver.index].albedo * (seen[receiver.index].w / float(hybrid.ao_samples));
  }
  reflections[receiver.index] = vec4(sum, 0.0);
}
