// Samples of a vertex against the density that its evaluation claims, by chi-square, and the integral of that density.
#include "kernels/base/features.h"
#include "tests/bsdf_probe.h"

namespace wavepath::test {
namespace {

constexpr std::uint32_t kBins = 32; // along each axis of the region

// A cell of a region, and the direction and solid angle of a point in it. Inverse of region_position() of the probe.
struct Cell {
  std::uint32_t config, bin;
  double x, y, size; // lower corner in [0,1)^2
  double integral;   // of the density over it, from the cell that it is a quarter of
};

struct Frame {
  glm::dvec3 tangent, bitangent, axis;
};

Frame frame_of(const glm::dvec3& n) { // as make_basis
  const double s = n.z < 0.0 ? -1.0 : 1.0, a = -1.0 / (s + n.z), b = n.x * n.y * a;
  return {{1.0 + s * n.x * n.x * a, s * b, -s * n.x}, {b, s + n.y * n.y * a, -n.y}, n};
}

// Direction at a position in the region; returns the solid angle per area of the square.
double region_direction(const Config& c, const Frame& frame, double x, double y, glm::vec3& w) {
  if (c.window.w == 0.0f) {
    w = glm::vec3(direction(2.0 * x - 1.0, 2.0 * std::numbers::pi * y));
    return 4.0 * std::numbers::pi;
  }
  const double half = c.window.w, u = half * (2.0 * x - 1.0), v = half * (2.0 * y - 1.0);
  const double z = std::sqrt(std::max(1.0 - u * u - v * v, 1e-12));
  w = glm::vec3(u * frame.tangent + v * frame.bitangent + z * frame.axis);
  return 4.0 * half * half / z;
}

class ChiSquareTest : public VulkanTest {
protected:
  // Integral of the density over each cell, by 4x4 Gauss-Legendre on the device.
  std::vector<double> integrate(const std::vector<Config>& configs, const std::vector<Cell>& cells,
                                const DrawSettings& settings) {
    constexpr GaussLegendre4 rule;
    std::vector<Frame> frames;
    for (const Config& c : configs) frames.push_back(frame_of(glm::dvec3(c.window)));
    std::vector<Pair> pairs;
    std::vector<double> weights;
    for (const Cell& cell : cells) {
      const Config& c = configs[cell.config];
      for (std::size_t i = 0; i < 16; ++i) {
        const double x = cell.x + cell.size * rule.nodes[i % 4], y = cell.y + cell.size * rule.nodes[i / 4];
        glm::vec3 w;
        const double measure = region_direction(c, frames[cell.config], x, y, w);
        weights.push_back(measure * cell.size * cell.size * rule.weights[i % 4] * rule.weights[i / 4]);
        pairs.push_back({glm::vec3(c.wo), cell.config, glm::vec4(w, 0.0f)});
      }
    }
    const auto values = evaluate(device(), configs, pairs, settings.hemisphere, settings.features);
    std::vector<double> result(cells.size());
    for (std::size_t i = 0; i < values.size(); ++i) result[i / 16] += weights[i] * values[i].w;
    return result;
  }

  // Probability of every bin of every config, refined where a cell and its quarters disagree, or where samples fell.
  std::vector<double> probabilities(const std::vector<Config>& configs, const std::vector<std::uint32_t>& histogram,
                                    const DrawSettings& settings) {
    std::vector<double> result(histogram.size());
    std::vector<Cell> cells;
    for (std::uint32_t i = 0; i < histogram.size(); ++i) {
      const std::uint32_t bin = i % (kBins * kBins);
      const double size = 1.0 / kBins;
      cells.push_back({i / (kBins * kBins), i, (bin / kBins) * size, (bin % kBins) * size, size, 0.0});
    }
    const std::vector<double> first = integrate(configs, cells, settings);
    for (std::size_t i = 0; i < cells.size(); ++i) cells[i].integral = first[i];
    for (int level = 0; level < 9 && !cells.empty(); ++level) {
      std::vector<Cell> quarters;
      for (const Cell& cell : cells)
        for (int q = 0; q < 4; ++q)
          quarters.push_back({cell.config, cell.bin, cell.x + 0.5 * cell.size * (q & 1),
                              cell.y + 0.5 * cell.size * (q >> 1), 0.5 * cell.size, 0.0});
      const std::vector<double> finer = integrate(configs, quarters, settings);
      std::vector<Cell> next;
      for (std::size_t i = 0; i < cells.size(); ++i) {
        const double sum = finer[4 * i] + finer[4 * i + 1] + finer[4 * i + 2] + finer[4 * i + 3];
        const bool unseen = level < 2 && histogram[cells[i].bin] > 0 && sum < 1e-5; // a peak between the nodes
        if (level < 8 && (std::abs(sum - cells[i].integral) > 2e-7 || unseen)) {
          for (std::size_t q = 4 * i; q < 4 * i + 4; ++q) {
            quarters[q].integral = finer[q];
            next.push_back(quarters[q]);
          }
        } else {
          result[cells[i].bin] += sum;
        }
      }
      cells = std::move(next);
    }
    return result;
  }

  void check(const std::vector<Config>& configs, const DrawSettings& settings, double level, double slack = 1e-4) {
    const DrawResult draws = draw(device(), configs, settings);
    const std::vector<double> expected = probabilities(configs, draws.histogram, settings);
    for (std::size_t c = 0; c < configs.size(); ++c) {
      const Drawn& d = draws.drawn[c];
      std::vector<double> o, e;
      double total = 0.0, seen = 0.0;
      for (std::size_t i = c * kBins * kBins; i < (c + 1) * kBins * kBins; ++i) {
        o.push_back(draws.histogram[i]);
        e.push_back(expected[i] * d.count);
        total += expected[i];
        seen += draws.histogram[i];
      }
      // What is in no bin: delta lobes, absorbed, and outside of a window.
      EXPECT_LE(total, 1.0 + slack) << c;
      if (configs[c].window.w == 0.0f) {
        // Rounding may put a direction at the pole or on the seam of the azimuth outside of [0,1)^2. Its chance is some
        // 2^-24 a sample, 0.02 over all samples of a config, so that more than a few are lost for another reason.
        const double lost = (1.0 - d.delta - d.rejected) * d.count - seen;
        EXPECT_GT(lost, -0.5) << c;
        EXPECT_LT(lost, 4.5) << c;
      }
      o.push_back(d.count - seen);
      e.push_back(std::max(1.0 - total, 0.0) * d.count);
      const ChiSquare result = chi_square(o, e);
      EXPECT_GT(result.p_value, level) << "config " << c << ": " << result.statistic << " over " << result.degrees
                                       << ", alpha " << configs[c].alpha << " ior " << configs[c].ior << " cos "
                                       << configs[c].wo.z << " density " << total << " seen " << seen / d.count;
    }
  }
};

std::vector<Config> seen_from(const std::vector<Config>& materials, std::initializer_list<double> cosines) {
  std::vector<Config> configs;
  for (const Config& material : materials)
    for (const double cosine : cosines) {
      configs.push_back(material);
      configs.back().wo = direction(cosine);
    }
  return configs;
}

std::vector<Config> materials() {
  std::vector<Config> m{{.specular = 0.0f},
                        {.metallic = 1.0f, .alpha = 0.1f},
                        {.base_color = {.9f, .5f, .1f}, .metallic = 1.0f, .alpha = 0.5f},
                        {.metallic = 1.0f, .alpha = 1.0f},
                        {.base_color = {.8f, .5f, .2f}, .alpha = 0.0f},
                        {.base_color = {.8f, .5f, .2f}, .alpha = 0.1f},
                        {.base_color = glm::vec3(.2f), .alpha = 0.5f, .ior = 2.4f}};
  for (const std::uint32_t flags : {kEntering, 0u, kThin}) {
    m.push_back({.alpha = 0.1f, .transmission = 1.0f, .flags = flags});
    m.push_back({.alpha = 0.6f, .transmission = 1.0f, .ior = 1.3f, .flags = flags});
    m.push_back({.metallic = 0.3f,
                 .specular_color = {0.2f, 1.0f, 3.0f},
                 .specular = 0.8f,
                 .alpha = 0.3f,
                 .transmission = 0.6f,
                 .ior = 1.7f,
                 .flags = flags});
  }
  return m;
}

const DrawSettings kDraws{
    .seed = 17, .batches = 512, .batch_size = 512, .bins = kBins, .sampler = gpu::kSamplerIndependent};

TEST_F(ChiSquareTest, SamplesFollowTheDensity) {
  const auto configs = seen_from(materials(), {0.99, 0.6, 0.2, 0.03});
  const double level = sidak(0.01, int(configs.size()));
  for (std::size_t first = 0; first < configs.size(); first += 8)
    check({configs.begin() + long(first), configs.begin() + long(std::min(first + 8, configs.size()))}, kDraws, level);
}

TEST_F(ChiSquareTest, UniformHemisphereToo) {
  DrawSettings settings = kDraws;
  settings.hemisphere = gpu::kHemisphereUniform;
  const auto configs = seen_from({{.specular = 0.0f}, {.alpha = 0.3f}}, {0.9, 0.3});
  check(configs, settings, sidak(0.01, int(configs.size())));
}

// What a material has beyond metallic-roughness.
TEST_F(ChiSquareTest, LayersToo) {
  DrawSettings settings = kDraws;
  settings.features = gpu::kFeaturesAll | gpu::kLobesAll;
  std::vector<Config> layered{
      {.alpha = 0.3f, .coat_normal = glm::normalize(glm::vec3(0.1f, 0.2f, 1.0f)), .coat = 1.0f, .coat_alpha = 0.1f},
      {.metallic = 1.0f, .alpha = 0.5f, .coat = 0.8f, .coat_alpha = 0.0f},
      {.base_color = glm::vec3(.5f), .alpha = 0.5f, .sheen_color = glm::vec3(1.0f), .sheen_roughness = 0.5f},
      {.metallic = 1.0f, .alpha = 0.1f, .stretched_alpha = {0.5f, 0.1f}},
      {.alpha = 0.3f, .film = 1.0f},
      {.alpha = 0.5f, .diffuse_through = {.5f, .9f, .2f}, .diffuse_transmission = 0.4f},
      {.metallic = 1.0f, .alpha = 1.0f}};
  for (const std::uint32_t flags : {kEntering, 0u, kThin})
    layered.push_back({.alpha = 0.7f, .transmission = 1.0f, .flags = flags});
  const auto configs = seen_from(layered, {0.4});
  const double level = sidak(0.01, int(configs.size()));
  for (std::size_t first = 0; first < configs.size(); first += 10)
    check({configs.begin() + long(first), configs.begin() + long(std::min(first + 10, configs.size()))}, settings,
          level);
}

// Facet, smooth normal and normal map each tilted its own way from the others.
TEST_F(ChiSquareTest, BentNormalsToo) {
  DrawSettings settings = kDraws;
  settings.features = gpu::kFeaturesAll | gpu::kLobesAll;
  settings.batches = 128;
  const auto tilted = [](double radians, double azimuth) { return glm::vec3(direction(std::cos(radians), azimuth)); };
  struct Lie {
    glm::vec3 plane, facet;
  };
  const Lie map_alone{tilted(0.6, 0.0), tilted(0.6, 0.0)}, leans_back{tilted(0.5, 4.0), tilted(0.0, 0.0)},
      anyhow{tilted(0.9, 2.0), tilted(0.7, 3.0)}, below{tilted(1.8, 5.0), tilted(1.2, 4.4)};
  const Config matt{.specular = 0.0f}, gloss{.base_color = {.8f, .5f, .2f}, .alpha = 0.3f},
      glass{.alpha = 0.5f, .transmission = 1.0f, .flags = kEntering}, wall{.alpha = 0.4f, .transmission = 0.6f},
      paper{.alpha = 0.5f, .diffuse_through = {.5f, .9f, .2f}, .diffuse_transmission = 0.4f},
      coated{.alpha = 0.3f, .coat_normal = tilted(0.3, 1.0), .coat = 1.0f, .coat_alpha = 0.2f};
  std::vector<Config> configs;
  for (const auto& [material, lie] : {std::pair{matt, map_alone},
                                      {matt, leans_back},
                                      {matt, anyhow},
                                      {matt, below},
                                      {gloss, map_alone},
                                      {gloss, anyhow},
                                      {glass, leans_back},
                                      {glass, below},
                                      {wall, anyhow},
                                      {paper, leans_back},
                                      {coated, leans_back}}) {
    configs.push_back(material);
    configs.back().bent = 1;
    configs.back().plane = lie.plane;
    configs.back().facet = glm::vec4(lie.facet, 0.0f);
    configs.back().wo = direction(0.5, 3.6);
  }
  // Densities that end at a plane take cells as small as they get.
  check(configs, settings, sidak(0.01, int(configs.size())), 5e-4);
}

// Lobes far narrower than a bin of the sphere, under a magnifying window around their centre.
TEST_F(ChiSquareTest, NarrowLobesToo) {
  std::vector<Config> configs;
  for (const float alpha : {0.002f, 0.02f}) {
    for (const double cosine : {0.95, 0.5}) {
      const glm::dvec3 wo(direction(cosine));
      Config mirror{.metallic = 1.0f, .alpha = alpha};
      mirror.wo = direction(cosine);
      mirror.window = glm::vec4(-wo.x, -wo.y, wo.z, 6.0 * alpha);
      configs.push_back(mirror);
      Config wall = mirror; // straight through
      wall.metallic = 0.0f;
      wall.transmission = 1.0f;
      wall.window = glm::vec4(-wo, 6.0 * alpha);
      configs.push_back(wall);
      Config glass = wall;
      glass.flags = kEntering;
      const double z = -std::sqrt(1.0 - (wo.x * wo.x + wo.y * wo.y) / (1.5 * 1.5));
      glass.window = glm::vec4(-wo.x / 1.5, -wo.y / 1.5, z, 3.0 * alpha);
      configs.push_back(glass);
    }
  }
  check(configs, kDraws, sidak(0.01, int(configs.size())));
}

} // namespace
} // namespace wavepath::test
