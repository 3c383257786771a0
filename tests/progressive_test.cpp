// A window's render makes the bits of `wavepath render`, whatever happened on the way; and its display, what
// tonemap.cpp says.
#include <chrono>
#include <cmath>
#include <filesystem>
#include <mutex>
#include <thread>

#include "host/film/error.h"
#include "host/integrators/hybrid/kind.h"
#include "host/integrators/path/kind.h"
#include "host/picture/error_map.h"
#include "host/render/progressive/display.h"
#include "host/render/progressive/progressive.h"
#include "host/render/render.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/scene/gltf/gltf.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"
#include "tests/probe.h"
#include "tests/shared_kernels.h"

namespace wavepath::test {
namespace {

const std::filesystem::path kScenes = std::filesystem::path(WAVEPATH_SOURCE_DIR) / "scenes";

// Steps, and gives kernels the time to compile.
void step(Progressive& progressive) {
  if (!progressive.step()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}
void finish(Progressive& progressive) {
  while (progressive.status().fraction < 1.0) step(progressive);
}
void render_some(Progressive& progressive, int waves) {
  while (waves > 0) waves -= progressive.step();
}

class ProgressiveTest : public VulkanTest {
protected:
  void open(const std::string& name) {
    scene_ = load_gltf(kScenes / name);
    if (scene_.lights.empty()) scene_.environment.radiance = glm::vec3(0.5f);
    settings_.width = 40, settings_.height = 29; // tiles are cut off at the borders
    settings_.last_sample = 6;
    settings_.wave_slots = 700; // no multiple of anything
    packed_ = pack(scene_, {.direct = settings_.direct});
    view_ = view_at({});
  }
  View view_at(const ViewRequest& request) const { return view_at(request, settings_.width, settings_.height); }
  View view_at(const ViewRequest& request, std::uint32_t width, std::uint32_t height) const {
    return resolve_view(scene_, request, width, height);
  }
  // One that sees the scene from elsewhere.
  View moved_view() const {
    return view_at({.eye = view_.position + 0.2 * view_.right + 0.1 * view_.forward, .yfov = 0.6});
  }
  RenderResult rendered(const View& view, const RenderPlan& settings) {
    return render(device(), packed_, view, settings, RenderHooks{}, kernels());
  }
  void expect_as_rendered(Progressive& progressive) {
    finish(progressive);
    const RenderResult expected = rendered(progressive.view(), progressive.settings());
    EXPECT_EQ(progressive.film(), *expected.film);
    const Picture picture = progressive.picture();
    ASSERT_EQ(picture.channels.size(), expected.picture.channels.size());
    for (std::size_t c = 0; c < picture.channels.size(); ++c)
      EXPECT_EQ(picture.channels[c].values, expected.picture.channels[c].values) << picture.channels[c].name;
  }
  Progressive begin() { return Progressive(device(), packed_, view_, settings_, kernels()); }
  KernelCompiler& kernels() { return shared_kernels(device()); }

  Scene scene_;
  PackedScene packed_;
  RenderPlan settings_;
  View view_;
};

TEST_F(ProgressiveTest, MakesTheBitsOfRender) {
  for (const char* name : {"cornell_box.gltf", "showcase.glb"}) {
    SCOPED_TRACE(name);
    open(name);
    Progressive progressive = begin();
    expect_as_rendered(progressive);
    EXPECT_FALSE(progressive.step()) << "there is nothing left to do";
    EXPECT_EQ(progressive.status().spp, settings_.last_sample);
  }
}

TEST_F(ProgressiveTest, MovingAndResizingLeaveNoTrace) {
  for (const char* name : {"cornell_box.gltf", "showcase.glb"}) {
    SCOPED_TRACE(name);
    open(name);
    Progressive progressive = begin();
    render_some(progressive, 5);
    progressive.move(moved_view());
    render_some(progressive, 3);
    progressive.rest();
    render_some(progressive, 3);
    progressive.set_view(moved_view());
    expect_as_rendered(progressive);
    EXPECT_EQ(progressive.view().position, moved_view().position);

    RenderPlan larger = settings_;
    larger.width = 61, larger.height = 45;
    progressive.set_settings(larger, view_at({}, 61, 45));
    render_some(progressive, 7);
    expect_as_rendered(progressive);
    progressive.set_settings(settings_, view_);
    expect_as_rendered(progressive);
  }
}

TEST_F(ProgressiveTest, OtherSettingsLeaveNoTrace) {
  open("cornell_box.gltf");
  Progressive progressive = begin();
  render_some(progressive, 2);
  RenderPlan other = settings_;
  other.sampler = gpu::kSamplerStratified;
  other.max_depth = 2;
  other.seed = 5;
  progressive.set_settings(other, view_);
  expect_as_rendered(progressive);
  other.aovs = {"albedo", "normal", "direct"};
  other.first_sample = 1;
  progressive.set_settings(other, view_);
  expect_as_rendered(progressive);
  progressive.set_settings(settings_, view_);
  expect_as_rendered(progressive);

  // The scene was packed with its lights; render packs none where they are not sampled.
  RenderPlan bsdf = settings_;
  bsdf.direct = gpu::kDirectBsdf;
  progressive.set_settings(bsdf, view_);
  finish(progressive);
  const PackedScene without_lights = pack(scene_, {.direct = bsdf.direct});
  EXPECT_EQ(progressive.film(), *render(device(), without_lights, view_, bsdf, RenderHooks{}, kernels()).film);
}

TEST_F(ProgressiveTest, FramesMakeTheBitsOfRender) {
  if (!device().rasterizes()) GTEST_SKIP() << "the device cannot rasterize";
  open("cornell_box.gltf");
  Progressive progressive = begin();
  render_some(progressive, 2);
  RenderPlan frames = settings_;
  for (const IntegratorKind* integrator : {&kHybrid, &kAo}) {
    SCOPED_TRACE(integrator->name);
    frames.integrator = integrator;
    frames.denoise = false;
    frames.shadow_samples = 2;
    frames.aovs = {"albedo"};
    progressive.set_settings(frames, view_);
    render_some(progressive, 3);
    progressive.move(moved_view());
    render_some(progressive, 2);
    progressive.rest();
    expect_as_rendered(progressive);
    frames.denoise = true;
    frames.aovs = {};
    progressive.set_settings(frames, view_);
    render_some(progressive, 3);
    progressive.set_view(moved_view()); // what the filter remembers is of another picture
    expect_as_rendered(progressive);
  }
  progressive.set_settings(settings_, view_);
  expect_as_rendered(progressive);
}

// While the camera moves, hybrid frames are joined to those before: a picture of many moves has less noise than one
// frame, and what comes to rest is free of them (FramesMakeTheBitsOfRender).
TEST_F(ProgressiveTest, FramesInMotionAreAntialiasedOverTime) {
  if (!device().rasterizes()) GTEST_SKIP() << "the device cannot rasterize";
  open("cornell_box.gltf");
  settings_.integrator = &kHybrid;
  settings_.max_depth = 1;
  const auto noise_after = [&](int moves) {
    Progressive progressive = begin();
    while (progressive.step() || progressive.status().compiling) {
    } // the time of a frame is known now
    for (int i = 0; i < moves; ++i) {
      progressive.move(view_); // to the same view
      while (progressive.status().spp == 0) progressive.step();
    }
    EXPECT_TRUE(progressive.moving());
    const Picture moving = progressive.picture();
    RenderPlan fine = progressive.settings();
    fine.last_sample = 64;
    fine.width = progressive.film_target().shape().width, fine.height = progressive.film_target().shape().height;
    const Picture truth = render(device(), packed_, view_, fine).picture;
    double squares = 0.0;
    for (std::size_t i = 0; i < truth.channels[1].values.size(); ++i)
      squares +=
          std::pow(std::min(moving.channels[1].values[i], 1.0f) - std::min(truth.channels[1].values[i], 1.0f), 2);
    return squares;
  };
  EXPECT_LT(noise_after(12), 0.5 * noise_after(1));
}

TEST_F(ProgressiveTest, AnotherSceneIsRendered) {
  open("cornell_box.gltf");
  const PackedScene first = packed_;
  Progressive progressive(device(), first, view_, settings_, kernels());
  render_some(progressive, 2);
  scene_.environment.radiance = glm::vec3(2.0f, 1.0f, 0.5f);
  packed_ = pack(scene_, {.direct = settings_.direct});
  progressive.set_scene(packed_, view_);
  expect_as_rendered(progressive);
}

// What the copied command line says: the camera as it is now, and the origin as it was packed.
TEST_F(ProgressiveTest, TheOriginRepeatsAMovedView) {
  open("showcase.glb");
  packed_ = pack(scene_, {.direct = settings_.direct, .eye = view_.position});
  const PackedScene in_window = packed_;
  Progressive progressive(device(), in_window, view_, settings_, kernels());
  progressive.set_view(moved_view());
  packed_ = pack(scene_, {.direct = settings_.direct, .eye = in_window.origin});
  EXPECT_EQ(packed_.origin, in_window.origin);
  expect_as_rendered(progressive);
  packed_ = pack(scene_, {.direct = settings_.direct, .eye = moved_view().position});
  EXPECT_FALSE(progressive.film() == *rendered(moved_view(), settings_).film) << "there was no need of an origin";
}

TEST_F(ProgressiveTest, ShowsACoarsePictureWhileMoving) {
  open("cornell_box.gltf");
  Progressive progressive = begin(); // knows nothing of the device's speed, and so begins as coarse as can be
  progressive.move(view_);
  EXPECT_EQ(progressive.status().coarse, 8u);
  finish(progressive);
  EXPECT_TRUE(progressive.moving());
  EXPECT_FALSE(progressive.status().done) << "the picture of the view follows";
  RenderPlan coarse = settings_;
  coarse.width = 5, coarse.height = 4;
  EXPECT_EQ(progressive.film(), *rendered(view_, coarse).film);
  progressive.rest();
  EXPECT_EQ(progressive.status().coarse, 1u);
  expect_as_rendered(progressive);
  EXPECT_TRUE(progressive.status().done);
}

TEST_F(ProgressiveTest, CompletesAPictureBeforeItFollowsTheNextMove) {
  open("cornell_box.gltf");
  settings_.wave_slots = 8; // three waves for a coarse picture of 5 x 4
  Progressive progressive = begin();
  progressive.move(view_);
  render_some(progressive, 1);
  progressive.move(moved_view());
  EXPECT_EQ(progressive.view().position, view_.position);
  render_some(progressive, 1);
  EXPECT_EQ(progressive.view().position, view_.position);
  render_some(progressive, 1);
  EXPECT_EQ(progressive.view().position, moved_view().position);
  progressive.move(view_);
  progressive.rest();
  EXPECT_FALSE(progressive.moving());
  finish(progressive);
  EXPECT_EQ(progressive.view().position, view_.position);
  EXPECT_EQ(progressive.status().coarse, 1u);
  settings_.wave_slots = 700;
  EXPECT_EQ(progressive.film(), *rendered(view_, settings_).film);
}

TEST_F(ProgressiveTest, TheSceneIsUploadedOnce) {
  open("showcase.glb");
  Progressive progressive = begin();
  finish(progressive);
  const DeviceScene* uploaded = &progressive.device_scene();
  const MemoryUse before = progressive.status().memory;
  for (int i = 0; i < 5; ++i) {
    progressive.move(i % 2 ? view_ : moved_view());
    render_some(progressive, 1);
  }
  progressive.rest();
  RenderPlan smaller = settings_;
  smaller.width = 20;
  smaller.max_depth = 1;
  progressive.set_settings(smaller, view_at({}, 20, settings_.height));
  finish(progressive);
  progressive.set_settings(settings_, view_);
  finish(progressive);
  const MemoryUse after = progressive.status().memory;
  EXPECT_EQ(&progressive.device_scene(), uploaded);
  EXPECT_EQ(after.scene + after.bvh, before.scene + before.bvh);
  EXPECT_EQ(after.paths, before.paths);
  EXPECT_EQ(after.film, before.film);
}

TEST_F(ProgressiveTest, EstimatesTheErrorAsRenderDoes) {
  open("cornell_box.gltf");
  Progressive progressive = begin();
  finish(progressive);
  while (progressive.status().error_spp < settings_.last_sample) step(progressive);
  const ErrorEstimate expected = rendered(view_, settings_).error;
  EXPECT_EQ(progressive.status().error.relative_rms, expected.relative_rms);
  EXPECT_EQ(progressive.status().error.ci95, expected.ci95);
  EXPECT_EQ(progressive.seconds_to(expected.relative_rms), 0.0);
  EXPECT_GT(progressive.seconds_to(0.5 * expected.relative_rms), 0.0);
  progressive.set_view(moved_view());
  EXPECT_EQ(progressive.status().error_spp, 0u) << "of another picture";
  EXPECT_TRUE(std::isinf(progressive.seconds_to(0.1)));
}

// A pass is timed from its own beginning, whatever the device did for the pictures before.
TEST_F(ProgressiveTest, TheTimeOfAFrameIsPositiveAfterEveryView) {
  open("cornell_box.gltf");
  Progressive progressive = begin();
  finish(progressive);
  EXPECT_GT(progressive.status().frame_seconds, 0.0);
  progressive.set_view(moved_view());
  progressive.set_view(view_);
  while (!progressive.status().done) {
    step(progressive);
    EXPECT_GT(progressive.status().frame_seconds, 0.0) << "at " << progressive.status().spp << " samples a pixel";
  }
}

TEST_F(ProgressiveTest, DoesNotWaitForKernels) {
  if (!device().unified_memory()) GTEST_SKIP() << "uploads would wait for the queue, which this test keeps";
  open("cornell_box.gltf");
  KernelCompiler compiler(device());
  Progressive progressive(device(), packed_, view_, settings_, compiler);
  finish(progressive);
  RenderPlan other = settings_;
  other.sampler = gpu::kSamplerIndependent;
  {
    const std::lock_guard kept(device().queue_mutex()); // no kernel can be tried out, and so none gets ready
    progressive.set_settings(other, view_);
    EXPECT_FALSE(progressive.step());
    EXPECT_TRUE(progressive.status().compiling);
    EXPECT_FALSE(progressive.status().done);
  }
  expect_as_rendered(progressive);
  EXPECT_FALSE(progressive.status().compiling);
}

class DisplayTest : public ProgressiveTest {
protected:
  std::vector<std::uint32_t> shown(Display& display, const Progressive& progressive, const DisplayOptions& options) {
    display.draw(progressive, options);
    EXPECT_EQ(display.width(), settings_.width);
    EXPECT_EQ(display.height(), settings_.height);
    return download<std::uint32_t>(display.pixels(), std::size_t{display.width()} * display.height());
  }
  static int byte_of(std::uint32_t word, int channel) { return static_cast<int>(word >> 8 * channel & 0xff); }
  // Every pixel's channels, as values in [0,1] that the host worked out.
  template <class Expected>
  static void expect_shown(const std::vector<std::uint32_t>& words, const Expected& expected) {
    int largest = 0, differing = 0;
    for (std::size_t i = 0; i < words.size(); ++i)
      for (int c = 0; c < 3; ++c) {
        const float value = std::min(std::max(expected(i)[c], 0.0f), 1.0f);
        const int difference = std::abs(byte_of(words[i], c) - static_cast<int>(std::lround(255.0f * value)));
        largest = std::max(largest, difference);
        differing += difference > 0;
      }
    EXPECT_LE(largest, 1);
    EXPECT_LE(differing, static_cast<int>(words.size()) / 10); // where the value is close to the middle of two
  }
};

TEST_F(DisplayTest, EncodesLikeTheFilesThatAreWritten) {
  open("cornell_box.gltf");
  Progressive progressive = begin();
  finish(progressive);
  const Film film = progressive.film();
  Display display(device());
  for (const Tonemap curve : {Tonemap::none, Tonemap::aces, Tonemap::agx, Tonemap::neutral})
    for (const double exposure : {-12.0, -4.0, 0.0, 3.0, 20.0}) {
      SCOPED_TRACE(static_cast<int>(curve) * 100 + exposure);
      const auto words = shown(display, progressive, {.exposure = exposure, .tonemap = curve});
      expect_shown(words, [&](std::size_t i) {
        const glm::vec3 linear =
            tonemap(curve, glm::vec3(mean_radiance(film, i)) * static_cast<float>(std::exp2(exposure)));
        return glm::vec3(to_srgb(linear.r), to_srgb(linear.g), to_srgb(linear.b));
      });
      for (const std::uint32_t word : words) ASSERT_EQ(word >> 24, 255u);
    }
  const auto rgba = shown(display, progressive, {}), bgra = shown(display, progressive, {.bgra = true});
  for (std::size_t i = 0; i < rgba.size(); ++i) {
    ASSERT_EQ(byte_of(rgba[i], 0), byte_of(bgra[i], 2));
    ASSERT_EQ(byte_of(rgba[i], 1), byte_of(bgra[i], 1));
  }
}

TEST_F(DisplayTest, ShowsWhatElseIsKnown) {
  open("cornell_box.gltf");
  settings_.aovs = {"albedo", "normal", "depth", "position", "direct", "indirect", "emission"};
  Progressive progressive = begin();
  finish(progressive);
  const Film film = progressive.film();
  const auto srgb = [](glm::vec3 linear) {
    linear = glm::clamp(linear, 0.0f, 1.0f);
    return glm::vec3(to_srgb(linear.r), to_srgb(linear.g), to_srgb(linear.b));
  };
  const auto toned = [&](const glm::vec3& radiance) { return srgb(tonemap(Tonemap::neutral, radiance)); };
  const auto depth_of = [&](std::size_t i) { return film.aovs[i].hits > 0.0f ? film.aovs[i].depth : 0.0f; };
  Display display(device());
  const auto view = [&](Shown what, double range = 0.0) {
    return shown(display, progressive, {.shown = what, .range = range});
  };
  expect_shown(view(Shown::albedo), [&](std::size_t i) { return srgb(film.aovs[i].albedo); });
  expect_shown(view(Shown::normal), [&](std::size_t i) {
    return film.aovs[i].hits > 0.0f ? 0.5f + 0.5f * film.aovs[i].normal : glm::vec3(0.0f);
  });
  expect_shown(view(Shown::depth, 6.0),
               [&](std::size_t i) { return glm::vec3(film.aovs[i].hits > 0.0f ? 1.0f - depth_of(i) / 6.0f : 0.0f); });
  expect_shown(view(Shown::position, 3.0), [&](std::size_t i) {
    return film.aovs[i].hits > 0.0f ? 0.5f + 0.5f * film.aovs[i].position / 3.0f : glm::vec3(0.0f);
  });
  expect_shown(view(Shown::direct), [&](std::size_t i) { return toned(film.aovs[i].direct); });
  expect_shown(view(Shown::emission), [&](std::size_t i) { return toned(film.aovs[i].emission); });
  expect_shown(view(Shown::indirect), [&](std::size_t i) {
    return toned(glm::vec3(mean_radiance(film, i)) - film.aovs[i].direct - film.aovs[i].emission);
  });
  // A number has one colour, wherever it is.
  const auto materials = view(Shown::materials);
  std::map<std::uint32_t, std::uint32_t> colours;
  for (std::size_t i = 0; i < materials.size(); ++i)
    if (film.aovs[i].hits > 0.0f) {
      EXPECT_EQ(colours.try_emplace(film.aovs[i].material, materials[i]).first->second, materials[i]);
    }
  EXPECT_GE(colours.size(), 3u);
  for (const auto& [material, colour] : colours)
    EXPECT_EQ(std::ranges::count(colours, colour, &std::pair<const std::uint32_t, std::uint32_t>::second), 1)
        << material;
  expect_shown(view(Shown::roughness), [&](std::size_t i) { return glm::vec3(film.aovs[i].roughness); });
  expect_shown(view(Shown::metallic), [&](std::size_t i) { return glm::vec3(film.aovs[i].metallic); });
  expect_shown(view(Shown::samples, 12.0), [&](std::size_t i) { return glm::vec3(sample_count(film, i) / 12.0f); });
  expect_shown(view(Shown::variance), [&](std::size_t i) { return toned(glm::vec3(mean_variance(film, i))); });
  std::vector<float> errors;
  for (std::size_t i = 0; i < film.aovs.size(); ++i) {
    const glm::dvec3 mean = mean_radiance(film, i), relative = mean_variance(film, i) / (mean * mean + 0.01);
    errors.push_back(static_cast<float>(std::sqrt((relative.r + relative.g + relative.b) / 3.0)));
  }
  const Picture map = error_map(film.width, film.height, errors, 0.5);
  expect_shown(view(Shown::error), [&](std::size_t i) {
    return srgb({map.channels[0].values[i], map.channels[1].values[i], map.channels[2].values[i]});
  });
}

// The mean of both replicates of probed pixels, and everywhere the variance that the two tell.
class ErrorProbesDisplay : public DisplayTest, public ::testing::WithParamInterface<std::uint32_t> {};

TEST_P(ErrorProbesDisplay, ShowsBothReplicates) {
  open("cornell_box.gltf");
  settings_.reuse = GetParam();
  settings_.probes_from = 0;
  settings_.aovs = {"albedo", "direct", "indirect", "emission"};
  Progressive progressive = begin();
  expect_as_rendered(progressive);
  const Film film = progressive.film();
  ASSERT_TRUE(film.has_probes);
  ASSERT_EQ(film.quads, GetParam() == kReuseOn);
  Film first = film; // without probes
  for (std::size_t i = film.shape().pixels(); i < first.pixels.size(); ++i) first.pixels[i] = {};
  const auto toned = [](const glm::vec3& radiance) {
    const glm::vec3 linear = tonemap(Tonemap::neutral, radiance);
    return glm::vec3(to_srgb(linear.r), to_srgb(linear.g), to_srgb(linear.b));
  };
  Display display(device());
  const auto view = [&](Shown what, double range = 0.0) {
    return shown(display, progressive, {.shown = what, .range = range});
  };
  expect_shown(view(Shown::color), [&](std::size_t i) { return toned(glm::vec3(mean_radiance(film, i))); });
  expect_shown(view(Shown::samples, 12.0), [&](std::size_t i) { return glm::vec3(sample_count(film, i) / 12.0f); });
  expect_shown(view(Shown::variance), [&](std::size_t i) { return toned(glm::vec3(mean_variance(film, i))); });
  expect_shown(view(Shown::indirect), [&](std::size_t i) {
    return toned(glm::vec3(mean_radiance(first, i)) - film.aovs[i].direct - film.aovs[i].emission);
  });
}

INSTANTIATE_TEST_SUITE_P(PixelsAndQuads, ErrorProbesDisplay, ::testing::Values(kReuseOff, kReuseOn));

TEST_F(DisplayTest, KeepsWhatItShowedUntilThereIsMore) {
  open("cornell_box.gltf");
  Progressive progressive = begin();
  finish(progressive);
  Display display(device());
  const auto before = shown(display, progressive, {});
  progressive.set_view(moved_view());
  EXPECT_EQ(shown(display, progressive, {}), before) << "not a sample of the new picture is there";
  finish(progressive);
  EXPECT_NE(shown(display, progressive, {}), before);
}

TEST_F(DisplayTest, ScalesACoarsePictureUp) {
  open("cornell_box.gltf");
  Progressive progressive = begin();
  progressive.move(view_);
  finish(progressive);
  ASSERT_EQ(progressive.status().coarse, 8u);
  Display display(device());
  const auto words = shown(display, progressive, {});
  const Film film = progressive.film(); // 5 x 4
  expect_shown(words, [&](std::size_t i) {
    const std::size_t x = i % 40 * 5 / 40, y = static_cast<std::size_t>((static_cast<double>(i / 40) + 0.5) * 4 / 29);
    const glm::vec3 linear = tonemap(Tonemap::neutral, glm::vec3(mean_radiance(film, y * 5 + x)));
    return glm::vec3(to_srgb(linear.r), to_srgb(linear.g), to_srgb(linear.b));
  });
}

} // namespace
} // namespace wavepath::test
