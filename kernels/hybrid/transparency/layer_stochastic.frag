// The nearest layer that covers one of the samples of a pixel (Enderton et al. 2010). A layer covers as many of them as
// its opacity asks for, rounded at random, at an offset of its own in their ring: samples are stratified, and the
// masks of layers are independent of each other.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/transparency/layer_fragment.glsl"
#include "kernels/hybrid/frame_corner.glsl"

layout(location = 0) out uvec2 seen;

const uint kHashRounding = 64u, kHashOffset = 65u; // kinds of numbers that nothing else of a frame asks for

// Push constant: bounce = the sample, sample_count = how many there are.
bool covers_sample(Fragment f) {
  Sampler numbers = hybrid_sampler(f.pixel);
  float samples = float(wave.sample_count), covered = hit_opacity(f.hit, true) * samples;
  covered = floor(covered) + (hash_unit(numbers, kHashRounding, layer) < fract(covered) ? 1.0 : 0.0);
  float offset = floor(hash_unit(numbers, kHashOffset, layer) * samples);
  return mod(float(wave.bounce) + offset, samples) < covered;
}

void main() {
  Fragment f;
  if (!is_in_front(f) || !covers_sample(f)) discard;
  float z = clamp(clip_depth(f.depth), 0.0, 1.0);
  gl_FragDepth = z;
  seen = uvec2(layer, floatBitsToUint(z));
}
