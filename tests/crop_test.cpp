// Parts of pictures (--crop): each has the bits of the whole picture there, its files and merged films as well, and its
// error holds for its own pixels.
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "host/film/error.h"
#include "host/film/film.h"
#include "host/picture/files/picture_io.h"
#include "host/picture/place.h"
#include "host/render/render.h"
#include "host/render/settings/crop.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/scene/gltf/gltf.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"
#include "tests/probe.h"
#include "tests/shared_kernels.h"
#include "tests/statistics.h"
#include "tests/temporary_folder.h"

namespace wavepath::test {
namespace {

const std::string kScenes = std::string(WAVEPATH_SOURCE_DIR) + "/scenes/";
constexpr std::uint32_t kWidth = 77, kHeight = 61; // no multiples of a tile

class CropRender : public VulkanTest {
protected:
  RenderResult render(const RenderPlan& settings) {
    const View view = resolve_view(scene_, {}, settings.width, settings.height);
    return wavepath::render(device(), packed_, view, settings, RenderHooks{}, shared_kernels(device()));
  }
  static RenderPlan settings_of(const char* integrator) {
    RenderPlan settings;
    settings.integrator = find_integrator(integrator);
    settings.width = kWidth, settings.height = kHeight;
    settings.last_sample = 8;
    settings.max_depth = 2;
    settings.adaptive = kAdaptiveOff;
    settings.reuse = kReuseOff;
    settings.probes_from = 0;
    return settings;
  }

  Scene scene_ = load_gltf(kScenes + "cornell_box.gltf", {});
  PackedScene packed_ = pack(scene_);
};

struct Case {
  const char* name;
  RenderPlan settings;
};

TEST_F(CropRender, HasTheBitsOfTheWholePicture) {
  std::vector<Case> cases{{"path", settings_of("path")},
                          {"two replicates a pixel", settings_of("path")},
                          {"adaptive", settings_of("path")},
                          {"quads", settings_of("path")},
                          {"adaptive, quads", settings_of("path")},
                          {"AOVs", settings_of("path")},
                          {"whitted", settings_of("whitted")},
                          {"bidirectional", settings_of("bidirectional")},
                          {"ao", settings_of("ao")}};
  cases[1].settings.probes_from = ~0u;
  cases[2].settings.adaptive = cases[4].settings.adaptive = kAdaptiveOn;
  cases[3].settings.reuse = cases[4].settings.reuse = kReuseOn;
  cases[5].settings.aovs = {"albedo", "normal", "depth", "samples"};
  for (const auto& [name, settings] : cases) {
    SCOPED_TRACE(name);
    const RenderResult whole = render(settings);
    for (const Crop& crop : {Crop{13, 22, 30, 19}, Crop{70, 50, 7, 11}, Crop{33, 17, 1, 1}}) {
      RenderPlan part = settings;
      part.crop = crop;
      const RenderResult result = render(part);
      EXPECT_TRUE(*result.film == cut(*whole.film, picture_shape(part))) << crop.left << "," << crop.top;
      const std::optional<Picture> expected = cut_to(whole.picture, result.picture);
      ASSERT_TRUE(expected);
      for (std::size_t c = 0; c < expected->channels.size(); ++c)
        EXPECT_EQ(expected->channels[c].values, result.picture.channels[c].values) << expected->channels[c].name;
    }
    if (!settings.integrator->traces_paths || settings.integrator->splats) continue;
    RenderPlan small = settings;
    small.crop = Crop{16, 16, 16, 8};
    EXPECT_EQ(film_shape(small).pixels(), 16u * 8) << "more than the part is rendered";
  }
}

// Four tiles through files.
TEST_F(CropRender, TilesJoinToTheWhole) {
  const TemporaryFolder folder;
  for (const char* integrator : {"path", "bidirectional"}) {
    SCOPED_TRACE(integrator);
    RenderPlan settings = settings_of(integrator);
    settings.last_sample = 4;
    const RenderResult whole = render(settings);
    Film joined = make_film(whole.film->shape());
    std::vector<bool> known(joined.shape().pixels());
    for (const Crop& crop : {Crop{0, 0, 41, 30}, Crop{41, 0, 36, 30}, Crop{0, 30, 41, 31}, Crop{40, 29, 37, 32}}) {
      RenderPlan part = settings;
      part.crop = crop;
      const RenderResult result = render(part);
      PictureInfo info;
      info.film = result.film;
      const std::string file = folder.file("part.exr");
      write_picture(file, result.picture, info, {});
      const Picture picture = read_picture(file);
      EXPECT_EQ(picture.place, result.picture.place);
      EXPECT_EQ(picture.channels[0].values, result.picture.channels[0].values);
      const std::shared_ptr<const Film> read = read_film(file);
      ASSERT_TRUE(read);
      EXPECT_TRUE(*read == *result.film);
      ASSERT_TRUE(paste(joined, *read, known));
    }
    EXPECT_TRUE(joined == *whole.film);
    Film other = joined;
    ++other.pixels[0].count;
    EXPECT_FALSE(paste(joined, other, known)) << "other samples of a pixel";
  }
}

// Blocks that the border cuts stand for pixels outside as well: the estimate must be right on average all the same, and
// its interval hold the error. Noise that grows to the left would show a wrong share of cut blocks.
TEST(CropEstimate, HoldsForThePartsOwnPixels) {
  constexpr int kRuns = 400;
  constexpr double kMean = 0.5;
  constexpr std::uint32_t kCount = 16;
  const FilmShape part{.width = 37, .height = 31, .has_probes = true, .place = {13, 6, 64, 64}};
  double covered = 0.0;
  Mean ratio;
  for (std::uint32_t seed = 0; seed < kRuns; ++seed) {
    Film whole = make_film({.width = 64, .height = 64, .has_probes = true, .seed = seed});
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0.0, 1.0);
    for (std::size_t i = 0; i < whole.pixels.size(); ++i) {
      const std::size_t pixel = i < 64 * 64 ? i : probed_pixel(whole, i - 64 * 64);
      const double scale = 0.02 - 0.0002 * static_cast<double>(pixel % 64);
      const auto units = static_cast<std::uint32_t>(std::lround((kMean + scale * noise(random)) * kCount * 0x1p21));
      gpu::FilmPixel& sums = whole.pixels[i];
      for (gpu::ExactSum* sum : {&sums.red, &sums.green, &sums.blue}) sum->low[0] = units;
      sums.tops = 5 | 5 << 8 | 5 << 16; // digits of which bit 0 of the lower one weighs 2^-21
      sums.count = kCount, sums.largest = 1.53f;
    }
    FilmShape shape = part;
    shape.seed = seed;
    const Film film = cut(whole, shape);
    double truth = 0.0;
    for (std::size_t i = 0; i < shape.pixels(); ++i) {
      const glm::dvec3 off = mean_radiance(film, i) - kMean;
      truth += glm::dot(off, off) / 3.0 / (kMean * kMean + 0.01) / static_cast<double>(shape.pixels());
    }
    const ErrorEstimate error = estimate_error(film);
    covered += std::sqrt(truth) >= error.ci95[0] && std::sqrt(truth) <= error.ci95[1];
    ratio.add(error.relative_rms * error.relative_rms / truth);
  }
  EXPECT_NEAR(covered / kRuns, 0.95, 0.04);
  EXPECT_NEAR(ratio.mean(), 1.0, 0.03);
}

// A part so small that no pixel of it is probed has no estimate, not a wrong one.
TEST(CropEstimate, IsUnknownWithoutAProbedPixel) {
  Film film = make_film({.width = 64, .height = 64, .has_probes = true});
  const std::size_t other = probed_pixel(film, 0) == 0 ? 1 : 0;
  const FilmShape part{
      .width = 1, .height = 1, .has_probes = true, .place = {static_cast<std::uint32_t>(other), 0, 64, 64}};
  EXPECT_FALSE(has_estimate(16, estimate_error(cut(film, part))));
}

} // namespace
} // namespace wavepath::test
