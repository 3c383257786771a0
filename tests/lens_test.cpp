// The thin lens against exact answers: the circle of confusion and its shape, what stays sharp, energy, the distance
// focused on by itself, and that the points on the lens are stratified.
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "host/integrators/bidirectional/kind.h"
#include "host/integrators/hybrid/antialias/catalogue.h"
#include "host/integrators/hybrid/kind.h"
#include "host/integrators/path/kind.h"
#include "host/integrators/whitted/kind.h"
#include "host/picture/files/picture_io.h"
#include "host/render/render.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"
#include "tests/shining_disc.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {
namespace {

// Pixels of a metre across the view axis, `depth` metres away; and of the radius of what a lens of diameter 1 makes of
// a point there, by similar triangles.
double pixels_of_metre(bool orthographic, double depth) { return orthographic ? kScale : kScale / depth; }
double confusion(bool orthographic, double focus, double depth) {
  return pixels_of_metre(orthographic, depth) * 0.5 * std::abs(depth - focus) / focus;
}

struct Lens {
  bool orthographic = false;
  double aperture = 0.2;
  std::optional<double> focus = 2.0;
  std::uint32_t blades = 0;
};

class LensTest : public VulkanTest {
protected:
  static inline std::unique_ptr<KernelCompiler> kernels_;
  static void TearDownTestSuite() { kernels_.reset(); }

  static RenderPlan settings(const Lens& lens, std::uint32_t spp, const IntegratorKind& integrator = kPath) {
    RenderPlan asked;
    asked.width = asked.height = kSide;
    asked.last_sample = spp;
    asked.max_depth = 0;
    asked.filter = gpu::kFilterBox;
    asked.integrator = &integrator;
    asked.lens.aperture = lens.aperture, asked.lens.focus = lens.focus, asked.lens.blades = lens.blades;
    return asked;
  }
  RenderResult render(Scene scene, const RenderPlan& asked, bool orthographic) {
    if (!kernels_) kernels_ = std::make_unique<KernelCompiler>(device());
    const PackedScene packed = pack(scene);
    return wavepath::render(device(), packed, view_along_z(orthographic), asked, RenderHooks{}, *kernels_);
  }
  std::vector<float> red(const Scene& scene, const RenderPlan& asked, bool orthographic) {
    return render(scene, asked, orthographic).picture.channels[0].values;
  }
};

// Offset of a pixel's middle from the middle of the picture.
glm::dvec2 offset_of(std::size_t pixel) {
  return glm::dvec2(static_cast<double>(pixel % kSide), static_cast<double>(pixel / kSide)) + 0.5 - 0.5 * kSide;
}

double sum_of(const std::vector<float>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

// The image of a disc is that disc spread over the lens: an even spot as bright as the ratio of their areas, within the
// sum of the radii, and no light is lost. Before and behind the plane of focus.
TEST_F(LensTest, CircleOfConfusion) {
  constexpr double kDisc = 2.0, kBlur = 10.0; // pixels, radii
  constexpr double kLight = kRadiance * kPi * kDisc * kDisc, kExpected = kLight / (kPi * kBlur * kBlur);
  for (const bool orthographic : {false, true})
    for (const double depth : {1.2, 3.0}) {
      SCOPED_TRACE(testing::Message() << (orthographic ? "orthographic " : "perspective ") << depth);
      Lens lens{.orthographic = orthographic};
      lens.aperture = kBlur / confusion(orthographic, *lens.focus, depth);
      const Scene scene = disc_scene(depth, kDisc / pixels_of_metre(orthographic, depth));
      const auto image = red(scene, settings(lens, 2048), orthographic);
      double inside = 0.0;
      std::size_t count = 0;
      for (std::size_t i = 0; i < image.size(); ++i) {
        const double distance = glm::length(offset_of(i));
        if (distance > kBlur + kDisc + 0.71) {
          ASSERT_EQ(image[i], 0.0f) << "light beyond the spot, pixel " << i;
        }
        if (distance > kBlur - kDisc - 0.71) continue;
        ASSERT_NEAR(image[i], kExpected, 0.35 * kExpected) << "pixel " << i;
        inside += image[i], ++count;
      }
      EXPECT_NEAR(inside / static_cast<double>(count), kExpected, 0.01 * kExpected);
      EXPECT_NEAR(sum_of(image), kLight, 0.01 * kLight);
    }
}

// The spot has the shape of the aperture and its area: one corner up for what is behind the plane of focus, and upside
// down before it, where rays have not crossed yet.
TEST_F(LensTest, BladesShapeTheSpot) {
  constexpr double kDisc = 1.5, kBlur = 14.0; // pixels; to the corners
  for (const std::uint32_t blades : {3u, 5u, 6u})
    for (const double depth : {1.2, 3.0}) {
      SCOPED_TRACE(testing::Message() << blades << " blades, depth " << depth);
      Lens lens{.blades = blades};
      lens.aperture = kBlur / confusion(false, *lens.focus, depth);
      const auto image = red(disc_scene(depth, kDisc / pixels_of_metre(false, depth)), settings(lens, 2048), false);
      const double light = kRadiance * kPi * kDisc * kDisc;
      const double expected = light / (0.5 * blades * std::sin(2.0 * kPi / blades) * kBlur * kBlur);
      // How far a place is beyond the nearest edge, pixels.
      const auto beyond = [&](glm::dvec2 at) {
        if (depth > *lens.focus) at.y = -at.y; // rows go down
        double farthest = -kBlur;
        for (std::uint32_t i = 0; i < blades; ++i) {
          const double normal = kPi * (2.0 * i + 1.0) / blades + 0.5 * kPi;
          farthest = std::max(farthest, glm::dot(at, glm::dvec2(std::cos(normal), std::sin(normal))));
        }
        return farthest - kBlur * std::cos(kPi / blades);
      };
      double inside = 0.0;
      std::size_t count = 0;
      for (std::size_t i = 0; i < image.size(); ++i) {
        const double out = beyond(offset_of(i));
        if (out > kDisc + 0.71) {
          ASSERT_EQ(image[i], 0.0f) << "light beyond the polygon, pixel " << i;
        }
        if (out > -kDisc - 0.71) continue;
        inside += image[i], ++count;
      }
      ASSERT_GT(count, 50u);
      EXPECT_NEAR(inside / static_cast<double>(count), expected, 0.015 * expected);
      EXPECT_NEAR(sum_of(image), light, 0.01 * light);
    }
}

// Points in the plane of focus are where a pinhole has them, by whichever way they come: but for rounding at edges the
// same picture, of the same samples.
TEST_F(LensTest, WhatIsInFocusIsSharp) {
  for (const bool orthographic : {false, true})
    for (const std::uint32_t blades : {0u, 6u}) {
      const Scene scene = disc_scene(2.0, 0.3);
      const Lens lens{.orthographic = orthographic, .aperture = 0.5, .blades = blades};
      const auto image = red(scene, settings(lens, 64), orthographic);
      const auto pinhole = red(scene, settings({.aperture = 0.0}, 64), orthographic);
      double difference = 0.0;
      for (std::size_t i = 0; i < image.size(); ++i) difference += std::abs(image[i] - pinhole[i]);
      EXPECT_LT(difference, 1e-4 * sum_of(pinhole));
      EXPECT_GT(sum_of(pinhole), 50.0 * kRadiance);
    }
}

// In a white furnace whatever is seen, and however blurred, has radiance 1.
TEST_F(LensTest, LosesNoEnergy) {
  Scene scene = disc_scene(3.0, 0.8);
  scene.materials[0].emission = glm::vec3(0.0f);
  scene.materials[0].base_color = glm::vec4(1.0f);
  scene.environment.radiance = glm::vec3(1.0f);
  for (const IntegratorKind* kind : {&kPath, &kWhitted, &kBidirectional})
    for (const bool orthographic : {false, true})
      for (const std::uint32_t blades : {0u, 5u}) {
        SCOPED_TRACE(testing::Message() << kind->name << (orthographic ? " orthographic " : " perspective ") << blades);
        RenderPlan asked = settings({.aperture = 1.0, .blades = blades}, 32, *kind);
        asked.max_depth = 1;
        const auto image = red(scene, asked, orthographic);
        EXPECT_NEAR(sum_of(image) / (kSide * kSide), 1.0, 0.005);
      }
}

// Focus follows what the middle of the picture shows: the disc.
TEST_F(LensTest, FocusesOnTheMiddleByItself) {
  for (const bool orthographic : {false, true}) {
    const Scene scene = disc_scene(3.0, 0.3);
    const auto found = red(scene, settings({.focus = std::nullopt}, 4), orthographic);
    const auto given = red(scene, settings({.focus = 3.0}, 4), orthographic);
    double difference = 0.0; // the distance found is rounded
    for (std::size_t i = 0; i < found.size(); ++i) difference += std::abs(found[i] - given[i]);
    EXPECT_LT(difference, 1e-4 * sum_of(given));
    EXPECT_NE(found, red(scene, settings({.focus = 2.0}, 4), orthographic));
  }
}

// Frames that are spread after they are done, seen at pixel centres.
class FrameLensTest : public LensTest {
protected:
  static RenderPlan settings(const Lens& lens) {
    RenderPlan asked = LensTest::settings(lens, 1, kHybrid);
    const std::vector<std::string_view> names = kAntialiasTechniques.names();
    asked.antialias = static_cast<std::uint32_t>(std::ranges::find(names, "none") - names.begin());
    return asked;
  }
};

// As CircleOfConfusion: the pixels of the disc, each spread over the circle that its depth has in closed form. It has
// no noise, so the bounds are those of discs of pixels.
TEST_F(FrameLensTest, PixelsSpreadOverTheirCircles) {
  constexpr double kDisc = 2.0, kBlur = 10.0; // pixels, radii
  for (const bool orthographic : {false, true})
    for (const double depth : {1.2, 3.0}) {
      SCOPED_TRACE(testing::Message() << (orthographic ? "orthographic " : "perspective ") << depth);
      Lens lens{.orthographic = orthographic};
      lens.aperture = kBlur / confusion(orthographic, *lens.focus, depth);
      const Scene scene = disc_scene(depth, kDisc / pixels_of_metre(orthographic, depth));
      const double light = sum_of(red(scene, settings({.aperture = 0.0}), orthographic));
      const double expected = light / (kPi * kBlur * kBlur);
      EXPECT_GT(light, 8 * kRadiance);
      const auto image = red(scene, settings(lens), orthographic);
      for (std::size_t i = 0; i < image.size(); ++i) {
        const double distance = glm::length(offset_of(i));
        if (distance > kBlur + kDisc + 0.71) {
          ASSERT_EQ(image[i], 0.0f) << "light beyond the spot, pixel " << i;
        }
        if (distance < kBlur - kDisc - 0.71) {
          ASSERT_NEAR(image[i], expected, 0.01 * expected) << "pixel " << i;
        }
      }
      EXPECT_NEAR(sum_of(image), light, 1e-4 * light);
    }
}

TEST_F(FrameLensTest, WhatIsInFocusKeepsItsBits) {
  for (const bool orthographic : {false, true}) {
    const Scene scene = disc_scene(2.0, 0.3);
    EXPECT_EQ(red(scene, settings({.orthographic = orthographic, .aperture = 0.5}), orthographic),
              red(scene, settings({.aperture = 0.0}), orthographic));
  }
}

// A disc before a plane, the plane or neither in focus, against the lens itself: what it changes is found to a fifth.
TEST_F(FrameLensTest, ComesNearToTheLens) {
  Scene scene = disc_scene(1.5, 0.3);
  Material plane = scene.materials[0];
  plane.emission = glm::vec3(0.4f * kRadiance);
  scene.materials.push_back(plane);
  add_instance(scene, add_mesh(scene, {{-9, -9, -3}, {9, -9, -3}, {0, 18, -3}}, 1));
  for (const double focus : {3.0, 1.0}) {
    const Lens lens{.aperture = 0.25, .focus = focus};
    const auto truth = red(scene, LensTest::settings(lens, 256), false), found = red(scene, settings(lens), false),
               pinhole = red(scene, settings({.aperture = 0.0}), false);
    const auto error = [&](const std::vector<float>& image) {
      double sum = 0.0;
      for (std::size_t i = 0; i < image.size(); ++i) sum += (image[i] - truth[i]) * (image[i] - truth[i]);
      return std::sqrt(sum / static_cast<double>(image.size()));
    };
    EXPECT_LT(error(found), 0.2 * error(pinhole)) << focus;
  }
}

// Depth and position are those of what the ray through the lens meets.
TEST_F(LensTest, AovsAreOfTheRayThroughTheLens) {
  RenderPlan asked = settings({.aperture = 0.1}, 8);
  asked.aovs = {"depth"};
  const Picture picture = render(disc_scene(3.0, 10.0), asked, false).picture;
  for (const float depth : find_channel(picture, "Z")->values) ASSERT_NEAR(depth, 3.0f, 1e-5f);
}

TEST_F(LensTest, SameBitsHoweverTheWorkIsCut) {
  const Scene scene = disc_scene(1.2, 0.2);
  RenderPlan asked = settings({.blades = 7}, 5);
  const RenderResult expected = render(scene, asked, false);
  asked.wave_slots = 700;
  EXPECT_TRUE(*render(scene, asked, false).film == *expected.film);
  asked.wave_slots = 0, asked.specialize = false;
  EXPECT_TRUE(*render(scene, asked, false).film == *expected.film);
}

// Variance of pixels in the spot of a large disc, where the lens alone decides what a sample sees. Independent points
// make it go by 1/n; those of a net see an edge across the square, for which it goes by n^-3/2 (Owen-scrambled nets in
// two dimensions).
TEST_F(LensTest, PointsOnTheLensAreStratified) {
  const Scene scene = disc_scene(6.0, 0.9);
  const auto variance = [&](std::uint32_t sampler, std::uint32_t spp, std::uint32_t blades) {
    constexpr std::uint32_t kSeeds = 6;
    RenderPlan asked = settings({.aperture = 0.9, .focus = 1.0, .blades = blades}, spp);
    asked.sampler = sampler;
    asked.probes_from = 0;
    std::vector<double> sum(kSide * kSide), squares(kSide * kSide);
    for (asked.seed = 0; asked.seed < kSeeds; ++asked.seed) {
      const auto image = red(scene, asked, false);
      for (std::size_t i = 0; i < image.size(); ++i) sum[i] += image[i], squares[i] += double{image[i]} * image[i];
    }
    double total = 0.0;
    for (std::size_t i = 0; i < sum.size(); ++i) total += (squares[i] - sum[i] * sum[i] / kSeeds) / (kSeeds - 1);
    return total;
  };
  for (const std::uint32_t blades : {0u, 6u}) {
    SCOPED_TRACE(blades);
    const double net = variance(gpu::kSamplerSobol, 16, blades) / variance(gpu::kSamplerSobol, 256, blades);
    const double independent =
        variance(gpu::kSamplerIndependent, 16, blades) / variance(gpu::kSamplerIndependent, 256, blades);
    EXPECT_NEAR(independent, 16.0, 3.0);
    EXPECT_GT(net, 30.0); // 64 if nothing but the lens mattered
  }
}

} // namespace
} // namespace wavepath::test
