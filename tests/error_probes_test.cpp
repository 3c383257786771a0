// Error probes: which renders have them, which pixels are probed, what the film then holds, and that it is the same
// however a render is cut up, stopped, stored or joined.
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "host/film/error.h"
#include "host/film/film.h"
#include "host/integrators/path/path_replay.h"
#include "host/picture/files/exr.h"
#include "host/picture/files/picture_io.h"
#include "host/render/loop/integrator.h"
#include "host/render/render.h"
#include "host/render/report/state_file.h"
#include "host/render/settings/identity.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/probing.h"
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
#include "tests/statistics.h"
#include "tests/temporary_folder.h"

namespace wavepath::test {
namespace {

const std::string kScenes = std::string(WAVEPATH_SOURCE_DIR) + "/scenes/";

TEST(ErrorProbes, AreForLargePicturesOfPathsThatStandForThemselves) {
  RenderPlan settings;
  settings.width = 256, settings.height = 128;
  EXPECT_TRUE(has_error_probes(settings));
  settings.width = 255;
  EXPECT_FALSE(has_error_probes(settings));
  settings.width = 4096;
  settings.aovs = {"albedo", "samples"};
  EXPECT_TRUE(has_error_probes(settings));
  settings.aovs.emplace_back("variance");
  EXPECT_FALSE(has_error_probes(settings));
  settings.aovs.clear();
  settings.adaptive = kAdaptiveOn;
  EXPECT_TRUE(has_error_probes(settings));
  const std::map<std::string, bool> expected{
      {"path", true}, {"whitted", true}, {"bidirectional", false}, {"hybrid", false}};
  for (const auto& [name, whole] : expected) {
    settings.integrator = find_integrator(name);
    ASSERT_TRUE(settings.integrator) << name;
    EXPECT_EQ(has_error_probes(settings), whole) << name;
  }
}

TEST(ErrorProbes, DecideTheIdentity) {
  RenderPlan whole, split;
  split.aovs = {"variance"}, whole.aovs = {"albedo"};
  const std::string a = identity_of(1, View{}, whole), b = identity_of(1, View{}, split);
  EXPECT_EQ(first_difference(a, a), std::nullopt);
  EXPECT_EQ(first_difference(a, b),
            "it has error probes, not samples split between two replicates (--aov variance and --denoise split samples "
            "between replicates)");
}

// As many pixels as the error of a picture takes, and no more.
TEST(ErrorProbes, MeasureTwoThousandPixelsOrMore) {
  for (const auto& [width, height, second] : {std::tuple{256u, 128u, 2048u},
                                              {256u, 256u, 4096u},
                                              {320u, 240u, 4800u},
                                              {512u, 512u, 4096u},
                                              {511u, 511u, 16384u},
                                              {1280u, 720u, 14400u},
                                              {1281u, 721u, 161u * 91}}) {
    const FilmShape shape{.width = width, .height = height, .has_probes = true};
    EXPECT_EQ(shape.probe_count(), second);
  }
  std::vector<int> entries(64);
  for (std::uint32_t block = 0; block < 4096; ++block) {
    const glm::uvec2 at = gpu::probed_pixel(block, 512, 512, 3, gpu::kProbesPixels);
    ASSERT_EQ(gpu::probe_block_of(at, 512, 512, gpu::kProbesPixels), block);
    ++entries[at.y % 8 * 8 + at.x % 8];
  }
  for (const int times : entries) EXPECT_NEAR(times, 64, 5 * 8) << "of 64 places of a block";
}

// Every pixel of a block, cut off or not, is probed for as many seeds; so are pairs of neighbouring blocks.
TEST(ErrorProbes, AnyPixelOfABlockMayBeProbed) {
  constexpr std::uint32_t kSeeds = 1 << 15, kWidth = 11, kHeight = 7; // last blocks of 3x4, 4x3 and 3x3
  const double level = sidak(0.01, 7);
  ASSERT_EQ(gpu::probe_blocks(kWidth, gpu::probe_block_side(kWidth, kHeight)), 3u);
  for (std::uint32_t block = 0; block < 6; ++block) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, double> counts;
    for (std::uint32_t seed = 0; seed < kSeeds; ++seed) {
      const glm::uvec2 at = gpu::probed_pixel(block, kWidth, kHeight, seed, gpu::kProbesPixels);
      ASSERT_TRUE(at.x < kWidth && at.y < kHeight);
      ASSERT_EQ(gpu::probe_block_of(at, kWidth, kHeight, gpu::kProbesPixels), block);
      counts[{at.x, at.y}] += 1.0;
    }
    EXPECT_EQ(counts.size(), (block % 3 == 2 ? 3u : 4u) * (block / 3 == 1 ? 3u : 4u));
    std::vector<double> histogram;
    for (const auto& [pixel, count] : counts) histogram.push_back(count);
    EXPECT_GT(chi_square_uniform(histogram).p_value, level) << block;
  }
  std::vector<double> pairs(256);
  for (std::uint32_t block = 0; block + 1 < 256 * 63; ++block) {
    const auto entry = [&](std::uint32_t b) {
      const glm::uvec2 at = gpu::probed_pixel(b, 1024, 255, 7, gpu::kProbesPixels);
      return at.y % 4 * 4 + at.x % 4;
    };
    pairs[entry(block) * 16 + entry(block + 1)] += 1.0;
  }
  EXPECT_GT(chi_square_uniform(pairs).p_value, level);
}

// Odd sizes, whose last tiles are cut off, down to less than a quad; and large ones, with tile blocks of four tiles.
constexpr std::pair<std::uint32_t, std::uint32_t> kSizes[] = {
    {8, 8}, {16, 24}, {11, 7}, {43, 37}, {3, 1}, {1, 1}, {9, 9}, {17, 10}, {512, 512}, {515, 513}, {1026, 517}};

TEST(Quads, EveryBlockOfTheirPixelsHasOneProbe) {
  for (const auto& [width, height] : kSizes) {
    SCOPED_TRACE(std::to_string(width) + "x" + std::to_string(height));
    const FilmShape shape{.width = width, .height = height, .has_probes = true, .seed = 3, .quads = true};
    const Film film = make_film(shape);
    std::vector<std::size_t> pixels(shape.probe_count());
    std::size_t wrong = 0;
    for (std::uint32_t y = 0; y < height; ++y)
      for (std::uint32_t x = 0; x < width; ++x) {
        const std::size_t block = block_of(film, std::size_t{y} * width + x);
        wrong += block != gpu::probe_block_of({x, y}, width, height, gpu::kProbesQuads);
        ASSERT_LT(block, pixels.size());
        ++pixels[block];
      }
    for (std::uint32_t block = 0; block < pixels.size(); ++block) {
      const std::size_t probed = probed_pixel(film, block);
      const glm::uvec2 at = gpu::probed_pixel(block, width, height, 3, gpu::kProbesQuads);
      wrong += at.x >= width || at.y >= height || at.y * width + at.x != probed;
      wrong += block_of(film, probed) != block || pixels_probed_by(film, probed) != pixels[block];
    }
    EXPECT_EQ(wrong, 0u);
    for (std::uint32_t rows = 8, before = 0; rows < height + 8; rows += 8) { // as bands are cut
      const std::uint32_t end = std::min(rows, height), probes = shape.probes_above(end);
      for (std::uint32_t block = before; block < probes; ++block)
        wrong += (probed_pixel(film, block) / width - (rows - 8)) >= end - (rows - 8);
      before = probes;
    }
    EXPECT_EQ(wrong, 0u);
  }
}

// Probes of a quad follow each other as its pixels do, which in a complete tile are a square.
TEST(Quads, AreProbedWhole) {
  for (const auto& [width, height] : kSizes) {
    SCOPED_TRACE(std::to_string(width) + "x" + std::to_string(height));
    const FilmShape shape{.width = width, .height = height, .has_probes = true, .seed = 5, .quads = true};
    const auto pixels = static_cast<std::uint32_t>(shape.pixels());
    const auto probes = static_cast<std::uint32_t>(shape.probe_count());
    std::size_t wrong = 0;
    for (std::uint32_t block = 0; block < probes; ++block) {
      const auto pixel_of = [&, w = width, h = height](std::uint32_t b) {
        return gpu::tile_order_of(gpu::probed_pixel(b, w, h, 5, gpu::kProbesQuads), w, h);
      };
      const std::uint32_t rank = gpu::rank_in_quad(pixels + block, pixels), entry = pixel_of(block);
      wrong += gpu::rank_in_quad(entry, pixels) != rank || pixel_of(block - rank) != entry - rank;
      wrong += gpu::quad_entries(pixels + block, width, height) != gpu::quad_entries(entry, width, height);
      wrong += gpu::quad_entries(entry, width, height) < gpu::kQuadPixels &&
               gpu::tile_block(block / 4, width, height).pixels > 3;
    }
    EXPECT_EQ(wrong, 0u);
    EXPECT_EQ(gpu::quad_entries(pixels - 1, width, height), (pixels - 1) % 4 + 1);
  }
  for (std::uint32_t block = 0; block < 4096; block += 4) {
    const glm::uvec2 at = gpu::probed_pixel(block, 512, 512, 5, gpu::kProbesQuads);
    EXPECT_EQ(at % 2u, glm::uvec2(0));
    for (std::uint32_t k = 1; k < 4; ++k)
      EXPECT_EQ(gpu::probed_pixel(block + k, 512, 512, 5, gpu::kProbesQuads), at + glm::uvec2(k % 2, k / 2));
  }
}

// About as many probes as of single pixels.
TEST(Quads, AreAsManyAsTheErrorOfAPictureTakes) {
  for (const auto& [width, height, second] : {std::tuple{256u, 128u, 2048u},
                                              {512u, 512u, 4096u},
                                              {511u, 511u, 16384u},
                                              {1280u, 720u, 14400u},
                                              {1281u, 721u, 4u * 41 * 91 - 3}, // the last tile has one pixel
                                              {3u, 1u, 3u}}) {
    const FilmShape shape{.width = width, .height = height, .has_probes = true, .quads = true};
    EXPECT_EQ(shape.probe_count(), second);
  }
  EXPECT_EQ((FilmShape{.width = 64, .height = 64, .quads = true}.probe_count()), 0u);
}

TEST(Quads, AnyCompleteOneOfATileBlockMayBeProbed) {
  constexpr std::uint32_t kSeeds = 1 << 14, kWidth = 11, kHeight = 13; // tiles of 8x8, 3x8, 8x5 and 3x5
  const std::size_t quads[] = {16, 6, 10, 3};
  for (std::uint32_t tile = 0; tile < 4; ++tile) {
    std::map<std::uint32_t, double> counts;
    for (std::uint32_t seed = 0; seed < kSeeds; ++seed) {
      const glm::uvec2 at = gpu::probed_pixel(4 * tile, kWidth, kHeight, seed, gpu::kProbesQuads);
      counts[gpu::tile_order_of(at, kWidth, kHeight)] += 1.0;
    }
    EXPECT_EQ(counts.size(), quads[tile]);
    std::vector<double> histogram;
    for (const auto& [entry, count] : counts) histogram.push_back(count);
    EXPECT_GT(chi_square_uniform(histogram).p_value, sidak(0.01, 4)) << tile;
  }
}

TEST(ErrorProbes, TakeLessMemoryThanSplitReplicates) {
  FilmShape split{.width = 1280, .height = 720}, whole = split;
  whole.has_probes = true;
  EXPECT_EQ(split.bytes(), 1280u * 720 * 128);
  EXPECT_EQ(whole.bytes(), 1280u * 720 * 64 + 160u * 90 * 64);
  whole.aovs = split.aovs = true;
  EXPECT_LT(whole.bytes(), split.bytes());
}

RenderPlan settings_of(std::uint32_t width, std::uint32_t height, std::uint32_t spp) {
  RenderPlan settings;
  settings.width = width, settings.height = height;
  settings.last_sample = spp;
  settings.max_depth = 3;
  settings.probes_from = 0;
  return settings;
}

class ErrorProbesRender : public VulkanTest {
protected:
  RenderResult render(const RenderPlan& settings, const RenderHooks& hooks = {}, const char* integrator = "path") {
    RenderPlan all = settings;
    all.integrator = find_integrator(integrator);
    const View view = resolve_view(scene_, {}, settings.width, settings.height);
    return wavepath::render(device(), packed_, view, all, hooks, kernels());
  }
  KernelCompiler& kernels() { return shared_kernels(device()); }
  static bool same(const gpu::FilmPixel& a, const gpu::FilmPixel& b) { return std::memcmp(&a, &b, sizeof(a)) == 0; }

  Scene scene_ = load_gltf(kScenes + "cornell_box.gltf", {});
  PackedScene packed_ = pack(scene_);
};

RenderPlan by_quads(RenderPlan settings) {
  settings.reuse = kReuseOn;
  return settings;
}

RenderPlan split(RenderPlan settings) {
  settings.probes_from = std::numeric_limits<std::uint32_t>::max();
  return settings;
}

// A replicate of all n samples is what one of 2n split samples is: with as many points, and the same ones.
TEST_F(ErrorProbesRender, EachReplicateHoldsAllSamples) {
  const std::pair<const char*, std::uint32_t> cases[] = {
      {"path", gpu::kSamplerSobol}, {"path", gpu::kSamplerStratified}, {"whitted", gpu::kSamplerSobol}};
  for (const auto& [integrator, sampler] : cases) {
    SCOPED_TRACE(std::string(integrator) + ", sampler " + std::to_string(sampler));
    RenderPlan settings = settings_of(43, 37, 8), twice = split(settings_of(43, 37, 16));
    settings.sampler = twice.sampler = sampler;
    const auto whole = render(settings, {}, integrator).film, expected = render(twice, {}, integrator).film;
    ASSERT_EQ(whole->pixels.size(), 43u * 37 + 11 * 10);
    for (std::size_t i = 0; i < 43 * 37; ++i) ASSERT_TRUE(same(whole->pixels[i], expected->pixels[2 * i])) << i;
    for (std::size_t block = 0; block < 11 * 10; ++block)
      ASSERT_TRUE(same(whole->pixels[43 * 37 + block], expected->pixels[2 * probed_pixel(*whole, block) + 1]));
  }
}

TEST_F(ErrorProbesRender, ProbedPixelsShowTheMeanOfBothReplicates) {
  RenderPlan settings = settings_of(43, 37, 8);
  settings.aovs = {"samples", "albedo", "direct", "indirect", "emission"};
  const RenderResult result = render(settings);
  const Picture& picture = result.picture;
  const auto channel = [&](const char* name) { return find_channel(picture, name)->values; };
  const auto red = channel("R"), samples = channel("samples");
  const auto direct = channel("direct.R"), indirect = channel("indirect.R"), emission = channel("emission.R");
  std::size_t probed = 0;
  for (std::size_t i = 0; i < red.size(); ++i) {
    const bool is_probed = probed_pixel(*result.film, block_of(*result.film, i)) == i;
    probed += is_probed;
    ASSERT_EQ(samples[i], is_probed ? 16.0f : 8.0f);
    ASSERT_NEAR(direct[i] + indirect[i] + emission[i], red[i], 1e-5f * std::max(red[i], 1.0f));
    ASSERT_GE(indirect[i], -1e-5f * std::max(red[i], 1.0f)) << "light of other samples was taken off";
  }
  EXPECT_EQ(probed, 11u * 10);
}

TEST_F(ErrorProbesRender, HowTheWorkIsCutUpDoesNotMatter) {
  for (RenderPlan settings : {settings_of(43, 37, 5), by_quads(settings_of(43, 37, 5))}) {
    settings.aovs = {"albedo", "normal", "depth", "direct"};
    const RenderResult expected = render(settings);
    for (const std::uint32_t slots : {64u, 700u, 1600u}) { // 1591 pixels: waves end within pixels, and within probes
      settings.wave_slots = slots;
      EXPECT_TRUE(*render(settings).film == *expected.film) << slots << " slots";
    }
    settings.wave_slots = 0;
    settings.specialize = false;
    EXPECT_TRUE(*render(settings).film == *expected.film) << "generic kernels";
  }
}

// Probed by pixels: a probe is as good on another pixel. Light is shared, not changed.
TEST_F(ErrorProbesRender, ByQuadsThePictureAndItsErrorAreTheSame) {
  const RenderPlan alone = settings_of(64, 61, 64); // 488 quads measure it
  const RenderResult expected = render(alone);
  for (const RenderPlan& settings : {by_quads(alone), by_quads(split(alone))}) {
    const RenderResult result = render(settings);
    ASSERT_TRUE(result.film->quads);
    double mean = 0.0, variance = 0.0;
    for (std::size_t i = 0; i < result.film->shape().pixels(); ++i) {
      const PixelStatistics a = statistics(*expected.film, i), b = statistics(*result.film, i);
      ASSERT_TRUE(std::isfinite(b.variance.x));
      mean += b.mean.x - a.mean.x, variance += a.variance.x + b.variance.x;
    }
    EXPECT_LT(std::abs(mean), 8.0 * std::sqrt(variance)); // four pixels may err alike
    EXPECT_GT(result.error.relative_rms, 0.0);
    EXPECT_LT(result.error.relative_rms, 1.2 * expected.error.relative_rms); // less, where sharing pays
  }
}

// Kernels made for error probes serve another render until its own are ready.
TEST_F(ErrorProbesRender, TheirKernelsRenderSplitReplicatesAsWell) {
  const RenderPlan settings = split(settings_of(43, 37, 4));
  RenderPlan with_capacity = settings;
  with_capacity.kernels.has_probes = true;
  EXPECT_TRUE(*render(with_capacity).film == *render(settings).film);
}

TEST_F(ErrorProbesRender, FilmsJoinWithoutLoss) {
  for (const RenderPlan& whole : {settings_of(43, 37, 7), by_quads(settings_of(43, 37, 7))}) {
    RenderPlan first = whole, second = whole;
    first.last_sample = second.first_sample = 3;
    first.sample_total = second.sample_total = 7;
    Film film = *render(second).film;
    join(film, *render(first).film);
    EXPECT_TRUE(film == *render(whole).film);
  }
}

TEST_F(ErrorProbesRender, GoOnWithinProbesToTheSameBits) {
  for (RenderPlan settings : {settings_of(43, 37, 8), by_quads(settings_of(43, 37, 8))}) {
    const RenderResult whole = render(settings);
    settings.wave_slots = 100; // many waves a pass
    std::optional<RenderState> state;
    RenderHooks stopping, resuming;
    stopping.progress = [](const Progress& now) { return now.fraction < 4.93 / 8; };
    stopping.save = [&](const RenderState& saved) { state = saved; };
    stopping.save_interval = 1e9; // at the end alone
    ASSERT_EQ(render(settings, stopping).stop, StopReason::interrupted);
    ASSERT_GT(state->cursor.pixels_done, 43u * 37) << "stopped before the probes";
    const TemporaryFolder folder;
    write_state(folder.file("state"), "identity", "device", "[]", *state);
    const StateRecord record = read_state(folder.file("state"));
    EXPECT_TRUE(record.state.film == state->film);
    EXPECT_EQ(record.state.film.probed, state->film.probed);
    resuming.resume = &record.state;
    EXPECT_TRUE(*render(settings, resuming).film == *whole.film);
  }
}

TEST_F(ErrorProbesRender, FilesHoldTheWholeFilm) {
  for (RenderPlan settings : {settings_of(43, 37, 4), by_quads(settings_of(43, 37, 4)), by_quads(settings_of(9, 9, 4)),
                              split(by_quads(settings_of(9, 9, 4)))}) {
    const bool aovs = settings.width == 43;
    settings.seed = 5;
    if (aovs) settings.aovs = {"albedo", "depth"};
    const RenderResult result = render(settings);
    const TemporaryFolder folder;
    PictureInfo info;
    info.seed = settings.seed;
    info.film = result.film;
    write_exr(folder.file("film.exr"), result.picture, info, {});
    const auto film = read_film(folder.file("film.exr"));
    EXPECT_TRUE(*film == *result.film) << "aovs " << aovs;
    EXPECT_EQ(film->probed, result.film->probed);
  }
}

// More sums than one buffer of this device holds: bands, whose probes follow their pixels.
TEST_F(ErrorProbesRender, InSeveralBandsTheyAreTheSame) {
  const std::uint64_t limit = device().info().max_storage_range;
  if (limit > std::uint64_t{1} << 28) GTEST_SKIP() << "would take much memory";
  const auto height = static_cast<std::uint32_t>(limit / sizeof(gpu::FilmPixel) / 1026 + 37);
  RenderPlan settings = settings_of(1026, height, 1), twice = split(settings_of(1026, height, 2));
  settings.max_depth = twice.max_depth = 0;
  const auto whole = render(settings).film, expected = render(twice).film;
  const std::size_t pixels = std::size_t{1026} * height;
  ASSERT_GT(pixels * sizeof(gpu::FilmPixel), limit);
  std::size_t differing = 0;
  for (std::size_t i = 0; i < pixels; ++i) differing += !same(whole->pixels[i], expected->pixels[2 * i]);
  EXPECT_EQ(differing, 0u);
  for (std::size_t block = 0; block < whole->shape().probe_count(); ++block)
    differing += !same(whole->pixels[pixels + block], expected->pixels[2 * probed_pixel(*whole, block) + 1]);
  EXPECT_EQ(differing, 0u);
  FilmTarget target(device());
  const FilmShape quads = film_shape(by_quads([&] {
    RenderPlan deep = settings;
    deep.max_depth = 2;
    return deep;
  }()));
  ASSERT_TRUE(quads.quads);
  target.fit(quads, false);
  std::uint64_t pixels_of_bands = 0, second_of_bands = 0;
  for (const FilmBand& band : target.bands()) {
    EXPECT_EQ(band.first_probe, second_of_bands);
    EXPECT_EQ(band.first_probe % 4, 0u);
    pixels_of_bands += band.pixel_count, second_of_bands += band.probe_count;
  }
  EXPECT_EQ(pixels_of_bands, quads.pixels());
  EXPECT_EQ(second_of_bands, quads.probe_count());
  target.fit(film_shape(settings), false);
  std::size_t bands = 0;
  for (const FilmBand& band : target.bands()) bands += band.probe_count > 0;
  EXPECT_GT(bands, 1u);
  target.upload(*whole);
  EXPECT_TRUE(target.download() == *whole);
}

// Hands everything on, and looks at the waves: each must hold the places of whole quads, one after the other.
class Watched : public Integrator {
public:
  Watched(const Workspace& workspace, std::unique_ptr<Integrator> inner)
      : workspace_(workspace), inner_(std::move(inner)) {}
  void change(const View& view, const RenderPlan& settings, TemporalHistory history) override {
    inner_->change(view, settings, history);
  }
  bool is_ready() override { return inner_->is_ready(); }
  double get_ready() override { return inner_->get_ready(); }
  std::optional<Pilot> pilot() override { return inner_->pilot(); }
  bool end_pilot() override { return inner_->end_pilot(); }
  std::uint32_t paths_per_pixel(std::uint32_t samples) const override { return inner_->paths_per_pixel(samples); }
  std::uint32_t most_samples(std::uint32_t first) const override { return inner_->most_samples(first); }
  void begin_pass(WaveQueue& queue, std::uint32_t first) override { inner_->begin_pass(queue, first); }
  gpu::Wave wave(const FilmBand& band, std::uint32_t first_entry, std::uint32_t pixels, std::uint32_t first,
                 std::uint32_t count) const override {
    return inner_->wave(band, first_entry, pixels, first, count);
  }
  void record_wave(Commands& commands, std::size_t band, const gpu::Wave& wave) override {
    const gpu::Frame& frame = workspace_.frame;
    std::uint32_t left = 0; // of the quad
    for (std::uint32_t i = 0; i < wave.pixel_count; ++i, --left) {
      const std::uint32_t entry = workspace_.entry_at(wave.first_pixel + i);
      const std::uint32_t rank = gpu::rank_in_quad(entry, frame.width * frame.height);
      const std::uint32_t entries = gpu::quad_entries(entry, frame.width, frame.height);
      if (left == 0) left = entries, broken += rank != 0;
      broken += rank + left != entries;
    }
    broken += left != 0;
    broken += gpu::level_slots(wave) > workspace_.slots;
    ++waves;
    inner_->record_wave(commands, band, wave);
  }
  void end_pass(WaveQueue& queue) override { inner_->end_pass(queue); }
  std::uint32_t timed_dispatches() const override { return inner_->timed_dispatches(); }
  std::uint64_t bytes() const override { return inner_->bytes(); }
  void describe(RenderResult& result) const override { inner_->describe(result); }

  static inline std::size_t waves = 0, broken = 0;

private:
  const Workspace& workspace_;
  std::unique_ptr<Integrator> inner_;
};

TEST_F(ErrorProbesRender, NoWavePartsAQuad) {
  IntegratorKind watched = *find_integrator("path");
  watched.make = [](Workspace& workspace, KernelCompiler& kernels) -> std::unique_ptr<Integrator> {
    return std::make_unique<Watched>(workspace, find_integrator("path")->make(workspace, kernels));
  };
  const View view = resolve_view(scene_, {}, 43, 37);
  for (const bool whole : {true, false})
    for (const std::uint32_t adaptive : {kAdaptiveOff, kAdaptiveOn})
      for (const std::uint32_t slots : {1u, 7u, 64u, 701u}) {
        if (slots == 7 && adaptive == kAdaptiveOn) continue; // has room for more than it asks for
        RenderPlan settings = by_quads(settings_of(43, 37, adaptive == kAdaptiveOn ? 8 : 2));
        if (!whole) settings = split(settings);
        settings.adaptive = adaptive, settings.wave_slots = slots;
        settings.integrator = &watched;
        Watched::waves = Watched::broken = 0;
        const auto film = wavepath::render(device(), packed_, view, settings, RenderHooks{}, kernels()).film;
        EXPECT_EQ(Watched::broken, 0u) << slots << " slots, whole " << whole << ", adaptive " << adaptive;
        EXPECT_GT(Watched::waves, 2u);
        settings.integrator = find_integrator("path"), settings.wave_slots = 0;
        EXPECT_TRUE(*film == *wavepath::render(device(), packed_, view, settings, RenderHooks{}, kernels()).film);
      }
}

// One path of a probe can be followed like any other.
TEST_F(ErrorProbesRender, PathsOfProbesAreReplayed) {
  const RenderPlan settings = settings_of(43, 37, 1);
  const RenderResult result = render(settings);
  const View view = resolve_view(scene_, {}, 43, 37);
  PathReplay replay(device(), packed_, view, settings, kernels());
  for (const std::uint32_t block : {37u, 49u, 60u}) {
    const glm::uvec2 at = gpu::probed_pixel(block, 43, 37, settings.seed, gpu::kProbesPixels);
    const glm::dvec3 both = mean_radiance(*result.film, std::size_t{at.y} * 43 + at.x);
    const glm::dvec3 first = replay.trace(at, 0, 0).radiance, second = replay.trace(at, 0, 1).radiance;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(both[c], 0.5 * (first[c] + second[c]), 1e-6 * both[c]);
    EXPECT_NE(first, second) << "both replicates have the same points";
  }
  const glm::uvec2 other = gpu::probed_pixel(0, 43, 37, settings.seed, gpu::kProbesPixels) ^ glm::uvec2(1, 0);
  EXPECT_THROW(replay.trace(other, 0, 1), Error);
}

} // namespace
} // namespace wavepath::test
