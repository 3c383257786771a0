// Ground-truth ambient occlusion (Jimenez, Wu, Pesce and Jarabo 2016, "Practical Real-Time Strategies for Accurate
// Indirect Occlusion"): the cosine-weighted visibility of slices through the direction to the eye, each between two
// horizons, whose integral is exact.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/occlusion/screen.glsl"

// From this fraction of the radius on what is seen counts less, down to nothing.
const float kFullReach = 0.8;

// Cosine of the angle between the direction to the eye and the horizon towards `direction`; at least `lowest`, that of
// the tangent plane.
float horizon_cosine(Receiver receiver, vec3 direction, float u, float lowest) {
  March march = march_of(receiver, direction);
  float horizon = lowest;
  for (uint step = 0u; step < march.steps; ++step) {
    vec3 offset;
    if (!surface_at(receiver, step_position(march, receiver, step, u), offset)) continue;
    float distance_ = length(offset);
    float weight = clamp((1.0 - distance_ / hybrid.ao_radius) / (1.0 - kFullReach), 0.0, 1.0);
    float cosine = mix(lowest, dot(offset, receiver.to_eye) / max(distance_, 1e-30), weight);
    // Section 4.4 of the paper: a background that is visible behind a thin body lowers the horizon that the body has
    // raised.
    horizon = cosine > horizon ? cosine : max(mix(horizon, cosine, hybrid.ao_thinness), lowest);
  }
  return horizon;
}

// The integral of cos(angle - normal) * |sin(angle)| from 0 to `angle`, without the term that does not depend on it.
float arc(float angle, float normal) { return 0.25 * (2.0 * angle * sin(normal) - cos(2.0 * angle - normal)); }

// Occlusion by a horizon on one side (1 or -1) of its slice: exactly 0 if it is the horizon of the tangent plane.
float taken(float side, float cosine, float lowest, float normal) {
  if (!(cosine > lowest)) return 0.0;
  return arc(normal + side * 0.5 * kPi, normal) - arc(side * acos_exact(cosine), normal);
}

void main() {
  Receiver receiver;
  if (!find_receiver(receiver)) return;
  vec3 tangent, bitangent;
  make_basis(receiver.to_eye, tangent, bitangent);
  float sum = 0.0;
  for (uint i = 0u; i < hybrid.ao_samples; ++i) {
    vec2 u = sample_2d(occlusion_sampler(receiver.index, i), kDimensionOcclusion);
    vec2 around = cos_sin_turns(0.5 * u.x);
    vec3 direction = around.x * tangent + around.y * bitangent;
    vec3 axis = cross(direction, receiver.to_eye);
    vec3 projected = receiver.normal - axis * dot(receiver.normal, axis); // onto the slice
    float weight = length(projected);
    float normal = atan2_exact(dot(projected, direction), max(dot(projected, receiver.to_eye), 0.0));
    float low = sin(normal); // cosine of the tangent plane's angle, of the side away from `direction`
    sum += weight * (taken(1.0, horizon_cosine(receiver, direction, u.y, -low), -low, normal) +
                     taken(-1.0, horizon_cosine(receiver, -direction, u.y, low), low, normal));
  }
  // The open part of all slices is 1 on average, but not of each one. 1 - occlusion is the same integral, without noise
  // where nothing is occluded. With few slices the difference may be below 0.
  signals[receiver.index].w = max(1.0 - sum / float(hybrid.ao_samples), 0.0);
}
