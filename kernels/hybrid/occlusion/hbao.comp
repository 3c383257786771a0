// Horizon-based occlusion (Bavoil, Sainz and Dimitrov 2008, "Image-space horizon-based ambient occlusion"): around the
// direction to the eye, how far what is seen rises above the tangent plane; 1 - r^2 of the distance in radii weighs it.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/occlusion/screen.glsl"

// Sine of the elevation of the tangent plane over the plane at right angles to the view, towards `direction`, lifted by
// the bias angle.
float sine_of_tangent(Receiver receiver, vec3 direction) {
  float facing = max(dot(receiver.normal, receiver.to_eye), 1e-4);
  float elevation = atan2_exact(-dot(receiver.normal, direction), facing) + hybrid.ao_bias;
  return sin(min(elevation, 0.5 * kPi));
}

// Occlusion of one direction: the integral of the cosine of the elevation from the tangent to the horizon, in pieces,
// each weighted by the distance of the surface that raised it.
float rise(Receiver receiver, vec3 direction, float u) {
  March march = march_of(receiver, direction);
  float horizon = sine_of_tangent(receiver, direction), sum = 0.0;
  for (uint step = 0u; step < march.steps; ++step) {
    vec3 offset;
    if (!surface_at(receiver, step_position(march, receiver, step, u), offset)) continue;
    float distance_ = length(offset);
    float sine = dot(offset, receiver.to_eye) / max(distance_, 1e-30);
    if (!(distance_ < hybrid.ao_radius) || !(sine > horizon)) continue;
    float fraction = distance_ / hybrid.ao_radius;
    sum += (1.0 - fraction * fraction) * (sine - horizon);
    horizon = sine;
  }
  return sum;
}

void main() {
  Receiver receiver;
  if (!find_receiver(receiver)) return;
  vec3 tangent, bitangent;
  make_basis(receiver.to_eye, tangent, bitangent);
  float sum = 0.0;
  for (uint i = 0u; i < hybrid.ao_samples; ++i) {
    vec2 u = sample_2d(occlusion_sampler(receiver.index, i), kDimensionOcclusion);
    vec2 around = cos_sin_turns(u.x);
    sum += rise(receiver, around.x * tangent + around.y * bitangent, u.y);
  }
  signals[receiver.index].w = max(1.0 - sum / float(hybrid.ao_samples), 0.0);
}
