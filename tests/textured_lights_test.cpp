// Lamps with emission textures over a floor: every estimator beside the integral of what filtered look-ups yield.
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "host/film/film.h"
#include "host/integrators/bidirectional/kind.h"
#include "host/integrators/path/kind.h"
#include "host/render/render.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"
#include "tests/scene_builder.h"
#include "tests/shared_kernels.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {
namespace {

constexpr double kHeight = 2.0, kHalfFloor = 1.5;

// A lamp of 1 m x 1 m that faces down, and what of its texture is lit.
struct TexturedLamp {
  int size = 256, x = 200, y = 100, side = 4, stride = 1 << 20; // a lit block, and again every `stride` texels
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
  glm::vec2 lo{0.0f}, hi{1.0f};
  glm::mat2 matrix{1.0f};
  glm::vec2 offset{0.0f};
  bool second = false; // TEXCOORD_1

  bool is_lit(int column, int row) const {
    const auto within = [&](int at, int first) { return at >= first && (at - first) % stride < side; };
    return within(column, x) && within(row, y);
  }
};

Scene scene_of(const TexturedLamp& lamp) {
  Scene scene;
  scene.path = "test";
  Material floor = plain_material(), emitter = plain_material();
  floor.base_color = {0.5f, 0.5f, 0.5f, 1.0f};
  emitter.base_color = {0, 0, 0, 1};
  emitter.emission = glm::vec3(100.0f);
  emitter.double_sided = false;
  Image& image = scene.images.emplace_back();
  image.width = image.height = static_cast<std::uint32_t>(lamp.size);
  for (int row = 0; row < lamp.size; ++row)
    for (int column = 0; column < lamp.size; ++column) {
      const std::uint8_t g = lamp.is_lit(column, row) ? 255 : 0;
      image.bytes.insert(image.bytes.end(), {g, g, g, 255});
    }
  emitter.emission_texture = {
      .image = 0, .wrap_u = lamp.wrap_u, .wrap_v = lamp.wrap_v, .uv_set = lamp.second ? 1u : 0u};
  emitter.emission_texture.uv_matrix = lamp.matrix;
  emitter.emission_texture.uv_offset = lamp.offset;
  scene.materials = {floor, emitter};
  add_instance(scene, add_mesh(scene, {{-2, 0, 2}, {2, 0, 2}, {2, 0, -2}, {-2, 0, 2}, {2, 0, -2}, {-2, 0, -2}}));
  const float h = static_cast<float>(kHeight);
  const std::vector<glm::vec2> corners = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
  std::vector<glm::vec3> positions;
  for (const glm::vec2& c : corners) positions.emplace_back(c.x - 0.5f, h, c.y - 0.5f);
  const std::uint32_t mesh = add_mesh(scene, positions, 1);
  for (const glm::vec2& c : corners) {
    const glm::vec2 uv = lamp.lo + c * (lamp.hi - lamp.lo);
    scene.meshes[mesh].uvs[0].push_back(lamp.second ? glm::vec2(0.0f) : uv);
    if (lamp.second) scene.meshes[mesh].uvs[1].push_back(uv);
  }
  add_instance(scene, mesh);
  Camera camera;
  camera.orthographic = true;
  camera.xmag = camera.ymag = kHalfFloor;
  camera.world_from_camera = {{1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}, {0, 1, 0, 1}};
  scene.cameras.push_back(camera);
  return scene;
}

double looked_up(const TexturedLamp& lamp, const glm::dvec2& uv) {
  const auto texel = [&](int i, Wrap wrap) {
    if (wrap == Wrap::clamp) return std::clamp(i, 0, lamp.size - 1);
    const int period = wrap == Wrap::mirror ? 2 * lamp.size : lamp.size;
    i = ((i % period) + period) % period;
    return i < lamp.size ? i : period - 1 - i;
  };
  const glm::dvec2 place = uv * double(lamp.size) - 0.5, first = glm::floor(place), w = place - first;
  const auto lit = [&](int i, int j) {
    return lamp.is_lit(texel(static_cast<int>(first.x) + i, lamp.wrap_u),
                       texel(static_cast<int>(first.y) + j, lamp.wrap_v))
               ? 1.0
               : 0.0;
  };
  return (1 - w.y) * ((1 - w.x) * lit(0, 0) + w.x * lit(1, 0)) + w.y * ((1 - w.x) * lit(0, 1) + w.x * lit(1, 1));
}

// The floor's radiance in every pixel: a sum over points of the lamp.
std::vector<double> expected_floor(const TexturedLamp& lamp, int pixels) {
  struct Point {
    double x, z, power;
  };
  std::vector<Point> points;
  constexpr int kSide = 1536;
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      const glm::dvec2 c((i + 0.5) / kSide, (j + 0.5) / kSide);
      const glm::dvec2 uv =
          glm::dmat2(lamp.matrix) * (glm::dvec2(lamp.lo) + c * glm::dvec2(lamp.hi - lamp.lo)) + glm::dvec2(lamp.offset);
      const double lit = looked_up(lamp, uv);
      if (lit > 0.0) points.push_back({c.x - 0.5, c.y - 0.5, 100.0 * lit / (double(kSide) * kSide)});
    }
  const std::size_t step = std::max<std::size_t>(points.size() / 4000, 1) | 1; // of many, some
  std::vector<double> floor(std::size_t(pixels) * pixels);
  for (int row = 0; row < pixels; ++row)
    for (int column = 0; column < pixels; ++column) {
      const double x = kHalfFloor * (2.0 * (column + 0.5) / pixels - 1.0),
                   z = kHalfFloor * (2.0 * (row + 0.5) / pixels - 1.0);
      double sum = 0.0;
      for (std::size_t k = 0; k < points.size(); k += step) {
        const double d2 =
            (points[k].x - x) * (points[k].x - x) + (points[k].z - z) * (points[k].z - z) + kHeight * kHeight;
        sum += points[k].power * kHeight * kHeight / (d2 * d2);
      }
      floor[std::size_t(row) * pixels + column] = sum * double(step) * 0.5 / std::numbers::pi;
    }
  return floor;
}

// Of green, relative: of the mean picture, and root-mean-square over the pixels.
struct FloorError {
  double mean = 0.0, rms = 0.0;
};

class TexturedLights : public VulkanTest {
protected:
  FloorError error(const TexturedLamp& lamp, const std::vector<double>& floor, RenderPlan settings) {
    settings.width = settings.height = 64;
    settings.last_sample = 64;
    settings.max_depth = 1;
    settings.filter = gpu::kFilterBox;
    Scene scene = scene_of(lamp);
    const View view = resolve_view(scene, {}, settings.width, settings.height);
    const PackedScene packed = pack(scene, {.direct = settings.direct, .lights = settings.lights});
    const RenderResult result = render(device(), packed, view, settings, RenderHooks{}, shared_kernels(device()));
    double sum = 0.0, mean = 0.0;
    const std::vector<float>& green = result.picture.channels[1].values;
    const double one = 1.0 / static_cast<double>(floor.size());
    for (std::size_t i = 0; i < floor.size(); ++i) {
      const double off = green[i] / floor[i] - 1.0;
      sum += one * off * off, mean += one * off;
    }
    return {std::abs(mean), std::sqrt(sum)};
  }
  // Without cuts where filtering reaches, the reported lamp has a mean 54 % too bright by nee alone.
  static void expect_small(const FloorError& error) {
    EXPECT_LT(error.mean, 0.002);
    EXPECT_LT(error.rms, 0.03);
  }

  void expect_exact(const TexturedLamp& lamp) {
    const std::vector<double> floor = expected_floor(lamp, 64);
    RenderPlan settings;
    settings.integrator = &kPath;
    for (const std::uint32_t direct : {gpu::kDirectNee, gpu::kDirectMis}) {
      settings.direct = direct;
      SCOPED_TRACE(direct);
      expect_small(error(lamp, floor, settings));
    }
  }
};

TEST_F(TexturedLights, AreExactWhereverTheBlockLies) {
  for (const TexturedLamp& lamp :
       {TexturedLamp{}, TexturedLamp{.x = 198, .y = 99}, TexturedLamp{.x = 64, .y = 64, .side = 1},
        TexturedLamp{.size = 1024, .x = 511, .y = 300, .side = 4}}) {
    SCOPED_TRACE(lamp.x);
    expect_exact(lamp);
  }
}

TEST_F(TexturedLights, AreExactAcrossSeams) {
  for (const Wrap wrap : {Wrap::repeat, Wrap::mirror, Wrap::clamp}) {
    SCOPED_TRACE(static_cast<int>(wrap));
    expect_exact({.x = 252, .y = 0, .wrap_u = wrap, .wrap_v = wrap, .lo = {-0.4f, -0.4f}, .hi = {1.3f, 1.3f}});
  }
}

TEST_F(TexturedLights, AreExactHoweverTheTextureIsPlaced) {
  expect_exact({.x = 120, .y = 128, .matrix = {0.8f, 0.6f, -0.6f, 0.8f}, .offset = {0.3f, -0.1f}});
  expect_exact({.x = 120, .y = 128, .matrix = {-1.5f, 0.0f, 0.0f, 1.2f}, .offset = {1.2f, 0.0f}, .second = true});
  expect_exact(
      {.size = 64, .x = 31, .y = 30, .side = 2, .lo = {3.0f, 3.0f}, .hi = {-3.0f, -3.0f}}); // 36 tiles, mirrored
}

TEST_F(TexturedLights, AreExactByEveryWayToPickThem) {
  const TexturedLamp lamp;
  const std::vector<double> floor = expected_floor(lamp, 64);
  RenderPlan settings;
  settings.integrator = &kPath;
  settings.lights = gpu::kLightsTree;
  expect_small(error(lamp, floor, settings));
  settings.lights = gpu::kLightsLearned;
  expect_small(error(lamp, floor, settings));
  settings.lights = gpu::kLightsPower;
  settings.integrator = &kBidirectional;
  expect_small(error(lamp, floor, settings));
}

// A lamp of which chance finds enough: rays alone agree with light samples.
TEST_F(TexturedLights, AgreeWithRaysAlone) {
  const TexturedLamp lamp{.size = 64, .x = 3, .y = 2, .side = 5, .stride = 16};
  const std::vector<double> floor = expected_floor(lamp, 64);
  RenderPlan settings;
  settings.integrator = &kPath;
  settings.direct = gpu::kDirectMis;
  expect_small(error(lamp, floor, settings));
  settings.direct = gpu::kDirectBsdf;
  settings.width = settings.height = 64;
  settings.last_sample = 64;
  settings.max_depth = 1;
  settings.filter = gpu::kFilterBox;
  Scene scene = scene_of(lamp);
  const View view = resolve_view(scene, {}, 64, 64);
  const PackedScene packed = pack(scene, {.direct = settings.direct});
  double sum = 0.0, squares = 0.0, exact = 0.0;
  constexpr int kSeeds = 6;
  for (const double f : floor) exact += f;
  for (settings.seed = 1; settings.seed <= kSeeds; ++settings.seed) {
    const RenderResult result = render(device(), packed, view, settings, RenderHooks{}, shared_kernels(device()));
    double total = 0.0;
    for (const float g : result.picture.channels[1].values) total += g;
    sum += total / exact, squares += total / exact * total / exact;
  }
  const double mean = sum / kSeeds, spread = std::sqrt((squares / kSeeds - mean * mean) / (kSeeds - 1));
  EXPECT_NEAR(mean, 1.0, 4.5 * spread + 2e-3);
  EXPECT_LT(spread, 0.02);
}

} // namespace
} // namespace wavepath::test
