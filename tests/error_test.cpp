// The error that a render reports for itself: against exact answers and converged references, over many seeds. And that
// neither stopping at a target nor adaptive sampling moves the mean.
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "host/film/error.h"
#include "host/film/film.h"
#include "host/picture/metrics/metrics.h"
#include "host/render/depth_cut.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/scene/gltf/gltf.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"
#include "kernels/base/error_probes.h"
#include "kernels/base/tile_order.h"
#include "tests/coverage.h"
#include "tests/probe.h"
#include "tests/statistics.h"

namespace wavepath::test {
namespace {

const std::string kScenes = std::string(WAVEPATH_SOURCE_DIR) + "/scenes/";

// A scene that stays packed, and the kernels for it, for many renders.
class Subject {
public:
  Subject(Device& device, const std::string& name, RenderPlan settings, float environment = 0.0f)
      : settings_(settings), device_(device), kernels_(device) {
    Scene scene = load_gltf(kScenes + name, {});
    if (environment > 0.0f) scene.environment.radiance = glm::vec3(environment);
    // A square from the middle of the view: the four balls of the furnaces, side by side, would have few pixels each.
    ViewRequest square;
    if (!scene.cameras[0].orthographic) square.yfov = scene.cameras[0].yfov;
    view_ = resolve_view(scene, square, settings.width, settings.height);
    packed_ = pack(scene, {.direct = settings.direct});
  }
  RenderResult render(std::uint32_t seed, std::uint32_t spp = 0) {
    RenderPlan settings = settings_;
    settings.seed = seed;
    if (spp > 0) settings.last_sample = spp;
    return wavepath::render(device_, packed_, view_, settings, RenderHooks{}, kernels_);
  }
  RenderPlan settings_;

private:
  Device& device_;
  PackedScene packed_;
  View view_;
  KernelCompiler kernels_;
};

RenderPlan small(std::uint32_t side, std::uint32_t spp) {
  RenderPlan settings;
  settings.width = settings.height = side;
  settings.last_sample = spp;
  settings.max_depth = 4;
  settings.filter = gpu::kFilterBox;
  return settings;
}

// The corner of three planes under a white sky: every pixel is exactly 1/4, and a sample drawn by cosine is 0 or 1.
RenderPlan corner(std::uint32_t side, std::uint32_t spp) {
  RenderPlan settings = small(side, spp);
  settings.max_depth = 1;
  settings.direct = gpu::kDirectBsdf;
  settings.sampler = gpu::kSamplerIndependent;
  return settings;
}
constexpr double kCorner = 0.25, kBernoulli = kCorner * (1.0 - kCorner);

double mean_of(const std::vector<float>& values) {
  double sum = 0.0;
  for (const float value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

// The Cornell box as every test of this program compares with: another seed, and a 64th of the error of the most
// samples that any of them takes. By the default sampler, whichever the test is of, since all converge to the same
// picture.
constexpr std::uint32_t kCornellSide = 48, kCornellSamples = 64 * 64, kReferenceSeed = 1000000;
const Picture& cornell_reference(Device& device) {
  static const Picture reference =
      Subject(device, "cornell_box.gltf", small(kCornellSide, kCornellSamples)).render(kReferenceSeed).picture;
  return reference;
}

class ErrorTest : public VulkanTest {};

TEST_F(ErrorTest, OfAKnownVarianceIsReportedAsItIs) {
  constexpr std::uint32_t kSide = 16, kSamples = 64, kRuns = 32;
  Subject subject(device(), "analytic/occlusion_in_corner.gltf", corner(kSide, kSamples), 1.0f);
  double mse = 0.0, estimate = 0.0;
  for (std::uint32_t seed = 0; seed < kRuns; ++seed) {
    const RenderResult result = subject.render(seed);
    for (std::size_t i = 0; i < kSide * kSide; ++i) {
      const double off = result.picture.channels[0].values[i] - kCorner;
      mse += off * off;
      estimate += mean_variance(*result.film, i).x;
    }
  }
  const double n = double{kSide} * kSide * kRuns, exact = kBernoulli / kSamples;
  // Both are means of n squares of nearly normal numbers, whose standard deviation is sqrt(2) times their mean.
  EXPECT_NEAR(mse / n, exact, 3.0 * exact * std::sqrt(2.0 / n));
  EXPECT_NEAR(estimate / n, exact, 3.0 * exact * std::sqrt(2.0 / n));
}

struct Case {
  const char* scene;
  std::uint32_t sampler;
  float environment;
  // Of the estimate over the truth. Samples of the whole picture are spread better than those of each of its
  // replicates, by which smooth pictures have less error than their replicates tell.
  double ratio = 1.0;
};

// Renders with 100 seeds: intervals hold the true error, and are no wider than they must be.
void expect_coverage(Subject& subject, const Picture& reference, double expected_ratio) {
  constexpr std::uint32_t kRuns = 100;
  const auto& [covered, ratio, half_width] =
      measure_coverage(reference, kRuns, [&](std::uint32_t seed) { return subject.render(seed); });
  const double scatter = ratio.error() * std::sqrt(double{kRuns}); // of a single estimate
  EXPECT_GE(covered, 90u);
  EXPECT_NEAR(ratio.mean(), 1.0, 0.05) << "its own noise is " << ratio.error();
  EXPECT_NEAR(ratio.mean(), expected_ratio, 0.03) << "half of what 12 % of the squared error would change it by";
  // No wider than it must be: the scatter of single estimates, and half of the 5 % by which a scene's weights may leave
  // the squared error wrong (error.cpp), for 95 %; the factor is for scenes whose error depends on few pixels.
  EXPECT_LT(half_width.mean(), 1.4 * 1.96 * std::hypot(scatter, 0.025));
  ::testing::Test::RecordProperty("covered", static_cast<int>(covered));
  ::testing::Test::RecordProperty("estimate_over_truth", std::to_string(ratio.mean()));
  ::testing::Test::RecordProperty("half_width", std::to_string(half_width.mean()));
}

class Coverage : public VulkanTest, public ::testing::WithParamInterface<Case> {};

TEST_P(Coverage, TheIntervalHoldsTheTrueError) {
  const Case& c = GetParam();
  // A twelfth of the error is left in the reference. The error of smaller pictures depends on single pixels: at 24x24 a
  // pixel that the lamp's border crosses makes a third of the Cornell box's whole error, and is reported as such
  // (largest_sample_fraction).
  constexpr std::uint32_t kSide = kCornellSide, kSamples = 16, kReference = 128;
  RenderPlan settings = small(kSide, kSamples);
  settings.sampler = c.sampler;
  Subject subject(device(), c.scene, settings, c.environment);
  if (c.scene == std::string("cornell_box.gltf"))
    expect_coverage(subject, cornell_reference(device()), c.ratio);
  else
    expect_coverage(subject, subject.render(kReferenceSeed, kSamples * kReference).picture, c.ratio);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Coverage,
                         ::testing::Values(Case{"cornell_box.gltf", gpu::kSamplerSobol, 0.0f},
                                           Case{"cornell_box.gltf", gpu::kSamplerIndependent, 0.0f},
                                           Case{"cornell_box.gltf", gpu::kSamplerStratified, 0.0f},
                                           Case{"showcase.glb", gpu::kSamplerSobol, 1.0f, 1.04},
                                           Case{"furnace_metal.gltf", gpu::kSamplerSobol, 1.0f, 1.04},
                                           Case{"analytic/lights_of_all_sizes.gltf", gpu::kSamplerSobol, 0.0f},
                                           Case{"analytic/occlusion_by_wall.gltf", gpu::kSamplerSobol, 1.0f, 1.04}),
                         [](const auto& test) {
                           std::string name = std::to_string(test.index) + "_" + test.param.scene;
                           std::replace_if(
                               name.begin(), name.end(), [](char x) { return !std::isalnum(x); }, '_');
                           return name;
                         });

// Where one pixel measures the error of its block.
struct SampledCase {
  Case subject;
  std::uint32_t samples, side;
};
class ErrorProbesCoverage : public VulkanTest, public ::testing::WithParamInterface<SampledCase> {};

TEST_P(ErrorProbesCoverage, TheIntervalHoldsTheTrueError) {
  const Case& c = GetParam().subject;
  // 1024 or 576 probes, a quarter or a seventh of what pictures have that are large enough for probes by default.
  constexpr std::uint32_t kReference = 64;
  RenderPlan settings = small(GetParam().side, GetParam().samples);
  settings.sampler = c.sampler;
  settings.probes_from = 0;
  Subject subject(device(), c.scene, settings, c.environment);
  const Picture reference = subject.render(1000000, GetParam().samples * kReference).picture;
  expect_coverage(subject, reference, c.ratio);
}

INSTANTIATE_TEST_SUITE_P(Scenes, ErrorProbesCoverage,
                         ::testing::Values(SampledCase{{"cornell_box.gltf", gpu::kSamplerSobol, 0.0f}, 8, 128},
                                           SampledCase{
                                               {"analytic/occlusion_by_wall.gltf", gpu::kSamplerSobol, 1.0f}, 16, 96}));

TEST_F(ErrorTest, StoppingAtATargetDoesNotMoveTheMean) {
  constexpr std::uint32_t kSide = 8, kRuns = 256;
  RenderPlan settings = corner(kSide, 4096);
  settings.target_error = 0.15; // relative to sqrt(0.25^2 + 0.01): near 100 samples a pixel
  Subject subject(device(), "analytic/occlusion_in_corner.gltf", settings, 1.0f);
  double sum = 0.0, variance = 0.0;
  std::uint32_t fewest = 4096, most = 0;
  for (std::uint32_t seed = 0; seed < kRuns; ++seed) {
    const RenderResult result = subject.render(seed);
    ASSERT_EQ(result.stop, StopReason::target_error);
    ASSERT_LE(result.error.relative_rms, settings.target_error);
    sum += mean_of(result.picture.channels[0].values);
    variance += kBernoulli / (1.0 * result.spp * kSide * kSide);
    fewest = std::min(fewest, result.spp), most = std::max(most, result.spp);
  }
  EXPECT_LT(fewest, most) << "all renders stopped at once, so nothing was checked";
  EXPECT_NEAR(sum / kRuns, kCorner, 3.0 * std::sqrt(variance) / kRuns);
}

TEST_F(ErrorTest, StopsBetweenPowersOfTwo) {
  RenderPlan settings = small(32, 4096);
  settings.target_error = 0.08;
  Subject subject(device(), "cornell_box.gltf", settings);
  const RenderResult result = subject.render(0);
  ASSERT_EQ(result.stop, StopReason::target_error);
  EXPECT_LE(result.error.relative_rms, 0.08);
  EXPECT_GT(result.error.relative_rms, 0.08 * 0.9) << "rendered on although the target was reached";
  for (const Checkpoint& c : result.checkpoints)
    EXPECT_TRUE(c.spp == result.spp || (c.spp & (c.spp - 1)) == 0) << c.spp;
}

TEST_F(ErrorTest, AdaptiveSamplingKeepsTheMeanAndLowersTheError) {
  constexpr std::uint32_t kSide = kCornellSide, kSamples = 64, kRuns = 8;
  Subject even(device(), "cornell_box.gltf", small(kSide, kSamples));
  Subject adaptive(device(), "cornell_box.gltf", small(kSide, kSamples));
  adaptive.settings_.adaptive = kAdaptiveOn;
  const Picture& reference = cornell_reference(device());
  double even_error = 0.0, adaptive_error = 0.0;
  std::vector<double> differences;
  for (std::uint32_t seed = 0; seed < kRuns; ++seed) {
    const RenderResult a = adaptive.render(seed), e = even.render(seed + 100);
    EXPECT_LE(a.spp, kSamples);
    EXPECT_GT(a.spp, kSamples * 3 / 4);
    even_error += compare_pictures(e.picture, reference).relmse / kRuns;
    adaptive_error += compare_pictures(a.picture, reference).relmse / kRuns;
    EXPECT_NEAR(a.error.relative_rms, std::sqrt(compare_pictures(a.picture, reference).relmse),
                0.25 * a.error.relative_rms);
    differences.push_back(mean_of(a.picture.channels[1].values) - mean_of(reference.channels[1].values));
  }
  EXPECT_LT(adaptive_error, even_error);
  double mean = 0.0, squares = 0.0;
  for (const double d : differences) mean += d / kRuns;
  for (const double d : differences) squares += (d - mean) * (d - mean);
  constexpr double kStudent = 3.5; // 99 % of eight repetitions, two-sided
  EXPECT_LT(std::abs(mean), kStudent * std::sqrt(squares / (kRuns * (kRuns - 1))));
}

TEST_F(ErrorTest, AdaptiveRendersAreReproducible) {
  Subject subject(device(), "cornell_box.gltf", small(30, 16)); // borders cut the last runs short
  subject.settings_.adaptive = kAdaptiveOn;
  const Picture first = subject.render(5).picture;
  subject.settings_.wave_slots = 4096;
  EXPECT_EQ(first.channels[0].values, subject.render(5).picture.channels[0].values);
  EXPECT_NE(first.channels[0].values, subject.render(6).picture.channels[0].values);
}

// The pilots of two depths would choose other levels, and then the two pictures differ by noise.
TEST_F(ErrorTest, DepthCutIsMeasuredByTheSamePaths) {
  Scene scene = load_gltf(kScenes + "cornell_box.gltf", {});
  RenderPlan settings = small(48, 16);
  const View view = resolve_view(scene, {}, settings.width, settings.height);
  const PackedScene packed = pack(scene, {.direct = settings.direct});
  KernelCompiler kernels(device());
  SceneOnDevice on_device;
  const DepthCut even = measure_depth_cut(device(), packed, view, settings, kernels, on_device);
  settings.adaptive = kAdaptiveOn;
  const DepthCut adaptive = measure_depth_cut(device(), packed, view, settings, kernels, on_device);
  EXPECT_GT(even.fraction, 0.0);
  EXPECT_EQ(adaptive.fraction, even.fraction);
  EXPECT_EQ(adaptive.standard_error, even.standard_error);
}

// Red, green and blue alike.
void set_samples(gpu::FilmPixel& pixel, std::uint32_t count, double mean, double largest) {
  const auto units = static_cast<std::uint32_t>(std::lround(mean * count * 0x1p21));
  for (gpu::ExactSum* sum : {&pixel.red, &pixel.green, &pixel.blue}) sum->low[0] = units;
  pixel.tops = 5 | 5 << 8 | 5 << 16; // digits of which bit 0 of the lower one weighs 2^-21
  pixel.count = count;
  pixel.largest = static_cast<float>(3.0 * largest);
}

// Whether its pixel is one of the few that are measured or not, it shows.
TEST(ErrorProbesEstimate, AFireflyIsSeenWhereverItIs) {
  constexpr std::uint32_t kSide = 64, kCount = 16;
  constexpr double kMean = 0.5, kNoise = 0.01, kFirefly = 100.0, kWeight = 1.0 / (kMean * kMean + 0.01);
  Film film = make_film({.width = kSide, .height = kSide, .has_probes = true, .seed = 3});
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, kNoise);
  for (gpu::FilmPixel& pixel : film.pixels) set_samples(pixel, kCount, kMean + noise(random), 0.6);
  const double quiet = kNoise * kNoise * kWeight;
  const ErrorEstimate even = estimate_error(film);
  EXPECT_NEAR(even.relative_rms * even.relative_rms, quiet, 0.25 * quiet);
  EXPECT_LT(even.largest_sample_fraction, 0.1);

  const std::size_t block = 100, probed = probed_pixel(film, block), other = probed ^ 1;
  ASSERT_EQ(block_of(film, other), block);
  const double alone = std::pow(kFirefly / kCount, 2.0) * kWeight / (kSide * kSide); // added to the squared error
  const std::tuple<const char*, std::size_t, double> cases[] = {
      {"not measured", other, alone},
      {"first replicate", probed, 0.25 * alone},
      {"second replicate", kSide * kSide + block, 0.25 * alone}};
  for (const auto& [where, place, expected] : cases) {
    SCOPED_TRACE(where);
    Film poisoned = film;
    set_samples(poisoned.pixels[place], kCount, kMean + kFirefly / kCount, kFirefly);
    const ErrorEstimate error = estimate_error(poisoned);
    EXPECT_GT(error.ci95[1] * error.ci95[1], 0.95 * expected);
    EXPECT_LT(error.ci95[0] * error.ci95[0], expected);
    EXPECT_GT(error.largest_sample_fraction, 0.9);
  }
}

// All pixels 0.5, but for normal noise; all of a quad err alike, or each by itself.
Film noisy_film(const FilmShape& shape, bool alike) {
  constexpr std::uint32_t kCount = 16;
  constexpr double kMean = 0.5, kNoise = 0.01;
  Film film = make_film(shape);
  std::mt19937 random(shape.seed);
  std::normal_distribution<double> noise(0.0, kNoise);
  const auto pixels = static_cast<std::uint32_t>(shape.pixels());
  std::array<double, gpu::kReplicates> means{};
  const std::uint32_t each = shape.has_probes ? 1 : gpu::kReplicates;
  for (std::uint32_t place = 0; place < shape.entries(); ++place) {
    const glm::uvec2 at = gpu::pixel_in_tile_order(std::min(place, pixels - 1), shape.width, shape.height);
    const std::size_t entry = place < pixels ? std::size_t{at.y} * shape.width + at.x : place;
    if (!alike || gpu::rank_in_quad(place, pixels) == 0)
      for (double& mean : means) mean = kMean + noise(random);
    for (std::uint32_t replicate = 0; replicate < each; ++replicate)
      set_samples(film.pixels[each * entry + replicate], kCount, means[replicate], 0.51);
  }
  return film;
}

double true_error(const Film& film) {
  double sum = 0.0;
  for (std::size_t i = 0; i < film.shape().pixels(); ++i) {
    const double off = mean_radiance(film, i).x - 0.5;
    sum += off * off / (0.5 * 0.5 + 0.01);
  }
  return std::sqrt(sum / static_cast<double>(film.shape().pixels()));
}

// Of the squared error, without what weights are not known by (error.cpp), relative to it.
double scatter_of(const ErrorEstimate& error) {
  const double mean = error.relative_rms * error.relative_rms;
  const double spread = (error.ci95[1] * error.ci95[1] - mean) / (1.959964 * mean);
  return spread * spread - 0.05 * 0.05;
}

struct QuadCoverage {
  double covered = 0.0, covered_before = 0.0; // fraction of films; as if pixels erred independently
  Mean scatter, ratio;                        // ratio: of the squared error estimated and true
};
QuadCoverage coverage_of_quads(FilmShape shape, bool alike) {
  constexpr int kRuns = 400;
  QuadCoverage result;
  for (shape.seed = 0; shape.seed < kRuns; ++shape.seed) {
    Film film = noisy_film(shape, alike);
    const double truth = true_error(film);
    const auto holds = [&](const ErrorEstimate& error) { return truth >= error.ci95[0] && truth <= error.ci95[1]; };
    const ErrorEstimate error = estimate_error(film);
    result.covered += holds(error) / double{kRuns};
    result.scatter.add(scatter_of(error));
    result.ratio.add(std::pow(error.relative_rms / truth, 2.0));
    if (film.has_probes) continue; // the layout would be another
    film.quads = false;
    result.covered_before += holds(estimate_error(film)) / double{kRuns};
  }
  return result;
}

// Pixels that share light err alike, so that four tell as much as one.
TEST(QuadsEstimate, TheIntervalHoldsTheErrorOfPixelsThatErrAlike) {
  const FilmShape whole{.width = 64, .height = 61, .has_probes = true, .quads = true}; // 64 quads are probed
  const FilmShape halved{.width = 32, .height = 30, .quads = true};
  for (const FilmShape& shape : {whole, halved}) {
    SCOPED_TRACE(shape.has_probes ? "error probes" : "split replicates");
    const QuadCoverage alike = coverage_of_quads(shape, true), apart = coverage_of_quads(shape, false);
    EXPECT_NEAR(alike.covered, 0.95, 0.04);
    EXPECT_GE(apart.covered, 0.93) << "the weights' share is for scenes whose weights are not known";
    EXPECT_NEAR(alike.scatter.mean() / apart.scatter.mean(), 4.0, 0.5) << "not twice as wide";
    EXPECT_NEAR(alike.ratio.mean(), 1.0, 0.03);
    EXPECT_NEAR(apart.ratio.mean(), 1.0, 0.03);
    if (!shape.has_probes) {
      EXPECT_LT(alike.covered_before, 0.85);
    }
  }
}

// Where pixels err independently quads measure as much as single pixels do.
TEST(QuadsEstimate, IsThatOfSinglePixelsWhereTheyErrIndependently) {
  FilmShape shape{.width = 96, .height = 96};
  for (shape.seed = 0; shape.seed < 8; ++shape.seed) {
    Film film = noisy_film(shape, false);
    const ErrorEstimate single = estimate_error(film);
    film.quads = true;
    const ErrorEstimate quads = estimate_error(film);
    EXPECT_NEAR(quads.relative_rms, single.relative_rms, 1e-12 * single.relative_rms);
    EXPECT_NEAR(scatter_of(quads) / scatter_of(single), 1.0, 0.15);
  }
}

TEST(Slope, FollowsAPowerLaw) {
  std::vector<Checkpoint> points;
  for (std::uint32_t spp = 1; spp <= 64; spp *= 2) {
    Checkpoint c;
    c.spp = spp;
    c.seconds = 0.1 * spp;
    c.error.relative_rms = 0.3 * std::pow(spp, -0.7);
    points.push_back(c);
  }
  EXPECT_NEAR(fit_slope(points, Against::seconds), -0.7, 1e-9);
  EXPECT_NEAR(fit_slope(points, Against::spp), -0.7, 1e-9);
  EXPECT_NEAR(growth_for(2.0, -0.5), 4.0, 1e-9);
  EXPECT_TRUE(std::isinf(growth_for(2.0, 0.1)));
  EXPECT_EQ(fit_slope({}, Against::spp), -0.5);
}

} // namespace
} // namespace wavepath::test
