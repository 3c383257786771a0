// Draws batches of directions with vertex_sample, histograms them, and sums up what the estimator would have done.
#version 460
#extension GL_GOOGLE_include_directive : require
#define LAYERED
#include "kernels/base/sampler.glsl"
#define BIND_TABLES 4
#include "tests/probes/bsdf_config.glsl"

layout(local_size_x = kWorkgroupSize) in;
layout(push_constant) uniform Push { uint invocations; };

struct Batch {
  vec3 weight;        // sum of weight * eta_scale over all samples
  float square;       // sum of squares of its luminance
  float delta;        // counts
  float rejected;
  float transmitted;
  float bad;          // non-finite, not unit length, on the wrong side, or negative
  float least;        // weight * eta_scale, largest and smallest component over the accepted samples
  float most;
  float mismatch;     // worst disagreement with value_of(), relative
  float farthest;     // from the mirror direction, over the accepted reflections
};
layout(set = 0, binding = 0, std430) readonly buffer Configs { Config configs[]; };
layout(set = 0, binding = 1, std430) readonly buffer Parameters {
  uint seed;
  uint batches;    // a config
  uint batch_size;
  uint bins;       // along each axis
};
layout(set = 0, binding = 2, std430) writeonly buffer Batches { Batch results[]; };
layout(set = 0, binding = 3, std430) buffer Histogram { uint histogram[]; };

bool is_sound(Vertex v, BsdfSample s, vec3 wi) {
  bool finite = is_finite(wi) && is_finite(s.weight) && is_finite(s.pdf) && is_finite(s.eta_scale);
  bool unit = abs(length(wi) - 1.0) < 1e-5;
  return finite && unit && is_on_viewers_side(v, wi) != s.transmitted && all(greaterThanEqual(s.weight, vec3(0.0)));
}

void take(inout Batch batch, Config c, Vertex v, BsdfSample s, vec3 wi) {
  vec3 weight = s.weight * s.eta_scale;
  batch.weight += weight;
  batch.square += luminance(weight) * luminance(weight);
  batch.least = min(batch.least, min(weight.x, min(weight.y, weight.z)));
  batch.most = max(batch.most, max_component(weight));
  if (!is_sound(v, s, wi)) batch.bad += 1.0;
  if (s.transmitted) batch.transmitted += 1.0;
  else batch.farthest = max(batch.farthest, length(wi - vec3(-c.wo.xy, c.wo.z)));
  if (s.pdf < 0.0) {
    batch.delta += 1.0;
    return;
  }
  float pdf;
  vec3 value = value_of(v, c.bent != 0u ? wi : s.wi, pdf); // s.wi, which was not rounded to unit length again
  vec3 difference = abs(s.weight * s.pdf - value);
  batch.mismatch = max(batch.mismatch, max_component(difference) / max(max_component(value), 1e-20));
  batch.mismatch = max(batch.mismatch, abs(pdf - s.pdf) / s.pdf);
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= invocations) return;
  uint index = i / batches;
  Config c = configs[index];
  Vertex v = vertex_of(c);
  Batch batch = Batch(vec3(0.0), 0.0, 0.0, 0.0, 0.0, 0.0, 1e30, 0.0, 0.0, 0.0);
  for (uint k = 0u; k < batch_size; ++k) {
    uint sample_index = (i % batches) * batch_size + k;
    Sampler sampler_ = make_sampler(seed, index, sample_index, batches * batch_size);
    BsdfSample s;
    vec2 position;
    vec3 wi;
    if (!vertex_sample(v, sample_2d(sampler_, 0u).x, sample_2d(sampler_, 1u), s, wi) || !sides_agree(v, s, wi)) {
      batch.rejected += 1.0;
    } else {
      take(batch, c, v, s, wi);
      if (s.pdf >= 0.0 && region_position(c, wi, position)) {
        uvec2 bin = min(uvec2(position * float(bins)), bins - 1u);
        atomicAdd(histogram[(index * bins + bin.x) * bins + bin.y], 1u);
      }
    }
  }
  results[i] = batch;
}
