// The samplers and pixel filters on the device: range, stratification, independence, and how fast their errors fall.
#include <cmath>
#include <functional>
#include <set>

#include "tests/probe.h"
#include "tests/statistics.h"

#include "kernels/base/features.h"
#include "kernels/base/frame_types.h"
#include "tests/probes/filter_probe.spv.h"
#include "tests/probes/sampler_probe.spv.h"

namespace wavepath::test {
namespace {

constexpr std::uint32_t kAllSamplers[] = {gpu::kSamplerIndependent, gpu::kSamplerStratified, gpu::kSamplerSobol};

struct Block {
  std::uint32_t seed = 0, sample_total = 64;
  std::uint32_t first_pixel = 0, first_dimension = 0, dimension_count = 1, first_sample = 0, sample_count = 64;
  std::uint32_t mode = 0;
};

class SamplerTest : public VulkanTest {
protected:
  // Points in the order pixel, dimension, sample.
  std::vector<glm::vec2> points(std::uint32_t sampler, const Block& block, std::uint32_t pixels) {
    const std::uint32_t count = pixels * block.dimension_count * block.sample_count;
    std::vector<ProbeBuffer> buffers{to_probe(std::vector<Block>{block}), ProbeBuffer(count * sizeof(glm::vec2))};
    const std::array<std::uint32_t, 3> constants{gpu::kFeaturesAll, 96, sampler};
    run_probe(device(), wavepath_sampler_probe_spv, count, buffers, constants);
    return from_probe<glm::vec2>(buffers[1]);
  }
};

// Points of one replicate out of a range of samples.
std::vector<glm::vec2> replicate(const glm::vec2* samples, std::uint32_t count, std::uint32_t r) {
  std::vector<glm::vec2> result;
  for (std::uint32_t i = r; i < count; i += gpu::kReplicates) result.push_back(samples[i]);
  return result;
}

std::vector<double> histogram(const std::vector<glm::vec2>& points, int columns, int rows) {
  std::vector<double> counts(std::size_t(columns) * std::size_t(rows));
  for (const glm::vec2& p : points) counts[std::size_t(int(p.y * rows) * columns + int(p.x * columns))] += 1.0;
  return counts;
}

TEST_F(SamplerTest, EveryValueLiesInTheHalfOpenUnitInterval) {
  for (const std::uint32_t sampler : kAllSamplers) {
    for (const glm::vec2& p : points(sampler, {.seed = 7, .dimension_count = 64, .sample_count = 256}, 16)) {
      ASSERT_TRUE(p.x >= 0.0f && p.x < 1.0f && p.y >= 0.0f && p.y < 1.0f) << p.x << " " << p.y;
    }
  }
  // The conversion itself at the ends, where a rounded product would give 1.
  EXPECT_EQ(points(0, {.first_pixel = 0xffffffffu, .sample_count = 1, .mode = 2}, 1)[0].x, 1.0f - 0x1p-24f);
  EXPECT_EQ(points(0, {.first_pixel = 0xffffff00u, .sample_count = 1, .mode = 2}, 1)[0].x, 1.0f - 0x1p-24f);
  EXPECT_EQ(points(0, {.first_pixel = 0xffu, .sample_count = 1, .mode = 2}, 1)[0].x, 0.0f);
}

TEST_F(SamplerTest, ExtremeIndicesStayInRangeAndDiffer) {
  for (const std::uint32_t sampler : kAllSamplers) {
    for (const std::uint32_t first : {0x7fffffc0u, 0xffffff00u}) {
      const auto p = points(sampler, {.first_pixel = 0xfffffff0u, .first_sample = first, .sample_count = 128}, 8);
      std::set<std::pair<float, float>> distinct;
      for (const glm::vec2& q : p) {
        ASSERT_TRUE(q.x >= 0.0f && q.x < 1.0f && q.y >= 0.0f && q.y < 1.0f);
        distinct.insert({q.x, q.y});
      }
      EXPECT_GE(distinct.size(), p.size() - 1);
    }
  }
}

// A (0,2)-sequence: every block of 2^m points, starting anywhere at a multiple of 2^m, has exactly one point in each of
// the elementary intervals 2^-k x 2^-(m-k). Owen scrambling and the shuffle of the index keep that.
TEST_F(SamplerTest, SobolFillsElementaryIntervals) {
  constexpr std::uint32_t kLog = 9, kCount = gpu::kReplicates << kLog, kDimensions = 5;
  const auto all = points(gpu::kSamplerSobol, {.seed = 3, .dimension_count = kDimensions, .sample_count = kCount}, 4);
  for (std::uint32_t run = 0; run < 4 * kDimensions; ++run) {
    for (std::uint32_t r = 0; r < gpu::kReplicates; ++r) {
      const auto p = replicate(&all[run * kCount], kCount, r);
      for (std::uint32_t m = 0; m <= kLog; ++m) {
        for (std::size_t first = 0; first < p.size(); first += std::size_t{1} << m) {
          const std::vector<glm::vec2> block(p.begin() + long(first), p.begin() + long(first + (std::size_t{1} << m)));
          for (std::uint32_t k = 0; k <= m; ++k) {
            for (const double n : histogram(block, 1 << k, 1 << (m - k))) {
              ASSERT_EQ(n, 1.0) << "run " << run << " replicate " << r << " m " << m << " k " << k << " from " << first;
            }
          }
        }
      }
    }
  }
}

TEST_F(SamplerTest, StratifiedPutsOneSampleInEachCellForAnyCount) {
  for (const std::uint32_t n : {1u, 2u, 3u, 5u, 7u, 12u, 16u, 61u, 100u}) {
    const std::uint32_t total = n * gpu::kReplicates;
    const Block block{.seed = n, .sample_total = total, .dimension_count = 3, .sample_count = 2 * total};
    const auto all = points(gpu::kSamplerStratified, block, 8);
    const int columns = int(std::ceil(std::sqrt(double(n)))), rows = (int(n) + columns - 1) / columns;
    for (std::size_t run = 0; run < 24; ++run) {
      for (std::uint32_t r = 0; r < gpu::kReplicates; ++r) {
        const auto p = replicate(&all[run * 2 * total], 2 * total, r);
        for (std::size_t round = 0; round < 2; ++round) { // the second round is a render going on past its plan
          const auto first = p.begin() + long(round * n);
          for (const double count : histogram({first, first + n}, columns, rows)) ASSERT_LE(count, 1.0) << n;
        }
        EXPECT_NE(p[0], p[n]);
      }
    }
  }
}

// Whatever the sampler, one given sample of one given dimension is uniform over scrambles, that is over pixels and
// seeds.
TEST_F(SamplerTest, EachSampleIsUniformOverPixels) {
  const double level = sidak(0.01, 3 * 6 * 3);
  for (const std::uint32_t sampler : kAllSamplers) {
    for (const std::uint32_t sample : {0u, 1u, 2u, 9u, 13u, 200u}) {
      for (const std::uint32_t dimension : {0u, 1u, 33u}) {
        const Block block{
            .seed = 5, .sample_total = 14, .first_dimension = dimension, .first_sample = sample, .sample_count = 1};
        const auto result = chi_square_uniform(histogram(points(sampler, block, 1 << 16), 32, 32));
        EXPECT_GT(result.p_value, level) << "sampler " << sampler << " sample " << sample << " dimension " << dimension;
      }
    }
  }
}

// Joint uniformity of values that must not know of each other.
TEST_F(SamplerTest, PixelsDimensionsReplicatesAndSeedsAreIndependent) {
  constexpr std::uint32_t kPixels = 1 << 16;
  const double level = sidak(0.01, 3 * 5 * 2);
  for (const std::uint32_t sampler : kAllSamplers) {
    const Block block{.seed = 11, .dimension_count = 2, .sample_count = 2 * gpu::kReplicates};
    const auto p = points(sampler, block, kPixels);
    Block other = block;
    other.seed = 12;
    const auto q = points(sampler, other, kPixels);
    const auto at = [&](std::size_t pixel, std::size_t dimension, std::size_t sample) {
      return (pixel * 2 + dimension) * block.sample_count + sample;
    };
    const auto check = [&](const char* what, const std::function<glm::vec2(std::size_t, int)>& pair) {
      for (const int axis : {0, 1}) {
        std::vector<glm::vec2> joint;
        for (std::size_t i = 0; i + 1 < kPixels; ++i) joint.push_back(pair(i, axis));
        EXPECT_GT(chi_square_uniform(histogram(joint, 24, 24)).p_value, level) << what << ", sampler " << sampler;
      }
    };
    check("neighbouring pixels",
          [&](std::size_t i, int a) { return glm::vec2(p[at(i, 0, 0)][a], p[at(i + 1, 0, 0)][a]); });
    check("dimensions", [&](std::size_t i, int a) { return glm::vec2(p[at(i, 0, 0)][a], p[at(i, 1, 0)][a]); });
    check("replicates", [&](std::size_t i, int a) { return glm::vec2(p[at(i, 0, 0)][a], p[at(i, 0, 1)][a]); });
    check("seeds", [&](std::size_t i, int a) { return glm::vec2(p[at(i, 0, 0)][a], q[at(i, 0, 0)][a]); });
    check("second samples", [&](std::size_t i, int a) { // a later sample in another dimension: the shuffle decorrelates
      return glm::vec2(p[at(i, 0, 0)][a], p[at(i, 1, gpu::kReplicates)][a]);
    });
  }
}

TEST_F(SamplerTest, HashUnitIsUniformOverItsKeys) {
  const auto p = points(0, {.seed = 1, .dimension_count = 16, .sample_count = 16, .mode = 1}, 1024);
  std::vector<glm::vec2> pairs;
  for (std::size_t i = 0; i + 1 < p.size(); i += 2) pairs.emplace_back(p[i].x, p[i + 1].x);
  EXPECT_GT(chi_square_uniform(histogram(pairs, 32, 32)).p_value, 0.003);
  pairs.clear();
  for (std::size_t i = 0; i + 16 < p.size(); i += 32)
    for (std::size_t k = 0; k < 16; ++k) pairs.emplace_back(p[i + k].x, p[i + k + 16].x);
  EXPECT_GT(chi_square_uniform(histogram(pairs, 32, 32)).p_value, 0.003);
}

// ---- convergence ----------------------------------------------------------------------------------------------------

double smooth(const glm::vec2& p) { return std::exp(p.x) * (1.0 + p.y * p.y); }
double edge(const glm::vec2& p) { return p.x + 0.7 * p.y < 0.8 ? 1.0 : 0.0; }
const double kSmoothMean = (std::exp(1.0) - 1.0) * 4.0 / 3.0;
const double kEdgeMean = (0.8 + 0.1) / 2.0; // a trapezoid: x = 0.8 at y = 0, 0.1 at y = 1

class ConvergenceTest : public SamplerTest {
protected:
  // Slope of the mean squared error of one replicate over log-spaced sample counts.
  double slope(std::uint32_t sampler, double (*f)(const glm::vec2&), double mean) {
    constexpr std::uint32_t kTrials = 256;
    std::vector<double> counts, errors;
    for (std::uint32_t n = 16; n <= 1024; n *= 2) {
      const Block block{.seed = n, .sample_total = gpu::kReplicates * n, .sample_count = gpu::kReplicates * n};
      const auto all = points(sampler, block, kTrials);
      double squares = 0.0;
      for (std::uint32_t trial = 0; trial < kTrials; ++trial) {
        double sum = 0.0;
        for (const glm::vec2& p : replicate(&all[trial * block.sample_count], block.sample_count, 1)) sum += f(p);
        squares += (sum / n - mean) * (sum / n - mean);
      }
      counts.push_back(n);
      errors.push_back(squares / kTrials);
    }
    return log_slope(counts, errors);
  }
};

TEST_F(ConvergenceTest, OwenSobolConvergesAsTheoryHasIt) {
  EXPECT_LE(slope(gpu::kSamplerSobol, smooth, kSmoothMean), -2.5);
  EXPECT_NEAR(slope(gpu::kSamplerSobol, edge, kEdgeMean), -1.5, 0.15);
}
TEST_F(ConvergenceTest, StratifiedConvergesAsTheoryHasIt) {
  EXPECT_NEAR(slope(gpu::kSamplerStratified, smooth, kSmoothMean), -2.0, 0.2);
  EXPECT_NEAR(slope(gpu::kSamplerStratified, edge, kEdgeMean), -1.5, 0.15);
}
TEST_F(ConvergenceTest, IndependentConvergesAsTheoryHasIt) {
  EXPECT_NEAR(slope(gpu::kSamplerIndependent, smooth, kSmoothMean), -1.0, 0.1);
  EXPECT_NEAR(slope(gpu::kSamplerIndependent, edge, kEdgeMean), -1.0, 0.1);
}

// ---- pixel filters --------------------------------------------------------------------------------------------------

class FilterTest : public VulkanTest {
protected:
  std::vector<glm::vec2> offsets(std::uint32_t filter, const std::vector<glm::vec2>& u) {
    std::vector<ProbeBuffer> buffers{to_probe(u)};
    const std::array<std::uint32_t, 6> constants{gpu::kFeaturesAll, 96, 0, 0, 0, filter};
    run_probe(device(), wavepath_filter_probe_spv, std::uint32_t(u.size()), buffers, constants);
    return from_probe<glm::vec2>(buffers[0]);
  }
  // Every 2^24/n-th value that a sampler can give, and its mirror image on the other axis: quadrature without noise.
  static std::vector<glm::vec2> grid(int n) {
    const int step = (1 << 24) / n;
    std::vector<glm::vec2> u;
    for (int k = step / 2; k < 1 << 24; k += step)
      u.emplace_back(float(k) * 0x1p-24f, float((1 << 24) - 1 - k) * 0x1p-24f);
    return u;
  }
  static constexpr double kPi = 3.14159265358979323846;
  // Integral of the filter from -infinity to x, normalized.
  static double distribution(std::uint32_t filter, double x) {
    if (filter == gpu::kFilterBox) return std::clamp(x + 0.5, 0.0, 1.0);
    x = std::clamp(x, -1.5, 1.5);
    if (filter == gpu::kFilterGaussian)
      return 0.5 + 0.5 * std::erf(x / (0.5 * std::sqrt(2.0))) / std::erf(3.0 / std::sqrt(2.0));
    const double t = kPi * x / 1.5;
    const double sines = 0.48829 * std::sin(t) + 0.14128 * std::sin(2 * t) / 2 + 0.01168 * std::sin(3 * t) / 3;
    return 0.5 + 0.5 * (x / 1.5 + sines / (kPi * 0.35875));
  }
};

TEST_F(FilterTest, InverseIsMonotoneBoundedAndFollowsTheDistribution) {
  for (const std::uint32_t filter : {gpu::kFilterBox, gpu::kFilterGaussian, gpu::kFilterBlackmanHarris}) {
    const int n = 1 << 20;
    const auto x = offsets(filter, grid(n));
    const float radius = filter == gpu::kFilterBox ? 0.5f : 1.5f;
    double square = 0.0;
    for (int i = 0; i < n; ++i) {
      const float here = x[std::size_t(i)].x;
      ASSERT_LE(std::abs(here), radius);
      ASSERT_GE(here, x[std::size_t(std::max(i - 1, 0))].x - 1e-6f) << "filter " << filter << " at " << i;
      ASSERT_EQ(here, -x[std::size_t(i)].y);
      ASSERT_NEAR(distribution(filter, here), (i + 0.5) / n, 2e-5) << "filter " << filter << " at " << here;
      square += double(here) * here;
    }
    // Second moments: box 1/12; gaussian cut at 3 sigma .25 (1 - 6 phi(3) / erf(3/sqrt2)); the window by quadrature in
    // closed form.
    const double a0 = 0.35875, a1 = 0.48829, a2 = 0.14128, a3 = 0.01168;
    const double window = 1.5 * 1.5 * (1.0 / 3.0 + 2.0 / (kPi * kPi) * (-a1 + a2 / 4.0 - a3 / 9.0) / a0);
    const double gauss = 0.25 * (1.0 - 6.0 * std::exp(-4.5) / std::sqrt(2.0 * kPi) / std::erf(3.0 / std::sqrt(2.0)));
    const double expected = filter == gpu::kFilterBox ? 1.0 / 12.0 : filter == gpu::kFilterGaussian ? gauss : window;
    EXPECT_NEAR(square / n, expected, 1e-4 * expected) << "filter " << filter;
  }
}

TEST_F(FilterTest, SamplesPassChiSquare) {
  const int n = 1 << 20, bins = 120;
  std::vector<glm::vec2> u(n);
  std::uint64_t state = 1;
  const auto next = [&] {
    return float((state = state * 6364136223846793005u + 1442695040888963407u) >> 40) * 0x1p-24f;
  };
  for (glm::vec2& p : u) p.x = next(), p.y = next();
  for (const std::uint32_t filter : {gpu::kFilterBox, gpu::kFilterGaussian, gpu::kFilterBlackmanHarris}) {
    std::vector<double> observed(bins), expected(bins);
    for (const glm::vec2& p : offsets(filter, u))
      observed[std::size_t(std::min(bins - 1, int((p.x + 1.5f) / 3.0f * bins)))] += 1.0;
    for (int i = 0; i < bins; ++i) {
      const double lo = -1.5 + 3.0 * i / bins, hi = -1.5 + 3.0 * (i + 1) / bins;
      expected[std::size_t(i)] = n * (distribution(filter, hi) - distribution(filter, lo));
    }
    EXPECT_GT(chi_square(observed, expected).p_value, sidak(0.01, 3)) << "filter " << filter;
  }
}

} // namespace
} // namespace wavepath::test
