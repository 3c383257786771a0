// Hybrid rendering: it agrees with the path tracer on direct light, estimates its own error, has exact occlusion, and
// gives the same bits however the work is cut up. (Analytic scenes: analytic_test.cpp; the rasterizer alone:
// visibility_test.cpp.)
#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "host/film/film.h"
#include "host/integrators/hybrid/hybrid.h"
#include "host/integrators/hybrid/kind.h"
#include "host/integrators/path/kind.h"
#include "host/picture/files/picture_io.h"
#include "host/render/loop/render_state.h"
#include "host/render/render.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/scene/gltf/gltf.h"
#include "host/scene/pack/pack.h"
#include "tests/probe.h"
#include "tests/scene_builder.h"
#include "tests/shared_kernels.h"
#include "tests/statistics.h"

namespace wavepath::test {
namespace {

const std::string kScenes = std::string(WAVEPATH_SOURCE_DIR) + "/scenes/";

// A scene that stays packed, for many renders.
struct Subject {
  Scene scene;
  PackedScene packed;
  View view;

  Subject(Scene source, std::uint32_t width, std::uint32_t height, const ViewRequest& request = {})
      : scene(std::move(source)) {
    view = resolve_view(scene, request, width, height);
    packed = pack(scene);
  }
};

Scene load(const std::string& name, float environment = 0.0f) {
  Scene scene = load_gltf(kScenes + name, {});
  if (environment > 0.0f) scene.environment.radiance = glm::vec3(environment);
  return scene;
}

// Two unlimited-looking parallel squares of side 200, `gap` apart, the eye between them and looking down.
Scene parallel_planes(float gap) {
  Scene scene;
  scene.path = "test";
  scene.materials.push_back(plain_material());
  const auto plane = [&](float y) {
    const glm::vec3 a{-100, y, -100}, b{100, y, -100}, c{100, y, 100}, d{-100, y, 100};
    add_instance(scene, add_mesh(scene, {a, b, c, a, c, d}));
  };
  plane(0.0f);
  plane(gap);
  Camera camera;
  camera.world_from_camera = {{1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}, {0, 0.5 * gap, 0, 1}}; // looks along -y
  scene.cameras.push_back(camera);
  return scene;
}

class HybridTest : public VulkanTest {
protected:
  static RenderPlan settings(const IntegratorKind* integrator, std::uint32_t spp) {
    RenderPlan settings;
    settings.width = 24, settings.height = 16;
    settings.last_sample = spp;
    settings.max_depth = 1;
    settings.integrator = integrator;
    return settings;
  }
  RenderResult render(const Subject& subject, const RenderPlan& settings) {
    KernelCompiler& kernels = shared_kernels(device());
    return wavepath::render(device(), subject.packed, subject.view, settings, RenderHooks{}, kernels);
  }
};

// Pixel by pixel: the differences of two renders, each with the noise of its own, over that noise. Silhouettes are seen
// by the hybrid through one place of the filter for all pixels and so are correlated; blocks would hide that, pixels do
// not.
void expect_same_mean(const std::vector<RenderResult>& a, const std::vector<RenderResult>& b, std::size_t channel) {
  const std::size_t pixels = a[0].picture.channels[channel].values.size();
  double squares = 0.0, largest = 0.0, total = 0.0;
  std::size_t judged = 0;
  for (std::size_t i = 0; i < pixels; ++i) {
    Mean x, y;
    for (const RenderResult& r : a) x.add(r.picture.channels[channel].values[i]);
    for (const RenderResult& r : b) y.add(r.picture.channels[channel].values[i]);
    total += x.mean();
    const double noise = std::hypot(x.error(), y.error());
    if (noise < 1e-6 * (1.0 + x.mean())) {
      EXPECT_NEAR(x.mean(), y.mean(), 2e-5 * (1.0 + x.mean())) << "pixel " << i;
      continue;
    }
    const double z = (x.mean() - y.mean()) / noise;
    squares += z * z;
    largest = std::max(largest, std::abs(z));
    ++judged;
  }
  ASSERT_GT(judged, pixels / 3);
  // With n renders each, z follows Student's t with about 2n - 2 degrees of freedom, whose variance is d / (d - 2).
  const double d = static_cast<double>(a.size() + b.size() - 2), variance = d / (d - 2.0);
  EXPECT_LT(squares / static_cast<double>(judged), variance * (1.0 + 6.0 / std::sqrt(static_cast<double>(judged))));
  EXPECT_LT(largest, 8.0);
  EXPECT_GT(total, 0.0);
}

TEST_F(HybridTest, AgreesWithThePathTracerOnDirectLight) {
  for (const auto& [name, environment, first_hit] :
       std::vector<std::tuple<std::string, float, std::uint32_t>>{{"cornell_box.gltf", 0.0f, kFirstHitTraced},
                                                                  {"showcase.glb", 0.0f, kFirstHitRaster},
                                                                  {"showcase.glb", 0.7f, kFirstHitTraced}}) {
    SCOPED_TRACE(name);
    const Subject subject(load(name, environment), 24, 16);
    std::vector<RenderResult> paths, frames;
    for (std::uint32_t seed = 0; seed < 12; ++seed) {
      RenderPlan path = settings(&kPath, 16), hybrid = settings(&kHybrid, 16);
      path.seed = 2 * seed, hybrid.seed = 2 * seed + 1;
      hybrid.shadow_samples = 2;
      hybrid.first_hit = first_hit;
      paths.push_back(render(subject, path));
      frames.push_back(render(subject, hybrid));
    }
    for (std::size_t channel = 0; channel < 3; ++channel) {
      SCOPED_TRACE(channel);
      expect_same_mean(paths, frames, channel);
    }
  }
}

// But for edges that fall between two places of the rasterizer's grid. On a CPU, many triangles and few pixels are
// traced.
TEST_F(HybridTest, TracedFirstHitsAreTheRasterizedOnes) {
  const Subject subject(load("showcase.glb"), 96, 64);
  RenderPlan one = settings(&kHybrid, 1);
  one.width = 96, one.height = 64;
  const auto picture = [&](std::uint32_t first_hit) {
    one.first_hit = first_hit;
    return render(subject, one).picture.channels[1].values;
  };
  const std::vector<float> rasterized = picture(kFirstHitRaster), traced = picture(kFirstHitTraced);
  std::size_t different = 0;
  for (std::size_t i = 0; i < traced.size(); ++i) different += rasterized[i] != traced[i];
  EXPECT_LT(different, traced.size() / 100);
  ASSERT_GT(subject.packed.triangle_count, traced.size());
  const DeviceInfo& info = device().info();
  EXPECT_EQ(picture(kFirstHitAuto), info.type == "cpu" || info.draws_slowly ? traced : rasterized);
}

// Whole frames of cameras that are shifted or clipped: light and depths where the rasterized points are.
TEST_F(HybridTest, DrawsShiftedAndClippedCameras) {
  ViewRequest shifted{.shift = glm::dvec2(0.2, -0.1)}, clipped{.clip = Clip{7.0, 8.0}};
  for (const ViewRequest& request : {shifted, clipped}) {
    const Subject subject(load("showcase.glb"), 96, 64, request);
    RenderPlan one = settings(&kHybrid, 1);
    one.width = 96, one.height = 64;
    one.aovs = {"depth"};
    const auto picture = [&](std::uint32_t first_hit) {
      one.first_hit = first_hit;
      return render(subject, one).picture;
    };
    const Picture rasterized = picture(kFirstHitRaster), traced = picture(kFirstHitTraced);
    for (const char* name : {"G", "Z"}) {
      const std::vector<float>&a = find_channel(rasterized, name)->values, &b = find_channel(traced, name)->values;
      std::size_t different = 0;
      for (std::size_t i = 0; i < a.size(); ++i) different += a[i] != b[i];
      EXPECT_LT(different, a.size() / 100) << name;
    }
  }
  RenderPlan raster = settings(&kHybrid, 1);
  raster.first_hit = kFirstHitRaster;
  const Subject pair(load("showcase.glb"), 96, 64, {.stereo = 0.1});
  EXPECT_THROW(render(pair, raster), UsageError);
}

TEST(FirstHits, AreTracedWhereThatIsFaster) {
  RenderPlan settings;
  settings.width = settings.height = 100;
  const std::uint64_t few = 10'000, many = 10'001;
  const auto on = [](const char* type, const char* name) {
    return DeviceInfo{.name = name, .type = type, .rasterizes = true, .draws_slowly = draws_slowly(name)};
  };
  const DeviceInfo cpu = on("cpu", "llvmpipe (LLVM 15.0.6, 256 bits)");
  EXPECT_TRUE(rasterizes_first_hits(settings, few, cpu));
  EXPECT_FALSE(rasterizes_first_hits(settings, many, cpu));
  for (const char* name : {"NVIDIA GeForce RTX 4090", "AMD Radeon RX 7900 XTX (RADV NAVI31)", "NVIDIA A100-SXM4-80GB"})
    EXPECT_TRUE(rasterizes_first_hits(settings, many, on("discrete", name))) << name;
  for (const char* name : {"NVIDIA H200", "NVIDIA H100 80GB HBM3", "NVIDIA GH200 480GB", "NVIDIA H20", "NVIDIA H800"}) {
    EXPECT_FALSE(rasterizes_first_hits(settings, few, on("discrete", name))) << name;
    settings.first_hit = kFirstHitRaster;
    EXPECT_TRUE(rasterizes_first_hits(settings, few, on("discrete", name))) << name;
    settings.first_hit = kFirstHitAuto;
  }
  DeviceInfo without = cpu;
  without.rasterizes = false;
  EXPECT_FALSE(rasterizes_first_hits(settings, few, without));
}

TEST_F(HybridTest, KnowsItsError) {
  const Subject subject(load("analytic/half_hidden_disc_light.gltf"), 24, 16); // all pixels alike, no edges among them
  constexpr double kTruth[] = {0.3195888, 0.0998715, 0.0199743};               // of the scene's own oracle
  for (const std::uint32_t shadow_samples : {1u, 2u, 3u}) {
    Mean estimated[3], actual[3];
    for (std::uint32_t seed = 0; seed < 12; ++seed) {
      RenderPlan coarse = settings(&kHybrid, 8);
      coarse.shadow_samples = shadow_samples;
      coarse.seed = seed;
      const RenderResult result = render(subject, coarse);
      glm::dvec3 squares(0.0), variance(0.0);
      for (std::size_t i = 0; i < 24 * 16; ++i) {
        for (int c = 0; c < 3; ++c)
          squares[c] += std::pow(result.picture.channels[static_cast<std::size_t>(c)].values[i] - kTruth[c], 2);
        variance += mean_variance(*result.film, i);
      }
      for (int c = 0; c < 3; ++c) actual[c].add(squares[c]), estimated[c].add(variance[c]);
    }
    for (int c = 0; c < 3; ++c) {
      SCOPED_TRACE(testing::Message() << shadow_samples << " light samples, channel " << c);
      const double noise = std::hypot(estimated[c].error() / estimated[c].mean(), actual[c].error() / actual[c].mean());
      EXPECT_NEAR(estimated[c].mean() / actual[c].mean(), 1.0, 4.0 * noise);
      EXPECT_LT(noise, 0.15);
    }
  }
}

TEST_F(HybridTest, MoreLightSamplesMeanLessNoise) {
  const Subject subject(load("analytic/half_hidden_disc_light.gltf"), 24, 16); // a plane alone: no edges in the picture
  const auto noise = [&](std::uint32_t samples) {
    RenderPlan one = settings(&kHybrid, 4);
    one.sampler = gpu::kSamplerIndependent;
    one.shadow_samples = samples;
    const RenderResult result = render(subject, one);
    glm::dvec3 variance(0.0);
    for (std::size_t i = 0; i < 24 * 16; ++i) variance += mean_variance(*result.film, i);
    return variance;
  };
  const glm::dvec3 ratio = noise(1) / noise(16);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(ratio[c], 16.0, 5.0) << c; // from 384 pixels each variance is known to 7 %
}

// The scenes' cameras see one point, too small an extent for a rasterizer, so that such frames are traced
// (analytic_test.cpp has them); a wider one shows the same values.
TEST_F(HybridTest, OcclusionIsExact) {
  const std::vector<std::pair<std::string, double>> oracles{
      {"by_wall", 0.8535534}, {"in_corner", 0.25}, {"in_open_box", 0.2394565}, {"in_wedge", 0.5}};
  for (const auto& [name, expected] : oracles)
    for (const std::uint32_t samples : {1u, 5u}) {
      const Subject subject(load("analytic/occlusion_" + name + ".gltf"), 24, 16, {.yfov = 0.1});
      RenderPlan ao = settings(&kAo, 64);
      ao.ao_samples = samples;
      const Picture picture = render(subject, ao).picture;
      for (std::size_t channel = 0; channel < 3; ++channel) {
        Mean mean;
        for (const float value : picture.channels[channel].values) mean.add(value);
        EXPECT_NEAR(mean.mean(), expected, 4.5 * mean.error() + 3e-4 * expected) << name << ", channel " << channel;
        EXPECT_LT(mean.error(), 0.01 * expected) << name << ", channel " << channel;
      }
    }
}

TEST_F(HybridTest, OcclusionEndsAtItsRadius) {
  constexpr float kGap = 1.0f;
  const Subject subject(parallel_planes(kGap), 24, 16);
  // Directions with cos > gap/radius meet the other plane: of the cosine-weighted hemisphere 1 - (gap/radius)^2.
  for (const double radius : {0.9, 1.25, 2.0, 5.0}) {
    RenderPlan ao = settings(&kAo, 64);
    ao.ao_samples = 4;
    ao.ao_radius = radius;
    const Picture picture = render(subject, ao).picture;
    Mean mean;
    for (const float value : picture.channels[0].values) mean.add(value);
    const double expected = radius < kGap ? 1.0 : 1.0 / (radius * radius);
    EXPECT_NEAR(mean.mean(), expected, 4.5 * mean.error() + 1e-6) << radius;
  }
}

TEST_F(HybridTest, OcclusionAloneRunsNothingElse) {
  const Subject subject(load("cornell_box.gltf"), 24, 16);
  const RenderResult result = render(subject, settings(&kAo, 2));
  for (const StageTime& stage : result.stages)
    EXPECT_TRUE(stage.name == "raster" || stage.name == "jitter" || stage.name == "resolve" ||
                stage.name == "occlusion" || stage.name == "composite")
        << stage.name;
  EXPECT_EQ(result.rays.camera + result.rays.bounce + result.rays.shadow, 0u);
  EXPECT_GT(result.rays.occlusion, 0u);
}

TEST_F(HybridTest, TheAmbientTermIsAlbedoTimesRadianceTimesOcclusion) {
  const Subject subject(load("cornell_box.gltf"), 24, 16);
  RenderPlan hybrid = settings(&kHybrid, 1);
  hybrid.max_depth = 8;
  hybrid.ambient = glm::vec3(0.25f, 0.5f, 1.0f);
  hybrid.aovs = {"albedo", "ao", "direct", "emission", "indirect"};
  const Picture picture = render(subject, hybrid).picture;
  const auto channel = [&](const std::string& name) -> const std::vector<float>& {
    return std::ranges::find(picture.channels, name, &Channel::name)->values;
  };
  double sum = 0.0;
  for (std::size_t i = 0; i < channel("ao").size(); ++i) {
    EXPECT_NEAR(channel("indirect.R")[i], channel("albedo.R")[i] * 0.25f * channel("ao")[i], 1e-5f);
    EXPECT_NEAR(channel("indirect.G")[i], channel("albedo.G")[i] * 0.5f * channel("ao")[i], 1e-5f);
    EXPECT_NEAR(channel("indirect.B")[i], channel("albedo.B")[i] * 1.0f * channel("ao")[i], 1e-5f);
    sum += channel("ao")[i];
  }
  EXPECT_GT(sum, 0.0);
}

// In a closed white sphere of any shape the estimate is exact: L = direct / (1 - albedo).
TEST_F(HybridTest, EstimatesTheAmbientLightOfAnEnclosure) {
  const Subject subject(load("analytic/point_light_in_sphere.gltf"), 24, 16);
  RenderPlan hybrid = settings(&kHybrid, 4);
  hybrid.max_depth = 8;
  const RenderResult result = render(subject, hybrid);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(result.ambient[c], 1.0, 0.02) << c; // as the scene's own oracle has it
}

// The pilot measures with rays of its own length and seed; the picture is that of the light which it found.
TEST_F(HybridTest, EstimatingTheAmbientLightLeavesNoTrace) {
  const Subject subject(load("cornell_box.gltf"), 24, 16);
  RenderPlan hybrid = settings(&kHybrid, 2);
  hybrid.max_depth = 8;
  hybrid.aovs = {"ao"};
  const RenderResult estimated = render(subject, hybrid);
  ASSERT_GT(estimated.ambient.g, 0.0f);
  hybrid.ambient = estimated.ambient;
  EXPECT_TRUE(*render(subject, hybrid).film == *estimated.film);
}

TEST_F(HybridTest, GivesTheSameBitsHoweverTheWorkIsCutUp) {
  for (const char* name : {"cornell_box.gltf", "showcase.glb"}) {
    SCOPED_TRACE(name);
    const Subject subject(load(name, 0.3f), 24, 16);
    RenderPlan whole = settings(&kHybrid, 6);
    whole.max_depth = 4;
    whole.shadow_samples = 3, whole.ao_samples = 2;
    whole.aovs = {"albedo", "normal", "depth", "position", "ao"};
    const RenderResult expected = render(subject, whole);
    for (const std::uint32_t slots : {64u, 1000u}) {
      RenderPlan cut = whole;
      cut.wave_slots = slots;
      EXPECT_TRUE(*render(subject, cut).film == *expected.film) << slots;
    }
    RenderPlan generic = whole;
    generic.specialize = false;
    EXPECT_TRUE(*render(subject, generic).film == *expected.film);
    EXPECT_TRUE(*render(subject, whole).film == *expected.film);
  }
}

// Paths in flight for one pixel alone, which takes a slot for every light sample.
TEST_F(HybridTest, OnePixelHasRoomForItsLightSamples) {
  const Subject subject(parallel_planes(1.0f), 1, 1);
  RenderPlan one = settings(&kHybrid, 1);
  one.width = one.height = 1;
  one.shadow_samples = kMostFrameRays;
  // By kernels of its own: those of other tests that would do as well may know of lobes whose samples point down.
  KernelCompiler kernels(device());
  const RenderResult result = wavepath::render(device(), subject.packed, subject.view, one, RenderHooks{}, kernels);
  EXPECT_EQ(result.rays.bounce, kMostFrameRays);
}

TEST_F(HybridTest, PartsJoinToTheWhole) {
  const Subject subject(load("cornell_box.gltf"), 24, 16);
  RenderPlan whole = settings(&kHybrid, 7);
  whole.max_depth = 4;
  whole.shadow_samples = 2;
  RenderPlan first = whole, second = whole;
  first.last_sample = second.first_sample = 3;
  first.sample_total = second.sample_total = 7;
  Film joined = *render(subject, first).film;
  join(joined, *render(subject, second).film);
  EXPECT_TRUE(joined == *render(subject, whole).film);
}

TEST_F(HybridTest, ResumedRendersGiveTheSameBits) {
  const Subject subject(load("showcase.glb"), 24, 16);
  RenderPlan whole = settings(&kHybrid, 6);
  whole.max_depth = 4;
  KernelCompiler kernels(device());
  const RenderResult expected = wavepath::render(device(), subject.packed, subject.view, whole, RenderHooks{}, kernels);
  RenderPlan half = whole;
  half.last_sample = 3, half.sample_total = 6;
  std::optional<RenderState> state;
  RenderHooks saving;
  saving.save = [&](const RenderState& saved) { state = saved; };
  wavepath::render(device(), subject.packed, subject.view, half, saving, kernels);
  ASSERT_TRUE(state);
  RenderHooks resuming;
  resuming.resume = &*state;
  const RenderResult resumed = wavepath::render(device(), subject.packed, subject.view, whole, resuming, kernels);
  EXPECT_TRUE(*resumed.film == *expected.film);
  EXPECT_EQ(resumed.rays.total(), expected.rays.total()) << "the estimate of the ambient light counts once";
}

} // namespace
} // namespace wavepath::test
