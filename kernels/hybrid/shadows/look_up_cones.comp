// Answers the shadow rays of a frame by a cone from each point to the whole of its lamp, through surface voxels
// (Crassin, Neyret, Sainz, Green and Eisemann 2011). Points under whose horizon the lamp's middle lies have their rays
// traced.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_GEOMETRY
#define BIND_SURFACES
#define BIND_PATHS
#define BIND_RAYS
#define BIND_SHADOW_RAYS
#define BIND_QUEUES
#define BIND_SHADOW_LIGHTS
#include "kernels/hybrid/shadows/bindings.glsl"
#include "kernels/path/bindings.glsl"
#include "kernels/path/records.glsl"
#include "kernels/base/pixel.glsl"
#include "kernels/hybrid/shadows/answer.glsl"
#include "kernels/hybrid/voxels/cone.glsl"
#include "kernels/surface/surface.glsl"

layout(local_size_x = kWorkgroupSize) in;
layout(set = 0, binding = kBindConeLamps) uniform samplerBuffer cone_lamps;

const float kLowestLamp = 0.02;    // sine of the elevation of the lamp's middle
const float kLeastFacing = 0.05;   // cosine between a flat lamp's normal and the direction to it
// Width of voxels over that of the cone: shifted ones blur as a disc of twice their width does.
const float kVoxelsOfCone = 0.7;
const uint kShadowSteps = 8192u;   // a straight way through 1,024^3 voxels crosses fewer

void main() {
  uint index = gl_GlobalInvocationID.x;
  if (index >= queues.shadow_count[0]) return;
  ShadowRay ray = fetch_shadow_ray(index);
  uint source = texelFetch(shadow_lights, int(ray.light)).x;
  if (source == kNone) return;
  vec4 middle = texelFetch(cone_lamps, int(2u * source)), shape = texelFetch(cone_lamps, int(2u * source + 1u));
  Surface surface = fetch_surface(fetch_hit(ray.slot));
  vec3 normal = dot(surface.geometric_normal, ray.direction) < 0.0 ? -surface.geometric_normal
                                                                   : surface.geometric_normal;
  SurfaceGrid grid = fetch_surface_grid();
  float clearance = kClearance * l1_norm(normal);
  Cone cone;
  cone.origin = surface.position + clearance * grid.voxel * normal;
  bool distant = middle.w == 0.0;
  vec3 to_lamp = distant ? middle.xyz : middle.xyz - cone.origin;
  float distance_ = length(to_lamp);
  cone.direction = to_lamp / distance_;
  float elevation = dot(normal, cone.direction);
  if (!(elevation > kLowestLamp)) return;
  bool flat_ = dot(shape.xyz, shape.xyz) > 0.0;
  vec3 lamp_normal = flat_ ? shape.xyz : cone.direction;
  float facing = max(abs(dot(lamp_normal, cone.direction)), kLeastFacing);
  // As wide as the lamp, but seeing neither the surface that the cone starts from nor what lies behind the lamp.
  float lamp_clearance = kClearance * l1_norm(lamp_normal);
  float fair = distant ? 0.0 : kVoxelsOfCone * 2.0 * shape.w * sqrt(facing) / distance_;
  cone.widening = min(fair, elevation / clearance) / grid.voxel;
  cone.narrowing = distant ? kFar : facing / lamp_clearance / grid.voxel;
  cone.t_max = distant ? kFar : distance_ - lamp_clearance * grid.voxel / facing;
  vec3 shift = cone_shift(slot_sampler(ray.slot), cone.direction);
  answer_shadow_ray(index, ray, unblocked(grid, cone, shift, kShadowSteps));
}
