// The BSDF probes from the host's side: materials in, sums and histograms of samples or values of pairs out.
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/probe.h"
#include "tests/statistics.h"

#include "host/scene/pack/albedo_tables.h"
#include "kernels/base/features.h"
#include "tests/probes/bsdf_eval_probe.spv.h"
#include "tests/probes/bsdf_sample_probe.spv.h"

namespace wavepath::test {

inline constexpr std::uint32_t kEntering = 1, kThin = 2;

// As struct Config in probes/bsdf_config.glsl. The default is glTF's default material, seen from outside.
struct Config {
  glm::vec3 base_color{1.0f};
  float metallic = 0.0f;
  glm::vec3 specular_color{1.0f};
  float specular = 1.0f;
  float alpha = 1.0f, transmission = 0.0f, ior = 1.5f;
  std::uint32_t flags = kEntering | kThin;
  glm::vec4 wo{0.0f, 0.0f, 1.0f, 0.0f};
  glm::vec3 sheen_color{0.0f};
  float sheen_roughness = 0.0f;
  glm::vec3 coat_normal{0.0f, 0.0f, 1.0f};
  float coat = 0.0f, coat_alpha = 0.0f;
  float film = 0.0f, film_ior = 1.3f, film_nanometres = 400.0f;
  glm::vec3 diffuse_through{1.0f};
  float diffuse_transmission = 0.0f;
  glm::vec2 stretched_alpha{0.0f}; // 0: alpha
  glm::vec2 pad{0.0f};
  glm::vec3 plane{0.0f, 0.0f, 1.0f};
  std::uint32_t bent = 0;
  glm::vec4 facet{0.0f, 0.0f, 1.0f, 0.0f};
  glm::vec4 window{0.0f};
};
static_assert(sizeof(Config) == 192);

// GGX, sheen, glass of this ior from outside and from inside: as probes/bsdf_config.glsl expects them.
inline ProbeBuffer albedo_tables(double glass_ior = 1.5) {
  std::vector<glm::vec4> all = ggx_albedo_table();
  for (const std::vector<glm::vec4>& table : {sheen_albedo_table(), glass_albedo_tables(glass_ior)})
    all.insert(all.end(), table.begin(), table.end());
  return to_probe(all);
}

// The specialization constants of probes.
inline std::array<std::uint32_t, gpu::kSpecCount> probe_constants(gpu::Feature features, std::uint32_t sampler,
                                                                  std::uint32_t hemisphere) {
  std::array<std::uint32_t, gpu::kSpecCount> constants{};
  constants[gpu::kSpecFeatures] = static_cast<std::uint32_t>(features);
  constants[gpu::kSpecLobes] = static_cast<std::uint32_t>(features >> 32);
  constants[gpu::kSpecStackSize] = 96;
  constants[gpu::kSpecSampler] = sampler;
  constants[gpu::kSpecDirect] = gpu::kDirectMis;
  constants[gpu::kSpecHemisphere] = hemisphere;
  return constants;
}

struct Pair {
  glm::vec3 wo;
  std::uint32_t config;
  glm::vec4 wi;
};

// Sums over the samples of one config; see Batch in probes/bsdf_sample_probe.comp. Means are per sample drawn.
struct Drawn {
  double count = 0.0;
  glm::dvec3 weight{0.0};                                // mean of f cos / pdf, radiance scaling undone: the albedo
  double weight_error = 0.0;                             // its standard error if the samples were independent
  double delta = 0.0, rejected = 0.0, transmitted = 0.0; // fractions
  double bad = 0.0;                                      // count
  double least = 1e30, most = 0.0;                       // weight component of accepted samples
  double mismatch = 0.0;                                 // with value_of()
  double farthest = 0.0;                                 // from the mirror direction
};

struct DrawSettings {
  std::uint32_t seed = 1;
  std::uint32_t batches = 64, batch_size = 256;
  std::uint32_t bins = 1;
  std::uint32_t sampler = gpu::kSamplerSobol; // low noise; chi-square needs independent
  std::uint32_t hemisphere = gpu::kHemisphereCosine;
  gpu::Feature features = gpu::kFeaturesAll;
  double glass_ior = 1.5; // of the albedo tables
};

struct DrawResult {
  std::vector<Drawn> drawn;             // one a config
  std::vector<std::uint32_t> histogram; // bins * bins a config; delta samples are not in it
  ProbeBuffer raw;
};

inline glm::vec4 direction(double cosine, double azimuth = 0.7) {
  const double sine = std::sqrt((1.0 - cosine) * (1.0 + cosine));
  return {sine * std::cos(azimuth), sine * std::sin(azimuth), cosine, 0.0};
}

inline DrawResult draw(Device& device, const std::vector<Config>& configs, const DrawSettings& s) {
  struct Batch {
    glm::vec3 weight;
    float square, delta, rejected, transmitted, bad, least, most, mismatch, farthest;
  };
  const std::uint32_t invocations = std::uint32_t(configs.size()) * s.batches;
  std::vector<ProbeBuffer> buffers{
      to_probe(configs), to_probe(std::vector<std::uint32_t>{s.seed, s.batches, s.batch_size, s.bins}),
      ProbeBuffer(invocations * sizeof(Batch)), ProbeBuffer(configs.size() * s.bins * s.bins * 4),
      s.features & gpu::kLobesAll ? albedo_tables(s.glass_ior) : ProbeBuffer(16)};
  const auto constants = probe_constants(s.features, s.sampler, s.hemisphere);
  run_probe(device, wavepath_bsdf_sample_probe_spv, invocations, buffers, constants);
  const auto batches = from_probe<Batch>(buffers[2]);
  DrawResult result{{}, from_probe<std::uint32_t>(buffers[3]), buffers[2]};
  for (std::size_t c = 0; c < configs.size(); ++c) {
    Drawn d;
    double square = 0.0;
    d.count = double(s.batches) * s.batch_size;
    for (std::size_t i = c * s.batches; i < (c + 1) * s.batches; ++i) {
      const Batch& b = batches[i];
      d.weight += glm::dvec3(b.weight) / d.count;
      square += b.square / d.count;
      d.delta += b.delta / d.count;
      d.rejected += b.rejected / d.count;
      d.transmitted += b.transmitted / d.count;
      d.bad += b.bad;
      d.least = std::min(d.least, double(b.least));
      d.most = std::max(d.most, double(b.most));
      d.mismatch = std::max(d.mismatch, double(b.mismatch));
      d.farthest = std::max(d.farthest, double(b.farthest));
    }
    const double mean = glm::dot(d.weight, glm::dvec3(0.2126, 0.7152, 0.0722));
    d.weight_error = std::sqrt(std::max(square - mean * mean, 0.0) / d.count);
    result.drawn.push_back(d);
  }
  return result;
}

// value_of() of every pair: value in xyz, pdf in w.
inline std::vector<glm::vec4> evaluate(Device& device, const std::vector<Config>& configs,
                                       const std::vector<Pair>& pairs,
                                       std::uint32_t hemisphere = gpu::kHemisphereCosine,
                                       gpu::Feature features = gpu::kFeaturesAll) {
  std::vector<ProbeBuffer> buffers{to_probe(configs), to_probe(pairs), ProbeBuffer(pairs.size() * sizeof(glm::vec4)),
                                   features & gpu::kLobesAll ? albedo_tables() : ProbeBuffer(16)};
  const auto constants = probe_constants(features, gpu::kSamplerSobol, hemisphere);
  run_probe(device, wavepath_bsdf_eval_probe_spv, std::uint32_t(pairs.size()), buffers, constants);
  return from_probe<glm::vec4>(buffers[2]);
}

} // namespace wavepath::test
