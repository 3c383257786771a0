// Adaptive renders: which runs of pixels get how many samples, that every replicate gets those of its pixel, that the
// mean stays and the error is told, and that auto is adaptive where that pays alone.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "host/film/film.h"
#include "host/plan/adaptive.h"
#include "host/render/loop/adaptive.h"
#include "host/render/loop/render_loop.h"
#include "host/render/loop/render_state.h"
#include "host/render/loop/segments.h"
#include "host/render/render.h"
#include "host/render/settings/adaptivity.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/render/workspace/workspace.h"
#include "host/scene/gltf/gltf.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"
#include "kernels/base/error_probes.h"
#include "kernels/base/tile_order.h"
#include "kernels/base/wave.h"
#include "tests/probe.h"
#include "tests/shared_kernels.h"

namespace wavepath::test {
namespace {

// ---- how samples are shared out -------------------------------------------------------------------------------------

// Of one sample in each replicate of a pixel, which differ by `apart(x, y)`.
template <class Apart>
Film pilot_of(std::uint32_t width, std::uint32_t height, Apart apart) {
  Film pilot = make_film({.width = width, .height = height});
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x)
      for (std::uint32_t r = 0; r < gpu::kReplicates; ++r) {
        gpu::FilmPixel& pixel = pilot.pixels[(y * width + x) * gpu::kReplicates + r];
        pixel.count = 1;
        pixel.red.low[0] = 1000 + apart(x, y) * r;
        pixel.tops = 5;
      }
  return pilot;
}

TEST(SampleDistribution, GiveNoisyRunsMoreAndKeepTheTotal) {
  const Film pilot = pilot_of(16, 16, [](auto x, auto y) { return x < 2 && y < 2 ? 60u : 10u; });
  const SampleDistribution distribution = distribute_samples(pilot, 64, 64); // one tile of 8x8 is noisy, at a corner
  ASSERT_EQ(distribution.levels.size(), 64u);
  EXPECT_EQ(std::ranges::max(distribution.levels), distribution.levels[0]);
  EXPECT_LE(std::ranges::count(distribution.levels, distribution.levels[0]), 4) << "itself and those beside it";
  EXPECT_LE(mean_factor(distribution.levels, 64 * 64), 1.0);
  EXPECT_GT(mean_factor(distribution.levels, 64 * 64), 0.5);
}

std::uint32_t hash(std::uint32_t x, std::uint32_t y) { return gpu::probe_hash(y * 4096 + x); }

// Where noise is even, what single pixels show of it is chance, and chance promises nothing.
TEST(SampleDistribution, PromiseNothingWhereNoiseIsEven) {
  const Film even = pilot_of(64, 48, [](auto x, auto y) { return hash(x, y) % 200; });
  EXPECT_GT(distribute_samples(even, 256, 192).cost, 0.97);
  const Film none = pilot_of(64, 48, [](auto, auto) { return 0u; });
  EXPECT_EQ(distribute_samples(none, 256, 192).cost, 1.0);
  const std::vector<std::int8_t> levels = distribute_samples(none, 256, 192).levels;
  EXPECT_EQ(std::ranges::count(levels, 0), std::ptrdiff_t{256 * 192 / kRunPixels});
}

// Half of the picture has a quarter of the noise: (1/2 + 1/8)^2 / (1/2 + 1/32) = 0.735 of the error at equal samples by
// any factors, 0.82 by powers of two that keep the total.
TEST(SampleDistribution, PromiseWhatUnequalNoiseGives) {
  const Film halves = pilot_of(64, 48, [](auto x, auto y) { return hash(x, y) % (x < 32 ? 200u : 50u); });
  EXPECT_NEAR(distribute_samples(halves, 256, 192).cost, 0.82, 0.04);
}

// A background without noise gives its samples away; but it took little of the time.
TEST(SampleDistribution, CountBackgroundsAsCheap) {
  const Film object = pilot_of(64, 48, [](auto x, auto y) { return x < 32 ? hash(x, y) % 200 : 0u; });
  const SampleDistribution distribution = distribute_samples(object, 256, 192);
  const double factor = mean_factor(distribution.levels, 256 * 192);
  EXPECT_NEAR(factor, 1.0, 0.15);
  EXPECT_GT(distribution.cost, 0.85) << "half the picture is free: counted as dear it would promise 0.5";
  EXPECT_LT(distribution.cost, 0.99);
}

TEST(SampleDistribution, ComeFromAPilotOfAFewPaths) {
  for (const std::uint64_t pixels : {std::uint64_t{1} << 14, std::uint64_t{1} << 15}) {
    const std::uint64_t part = noise_pilot_part(pixels);
    for (const std::uint32_t planned : {32u, 44u, 64u, 100u, 65536u}) {
      const std::uint32_t samples = noise_pilot_samples(planned, pixels);
      EXPECT_EQ(samples % gpu::kReplicates, 0u);
      EXPECT_GE(samples, kFewestPilotSamples);
      EXPECT_LE(samples, 32u);
      EXPECT_LE(samples * 32u, planned * part * part) << "more than a 32nd of the render";
    }
  }
  EXPECT_EQ(noise_pilot_samples(8, 1u << 15), kFewestPilotSamples);
}

// ---- who is adaptive ------------------------------------------------------------------------------------------------

TEST(Adaptivity, IsTriedWhereAPilotIsASmallPartOfTheRender) {
  RenderPlan settings;
  settings.integrator = find_integrator("path");
  settings.width = 256, settings.height = 128;
  const auto tried = [&](std::uint32_t spp) {
    settings.last_sample = spp;
    return may_pay_adaptive(settings);
  };
  EXPECT_TRUE(tried(32));
  EXPECT_FALSE(tried(28)) << "less than a second";
  EXPECT_FALSE(tried(66)) << "levels share out fours";
  settings.width = 255;
  EXPECT_FALSE(tried(256)) << "a small picture";
  settings.width = settings.height = 512;
  EXPECT_TRUE(tried(4));
  EXPECT_FALSE(tried(2));
  settings.time_limit = 10.0; // 1 million paths, which are 3.8 a pixel
  EXPECT_FALSE(tried(16)) << "the time ends it before";
  settings.time_limit = 11.0;
  EXPECT_TRUE(tried(16));
  settings.time_limit = 0.0;
  for (const std::uint32_t told : {kAdaptiveOn, kAdaptiveOff}) {
    settings.adaptive = told;
    EXPECT_FALSE(tried(64)) << "nothing to find out";
  }
  settings.adaptive = kAdaptiveAuto;
  settings.integrator = IntegratorSetting::automatic();
  EXPECT_TRUE(tried(64));
  for (const auto& [name, expected] : {std::pair{"whitted", true}, {"bidirectional", false}, {"hybrid", false}}) {
    settings.integrator = find_integrator(name);
    EXPECT_EQ(tried(64), expected) << name;
  }
}

TEST(Adaptivity, IsForThoseThatAskOrTry) {
  RenderPlan settings;
  settings.integrator = find_integrator("path");
  EXPECT_FALSE(is_adaptive(settings)) << "windows, studies and parts do not try";
  settings.looks_for_noise = true;
  EXPECT_TRUE(is_adaptive(settings));
  settings.adaptive = kAdaptiveOff;
  EXPECT_FALSE(is_adaptive(settings));
  settings.adaptive = kAdaptiveOn, settings.looks_for_noise = false;
  EXPECT_TRUE(is_adaptive(settings));
  settings.integrator = find_integrator("bidirectional");
  EXPECT_FALSE(is_adaptive(settings));
}

// ---- waves by levels ------------------------------------------------------------------------------------------------

// Slots and samples of places are told from each other, both ways: shade goes from slots, accumulate from places.
TEST(WaveByLevels, EverySlotIsASampleOfAnEntry) {
  for (const std::array<std::uint32_t, gpu::kLevels>& entries :
       {std::array<std::uint32_t, gpu::kLevels>{3, 1, 7, 64, 5, 2},
        {0, 0, 9, 0, 0, 0},
        {0, 5, 0, 0, 11, 0},
        {1, 0, 0, 0, 0, 130}}) {
    gpu::Wave wave{.first_sample = 8, .sample_count = 12};
    std::ranges::copy(entries, wave.level_entries);
    wave.pixel_count = std::accumulate(entries.begin(), entries.end(), 0u);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> worked_on;
    for (std::uint32_t slot = 0; slot < gpu::level_slots(wave); ++slot) {
      const gpu::WavePart part = gpu::part_of_slot(wave, slot);
      const std::uint32_t entry = gpu::local_entry(part, slot), sample = gpu::local_sample(part, slot);
      ++worked_on[{entry, part.first_sample + sample}];
      const gpu::WavePart same = gpu::part_of_entry(wave, entry);
      EXPECT_EQ(same.first_slot + entry - same.first_entry + sample * same.entries, slot);
      EXPECT_LT(sample, same.samples);
    }
    std::uint32_t entry = 0;
    std::size_t expected = 0;
    for (int level = kHighestLevel; level >= kLowestLevel; --level)
      for (const std::uint32_t end = entry + entries[kHighestLevel - level]; entry < end; ++entry)
        for (std::uint32_t sample = at_level(8, level); sample < at_level(20, level); ++sample, ++expected)
          EXPECT_EQ((worked_on[{entry, sample}]), 1)
              << "level " << level << ", place " << entry << ", sample " << sample;
    EXPECT_EQ(worked_on.size(), expected);
    EXPECT_EQ(gpu::level_slots(wave), expected);
  }
}

// What generate keeps of a slot has room where there are levels alone.
TEST(WaveByLevels, TakeSixteenBytesAPath) {
  RenderPlan settings;
  settings.integrator = find_integrator("path");
  settings.adaptive = kAdaptiveOff;
  const std::uint64_t even = settings.integrator->bytes_per_slot(0, settings);
  settings.adaptive = kAdaptiveOn;
  EXPECT_EQ(settings.integrator->bytes_per_slot(0, settings) - even, 16u);
}

// ---- renders --------------------------------------------------------------------------------------------------------

class AdaptiveRender : public VulkanTest {
protected:
  static RenderPlan settings_of(std::uint32_t width, std::uint32_t height, std::uint32_t spp) {
    RenderPlan settings;
    settings.integrator = find_integrator("path");
    settings.width = width, settings.height = height;
    settings.last_sample = spp;
    settings.max_depth = 3;
    settings.filter = gpu::kFilterBox;
    settings.probes_from = 0;
    settings.adaptive = kAdaptiveOn;
    return settings;
  }
  RenderResult render(const RenderPlan& settings, const RenderHooks& hooks = {}) {
    const View view = resolve_view(scene_, {}, settings.width, settings.height);
    return wavepath::render(device(), packed_, view, settings, hooks, shared_kernels(device()));
  }
  // The levels that a render of these settings takes.
  std::vector<std::int8_t> levels_of(const RenderPlan& settings) {
    std::vector<std::int8_t> levels;
    RenderHooks hooks;
    hooks.save = [&](const RenderState& state) { levels = state.levels; };
    render(settings, hooks);
    return levels;
  }

  Scene scene_ = load_gltf(std::string(WAVEPATH_SOURCE_DIR) + "/scenes/cornell_box.gltf", {});
  PackedScene packed_ = pack(scene_);
};

TEST_F(AdaptiveRender, GivesBothSplitReplicatesASample) {
  RenderPlan settings = settings_of(128, 96, 4);
  settings.aovs = {"variance"}; // splits samples between replicates
  const RenderResult result = render(settings);
  ASSERT_TRUE(result.noise && result.noise->used);
  EXPECT_TRUE(std::isfinite(result.error.relative_rms));
  EXPECT_EQ(std::ranges::min(levels_of(settings)), kLowestLevelOfSplitReplicates) << "the scene has quiet parts";
}

// Both replicates of a probed pixel have as many samples, whatever its neighbours in the block have: borders cut tiles,
// so that runs go across blocks.
TEST_F(AdaptiveRender, EveryReplicateHasTheSamplesOfItsPixel) {
  for (const char* integrator : {"path", "whitted"}) {
    SCOPED_TRACE(integrator);
    RenderPlan settings = settings_of(101, 67, 16);
    settings.integrator = find_integrator(integrator);
    const std::vector<std::int8_t> levels = levels_of(settings);
    ASSERT_EQ(levels.size(), (101u * 67 + 63) / 64);
    EXPECT_GE(std::ranges::max(levels), std::ranges::min(levels) + 2) << "hardly any levels to tell apart";
    const RenderResult result = render(settings);
    const Film& film = *result.film;
    ASSERT_TRUE(film.has_probes);
    for (std::uint32_t i = 0; i < 101 * 67; ++i) {
      const glm::uvec2 at = gpu::pixel_in_tile_order(i, 101, 67);
      const std::size_t pixel = std::size_t{at.y} * 101 + at.x;
      const std::uint32_t expected = at_level(16, levels[i / kRunPixels]);
      ASSERT_EQ(film.pixels[pixel].count, expected) << i;
      if (probed_pixel(film, block_of(film, pixel)) == pixel) {
        ASSERT_EQ(film.pixels[101 * 67 + block_of(film, pixel)].count, expected) << i;
      }
    }
    EXPECT_EQ(result.spp, static_cast<std::uint32_t>(std::lround(16 * mean_factor(levels, 101 * 67))));
    EXPECT_FALSE(result.even);
  }
}

// A replicate of a run is that of an even render of as many samples.
TEST_F(AdaptiveRender, ReplicatesAreThoseOfEvenRenders) {
  RenderPlan settings = settings_of(101, 67, 16);
  const std::vector<std::int8_t> levels = levels_of(settings);
  const Film film = *render(settings).film;
  std::size_t compared = 0;
  for (const int level : {kLowestLevel, -1, 0, 1}) {
    RenderPlan even = settings;
    even.adaptive = kAdaptiveOff;
    even.last_sample = at_level(16, level);
    const Film expected = *render(even).film;
    for (std::uint32_t i = 0; i < 101 * 67; ++i) {
      if (levels[i / kRunPixels] != level) continue;
      const glm::uvec2 at = gpu::pixel_in_tile_order(i, 101, 67);
      const std::size_t pixel = std::size_t{at.y} * 101 + at.x, block = block_of(film, pixel);
      ASSERT_TRUE(mean_radiance(film, pixel) == mean_radiance(expected, pixel)) << level << " " << i;
      if (probed_pixel(film, block) == pixel) { // probes among them
        ASSERT_TRUE(mean_variance(film, pixel) == mean_variance(expected, pixel)) << level << " " << i;
      }
      ++compared;
    }
  }
  EXPECT_GT(compared, 101u * 67 / 2);
}

// A pass of a small picture is one wave, whatever levels it has; waves of their own would cost each some milliseconds.
TEST_F(AdaptiveRender, LevelsShareWaves) {
  RenderPlan settings = settings_of(101, 67, 16);
  const std::vector<std::int8_t> levels = levels_of(settings);
  EXPECT_GE(std::set<std::int8_t>(levels.begin(), levels.end()).size(), 4u);
  const View view = resolve_view(scene_, {}, settings.width, settings.height);
  RenderLoop loop(device(), packed_, view, settings, shared_kernels(device()), {}, {.fixed_wave = 1u << 17});
  while (loop.step()) {
  }
  const RenderResult result = loop.finish();
  const auto accumulate = std::ranges::find(result.stages, "accumulate", &StageTime::name);
  ASSERT_NE(accumulate, result.stages.end());
  constexpr std::uint32_t kPilot = 1, kPasses = 3; // up to 4, 8 and 16 samples
  EXPECT_EQ(accumulate->dispatches, kPilot + kPasses);
}

TEST_F(AdaptiveRender, HowTheWorkIsCutUpDoesNotMatter) {
  RenderPlan settings = settings_of(101, 67, 24);
  const RenderResult expected = render(settings);
  for (const std::uint32_t slots : {500u, 3000u}) {
    settings.wave_slots = slots;
    EXPECT_TRUE(*render(settings).film == *expected.film) << slots << " slots";
  }
  settings.integrator = find_integrator("whitted"); // a sample of which takes several slots
  settings.wave_slots = 0;
  const RenderResult tree = render(settings);
  settings.wave_slots = 500;
  EXPECT_TRUE(*render(settings).film == *tree.film);
  settings.integrator = find_integrator("path");
  settings.wave_slots = 0;
  std::optional<RenderState> state;
  RenderHooks interrupt;
  interrupt.progress = [&](const Progress& now) { return now.spp_done < 12; };
  interrupt.save = [&](const RenderState& saved) { state = saved; };
  render(settings, interrupt);
  ASSERT_TRUE(state && state->cursor.sample > 0 && state->cursor.sample < 24);
  RenderHooks resume;
  resume.resume = &*state;
  EXPECT_TRUE(*render(settings, resume).film == *expected.film);
}

// The mean stays, the error falls, and what is told of it is what it is, also where one pixel measures its block.
TEST_F(AdaptiveRender, ErrorProbesTellTheirError) {
  constexpr std::uint32_t kRuns = 16;
  RenderPlan settings = settings_of(128, 128, 16), even = settings;
  even.adaptive = kAdaptiveOff;
  RenderPlan truth = even;
  truth.last_sample = 1024, truth.seed = 1000000;
  const Film reference = *render(truth).film;
  double told = 0.0, error = 0.0, even_error = 0.0;
  std::vector<double> differences;
  const auto error_of = [&](const Film& film, double& difference) {
    double sum = 0.0;
    difference = 0.0;
    for (std::size_t i = 0; i < reference.shape().pixels(); ++i) {
      const glm::dvec3 r = mean_radiance(reference, i), off = mean_radiance(film, i) - r,
                       squared = off * off / (r * r + 0.01);
      sum += (squared.x + squared.y + squared.z) / 3.0;
      difference += off.y;
    }
    return sum / static_cast<double>(reference.shape().pixels());
  };
  std::size_t held = 0;
  for (std::uint32_t seed = 0; seed < kRuns; ++seed) {
    settings.seed = seed, even.seed = seed + 1000;
    const RenderResult result = render(settings);
    double difference = 0.0, other = 0.0;
    const double own = error_of(*result.film, difference);
    error += own / kRuns, even_error += error_of(*render(even).film, other) / kRuns;
    told += result.error.relative_rms * result.error.relative_rms / kRuns;
    held += std::sqrt(own) >= result.error.ci95[0] && std::sqrt(own) <= result.error.ci95[1];
    differences.push_back(difference);
  }
  EXPECT_LT(error, 0.9 * even_error);
  EXPECT_NEAR(told, error, 0.07 * error);
  EXPECT_GE(held, kRuns - 3);
  double mean = 0.0, squares = 0.0;
  for (const double d : differences) mean += d / kRuns;
  for (const double d : differences) squares += (d - mean) * (d - mean);
  constexpr double kStudent = 2.95; // 99 % of 16 repetitions, two-sided
  EXPECT_LT(std::abs(mean), kStudent * std::sqrt(squares / (kRuns * (kRuns - 1))));
}

// Auto shares samples out in the Cornell box, whose surroundings are black and whose corners are noisy, but not where
// every pixel has the noise of every other; there it is bit for bit the even render.
TEST_F(AdaptiveRender, AutoAdaptsWhereThatPays) {
  RenderPlan settings = settings_of(256, 128, 64);
  settings.adaptive = kAdaptiveAuto;
  settings.looks_for_noise = true;
  settings.max_depth = 1;
  const RenderResult box = render(settings);
  ASSERT_TRUE(box.noise);
  EXPECT_TRUE(box.noise->used) << box.noise->cost;
  EXPECT_LT(box.noise->cost, 0.92);
  EXPECT_EQ(box.noise->width, 64u);
  EXPECT_FALSE(box.even);
  settings.last_sample = 8;
  const RenderResult brief = render(settings);
  EXPECT_EQ(brief.noise->samples, kFewestPilotSamples);
  EXPECT_TRUE(brief.noise->used) << brief.noise->cost;
  settings.last_sample = 64;

  scene_ = load_gltf(std::string(WAVEPATH_SOURCE_DIR) + "/scenes/analytic/occlusion_in_corner.gltf", {});
  scene_.environment.radiance = glm::vec3(1.0f);
  packed_ = pack(scene_, {.direct = gpu::kDirectBsdf});
  settings.direct = gpu::kDirectBsdf;
  settings.sampler = gpu::kSamplerIndependent;
  const RenderResult corner = render(settings);
  ASSERT_TRUE(corner.noise);
  EXPECT_FALSE(corner.noise->used) << corner.noise->cost;
  EXPECT_TRUE(corner.even);
  EXPECT_EQ(corner.spp, 64u);
  RenderPlan off = settings;
  off.adaptive = kAdaptiveOff;
  const RenderResult even = render(off);
  EXPECT_FALSE(even.noise);
  EXPECT_TRUE(*corner.film == *even.film);

  settings.target_error = off.target_error = 1.05 * even.error.relative_rms; // reached between two checkpoints
  const RenderResult reached = render(settings), expected = render(off);
  EXPECT_EQ(expected.stop, StopReason::target_error);
  EXPECT_EQ(reached.noise->samples, kFewestPilotSamples);
  EXPECT_FALSE(reached.noise->used) << reached.noise->cost;
  EXPECT_EQ(reached.spp, expected.spp) << "the error was looked at elsewhere";
  EXPECT_TRUE(*reached.film == *expected.film);
}

// A pilot of a render that may be short is short.
TEST_F(AdaptiveRender, AnOpenEndRendersTheShortestPilot) {
  RenderPlan settings = settings_of(64, 64, 4096);
  settings.target_error = 0.5;
  EXPECT_EQ(render(settings).noise->samples, kFewestPilotSamples);
  settings.target_error = 0.0, settings.last_sample = 256;
  EXPECT_EQ(render(settings).noise->samples, 32u);
}

// Every entry is in one segment, of its band and of its pixel's level, where
// entry minus offset in the film is the same for all.
TEST_F(AdaptiveRender, SegmentsHoldEveryReplicateOnce) {
  const std::uint64_t limit = device().info().max_storage_range;
  const auto tall =
      static_cast<std::uint32_t>(std::min(limit, std::uint64_t{1} << 28) / sizeof(gpu::FilmPixel) / 1026 + 37);
  for (const auto& [width, height] : {std::pair{101u, 67u}, {1026u, tall}})
    for (const auto& [whole, quads] : {std::pair{true, false}, {true, true}, {false, false}}) {
      if (height == tall && !whole) continue; // would take twice the memory
      FilmTarget film(device());
      film.fit({.width = width, .height = height, .has_probes = whole, .seed = 3, .quads = quads}, false);
      const auto pixels = static_cast<std::uint32_t>(film.pixels());
      std::vector<std::int8_t> levels((pixels + kRunPixels - 1) / kRunPixels);
      for (std::uint32_t run = 0; run < levels.size(); ++run)
        levels[run] = static_cast<std::int8_t>(kLowestLevel + static_cast<int>(gpu::probe_hash(run) % 6));
      std::vector<std::uint32_t> entries;
      const std::vector<Segment> segments = level_segments(film, levels, entries);
      ASSERT_EQ(entries.size(), film.shape().entries());
      std::size_t wrong = 0, next = 0;
      for (const Segment& segment : segments) {
        const FilmBand& band = film.bands()[segment.band];
        EXPECT_EQ(segment.first_entry, next);
        if (&segment != &segments.front() && (&segment)[-1].band == segment.band) {
          EXPECT_LE(segment.level, (&segment)[-1].level) << "a pass cut short leaves noisy ones out";
        }
        next += segment.pixel_count;
        const std::uint32_t offset = entries[segment.first_entry] - band.offset_of(entries[segment.first_entry]);
        for (std::uint32_t i = 0; i < segment.pixel_count; ++i) {
          const std::uint32_t entry = entries[segment.first_entry + i];
          const glm::uvec2 at = entry < pixels
                                    ? gpu::pixel_in_tile_order(entry, width, height)
                                    : gpu::probed_pixel(entry - pixels, width, height, 3, film.shape().probes());
          wrong += levels[gpu::tile_order_of(at, width, height) / kRunPixels] != segment.level;
          wrong += entry - band.offset_of(entry) != offset || band.offset_of(entry) >= band.entries();
          if (quads && gpu::rank_in_quad(entry, pixels) > 0)
            wrong += i == 0 || entries[segment.first_entry + i - 1] != entry - 1;
        }
      }
      EXPECT_EQ(wrong, 0u);
      EXPECT_EQ(next, entries.size());
      std::ranges::sort(entries);
      for (std::uint32_t i = 0; i < entries.size(); ++i) wrong += entries[i] != i;
      EXPECT_EQ(wrong, 0u);
    }
}

} // namespace
} // namespace wavepath::test
