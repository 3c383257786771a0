// Parts of pictures (--crop): each has the bits of the whole picture there, its files and merged films as well, and its
// error holds for its own pixels.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include <fmt/format.h>
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
#include "host/scene/pack/light_groups.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"
#include "tests/probe.h"
#include "tests/run_wavepath.h"
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
    const View view = resolve_view(scene_, camera_, settings.width, settings.height);
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

  static void expect_same(const Picture& expected, const Picture& picture) {
    ASSERT_EQ(expected.channels.size(), picture.channels.size());
    for (std::size_t c = 0; c < expected.channels.size(); ++c)
      EXPECT_EQ(expected.channels[c].values, picture.channels[c].values) << expected.channels[c].name;
  }

  // Files keep of a probed pixel outside the part what the estimate of the error needs: its light.
  static Film without_probes_outside(Film film) {
    for (std::size_t block = 0; block < film.probed.size(); ++block) {
      const std::size_t pixels = film.shape().pixels(), entry = pixels + block;
      if (film.probed[block] < pixels) continue;
      if (!film.aovs.empty()) film.aovs[entry] = {};
      if (!film.cover.empty()) film.cover[entry] = {};
      for (std::uint32_t g = 0; g < film.group_count; ++g) film.groups[entry * film.group_count + g] = {};
    }
    return film;
  }

  // Four tiles through files give the film of the whole.
  void expect_tiles_join(const RenderPlan& settings) {
    const TemporaryFolder folder;
    const RenderResult whole = render(settings);
    Film joined = make_film(whole.film->shape());
    std::vector<bool> known(joined.shape().pixels());
    for (const Crop& crop : {Crop{0, 0, 41, 30}, Crop{41, 0, 36, 30}, Crop{0, 30, 41, 31}, Crop{40, 29, 37, 32}}) {
      RenderPlan part = settings;
      part.crop = crop;
      const RenderResult result = render(part);
      EXPECT_TRUE(*result.film == cut(*whole.film, picture_shape(part))) << crop.left << "," << crop.top;
      PictureInfo info;
      info.film = result.film;
      const std::string file = folder.file("part.exr");
      write_picture(file, result.picture, info, {});
      const Picture picture = read_picture(file);
      EXPECT_EQ(picture.place, result.picture.place);
      EXPECT_EQ(picture.channels[0].values, result.picture.channels[0].values);
      const std::shared_ptr<const Film> read = read_film(file);
      ASSERT_TRUE(read);
      EXPECT_TRUE(*read == without_probes_outside(*result.film));
      expect_same(*cut_to(develop(*whole.film, {"variance"}, {}), picture), develop(*read, {"variance"}, {}));
      ASSERT_TRUE(paste(joined, *read, known));
    }
    EXPECT_TRUE(joined == *whole.film);
    Film other = joined;
    ++other.pixels[0].count;
    EXPECT_FALSE(paste(joined, other, known)) << "other samples of a pixel";
  }

  ViewRequest camera_;
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
                          {"hybrid", settings_of("hybrid")},
                          {"ao", settings_of("ao")}};
  cases[1].settings.probes_from = ~0u;
  cases[2].settings.adaptive = cases[4].settings.adaptive = kAdaptiveOn;
  cases[3].settings.reuse = cases[4].settings.reuse = kReuseOn;
  cases[5].settings.aovs = {"albedo", "normal", "depth", "samples", "variance"};
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
      expect_same(*expected, result.picture);
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
    expect_tiles_join(settings);
  }
}

// Sums of light groups and of transparency, of pixels, probes and splats, are cut and joined as the picture is.
TEST_F(CropRender, TilesHaveGroupsAndCover) {
  scene_.environment.radiance = {0.2f, 0.3f, 0.5f};
  packed_ = pack(scene_, {.light_groups = {"each"}});
  for (const char* integrator : {"path", "bidirectional"})
    for (const auto& [name, probes_from, reuse] :
         {std::tuple{"probes", 0u, kReuseOff}, std::tuple{"two replicates a pixel", ~0u, kReuseOff},
          std::tuple{"quads", 0u, kReuseOn}}) {
      RenderPlan settings = settings_of(integrator);
      if (settings.integrator->splats && probes_from == 0) continue; // it has no probes
      SCOPED_TRACE(fmt::format("{}, {}", integrator, name));
      settings.last_sample = 4;
      settings.probes_from = probes_from, settings.reuse = reuse;
      settings.transparent = true;
      settings.aovs = {"environment", "albedo"};
      if (!settings.integrator->splats) settings.aovs.push_back("shadow");
      if (reuse == kReuseOff) { // pixels that share paths do not know whose light they share
        settings.light_groups = {"each"};
        settings.group_names = find_group_names(scene_, settings.light_groups);
        EXPECT_EQ(settings.group_names.size(), 2u);
      }
      expect_tiles_join(settings);
    }
}

TEST_F(CropRender, CamerasShowTheSame) {
  const std::tuple<const char*, ViewRequest> cameras[] = {
      {"fisheye", {.projection = Projection::fisheye, .fov = 2.6}},
      {"sphere", {.projection = Projection::equirectangular}},
      {"parallel", {.projection = Projection::orthographic}},
      {"shifted", {.shift = glm::dvec2(0.2, -0.1)}},
      {"intrinsics", {.intrinsics = Intrinsics{60.0, 55.0, 30.0, 40.0}}},
      {"stereo", {.stereo = 0.06}}};
  for (const auto& [name, camera] : cameras) {
    SCOPED_TRACE(name);
    camera_ = camera;
    RenderPlan settings = settings_of("path");
    settings.width = 78; // two eyes
    settings.last_sample = 2;
    settings.aovs = {"normal", "position"};
    const RenderResult whole = render(settings);
    settings.crop = Crop{29, 11, 21, 13};
    const RenderResult part = render(settings);
    const std::optional<Picture> expected = cut_to(whole.picture, part.picture);
    ASSERT_TRUE(expected);
    double light = 0.0;
    for (std::size_t c = 0; c < expected->channels.size(); ++c) {
      EXPECT_EQ(expected->channels[c].values, part.picture.channels[c].values) << expected->channels[c].name;
      for (const float value : expected->channels[c].values) light += std::abs(value);
    }
    EXPECT_GT(light, 0.0);
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

// A part so small that few pixels of it are probed has no estimate, not a wrong one.
TEST(CropEstimate, IsUnknownWithFewProbedPixels) {
  Film film = make_film({.width = 64, .height = 64, .has_probes = true});
  for (gpu::FilmPixel& pixel : film.pixels) pixel.count = 16;
  const auto part = [](std::uint32_t width, std::uint32_t height) {
    return FilmShape{.width = width, .height = height, .has_probes = true, .place = {8, 4, 64, 64}};
  };
  EXPECT_EQ(probes_within(part(16, 16)), 16u);
  EXPECT_EQ(probes_within(part(16, 12)), 12u);
  EXPECT_TRUE(has_estimate(16, estimate_error(cut(film, part(16, 16)))));
  EXPECT_FALSE(has_estimate(16, estimate_error(cut(film, part(16, 12)))));
  EXPECT_FALSE(has_estimate(16, estimate_error(cut(film, part(1, 1)))));
}

// As a user does it.
class CropCommand : public ProgramTest {
protected:
  Outcome wavepath(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), WAVEPATH_BINARY);
    RunOptions options;
    options.folder = folder_.path().string();
    return run_program(arguments, options);
  }
  Outcome render(const std::string& output, std::vector<std::string> flags) {
    std::vector<std::string> all{
        "render", kScenes + "cornell_box.gltf", "--size", "78x61", "--spp", "8", "--max-depth", "3", "-q", "-o",
        output};
    all.insert(all.end(), flags.begin(), flags.end());
    return wavepath(all);
  }
  Picture read(const std::string& name) const { return read_picture(folder_.file(name)); }
  void expect_same(const Picture& a, const Picture& b) const {
    ASSERT_EQ(a.channels.size(), b.channels.size());
    for (const Channel& channel : a.channels) {
      const std::vector<float>* const other =
          find_channel(b, channel.name) ? &find_channel(b, channel.name)->values : nullptr;
      ASSERT_TRUE(other) << channel.name;
      EXPECT_EQ(channel.values, *other) << channel.name;
    }
  }
  bool exists(const std::string& name) const { return std::filesystem::exists(folder_.file(name)); }

private:
  TemporaryFolder folder_;
};

using Flags = std::vector<std::string>;

TEST_F(CropCommand, TilesMergeToTheWhole) {
  const std::string passes = "albedo,normal,depth,node,material,cryptomatte,depth0,normal0,uv";
  for (Flags flags : {Flags{"--integrator", "path", "--aov", passes},
                      {"--integrator", "path", "--env", "0.2,0.3,0.5", "--light-groups", "each", "--transparent",
                       "--aov", "shadow,environment"},
                      {"--integrator", "bidirectional", "--env", "0.2,0.3,0.5", "--light-groups", "each",
                       "--transparent", "--aov", "node,cryptomatte"},
                      {"--integrator", "hybrid", "--aov", "node,cryptomatte"},
                      {"--integrator", "path", "--projection", "fisheye", "--fov", "150", "--aov", passes},
                      {"--integrator", "path", "--stereo", "0.06", "--aov", "depth0,cryptomatte"}}) {
    SCOPED_TRACE(fmt::format("{}", fmt::join(flags, " ")));
    flags.push_back("--mergeable");
    Outcome outcome = render("whole.exr", flags);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const Picture whole = read("whole.exr");
    Flags merge{"merge", "-q", "-o", "merged.exr"};
    for (const char* crop : {"0,0,41,61", "40,0,38,61"}) {
      Flags part = flags;
      part.insert(part.end(), {"--crop", crop});
      merge.push_back(fmt::format("{}.exr", crop));
      outcome = render(merge.back(), part);
      ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
      EXPECT_EQ(outcome.err.find("validation:"), std::string::npos) << outcome.err;
      const Picture tile = read(merge.back());
      const std::optional<Picture> expected = cut_to(whole, tile);
      ASSERT_TRUE(expected);
      expect_same(*expected, tile);
    }
    outcome = wavepath(merge);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    expect_same(read("merged.exr"), whole);
  }
}

// From its state, and by two devices.
TEST_F(CropCommand, GoesOnAndIsShared) {
  for (const std::string integrator : {"path", "bidirectional", "hybrid"}) {
    SCOPED_TRACE(integrator);
    const Flags flags{"--integrator", integrator, "--crop", "13,9,50,40"};
    const auto with = [&](Flags more) {
      more.insert(more.begin(), flags.begin(), flags.end());
      return more;
    };
    const std::string state = fmt::format("{}.state", integrator);
    ASSERT_EQ(render("at_once.exr", flags).exit_code, 0);
    ASSERT_EQ(render("half.exr", with({"--spp", "4", "--checkpoint", state})).exit_code, 0);
    Outcome outcome = render("resumed.exr", with({"--checkpoint", state, "--resume"}));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    expect_same(read("resumed.exr"), read("at_once.exr"));
    outcome =
        render("other.exr", {"--integrator", integrator, "--crop", "13,9,51,40", "--checkpoint", state, "--resume"});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_NE(outcome.err.find("crop is 13,9,51,40, not 13,9,50,40"), std::string::npos) << outcome.err;
    outcome = render("shared.exr", with({"--devices", "0,0"}));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    expect_same(read("shared.exr"), read("at_once.exr"));
    const bool saves_no_work = outcome.err.find("renders the whole picture and keeps the part") != std::string::npos;
    EXPECT_EQ(saves_no_work, integrator != "path");
  }
}

TEST_F(CropCommand, RefusesWhatCannotBe) {
  const std::pair<Flags, const char*> cases[] = {
      {{"--crop", "30,10,49,20"}, "is not within the picture"},
      {{"--crop", "0,0,0,4"}, "is empty"},
      {{"--crop", "0,0,4"}, "is not four numbers"},
      {{"--crop", "0.5,0,4,4"}, "is not in whole pixels"},
      {{"--crop", "0,0,40,40", "--denoise"}, "looks at neighbours"},
      {{"--size", "256x256", "--crop", "9,9,8,8", "--target-error", "0.1"}, "needs more pixels than --crop has"}};
  for (const auto& [flags, problem] : cases) {
    const Outcome outcome = render("none.exr", flags);
    EXPECT_EQ(outcome.exit_code, 2) << problem;
    EXPECT_NE(outcome.err.find(problem), std::string::npos) << outcome.err;
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
    EXPECT_FALSE(exists("none.exr")) << problem;
  }
  EXPECT_EQ(render("some.exr", {"--size", "256x256", "--crop", "9,9,48,48", "--spp", "64", "--target-error", "0.5"})
                .exit_code,
            0);
}

TEST_F(CropCommand, ThePlanTellsThePart) {
  const Outcome outcome =
      wavepath({"info", kScenes + "cornell_box.gltf", "--plan", "--size", "78x61", "--crop", "5,6,30,20"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("plan of a render at 78x61, of it 30x20 from 5,6 on"), std::string::npos) << outcome.out;
}

} // namespace
} // namespace wavepath::test
