// Textures that the device's samplers look up (--textures hardware): pictures of all integrators beside exact ones.
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "host/film/film.h"
#include "host/integrators/bidirectional/kind.h"
#include "host/integrators/hybrid/kind.h"
#include "host/integrators/path/kind.h"
#include "host/integrators/whitted/kind.h"
#include "host/render/render.h"
#include "host/render/settings/mips.h"
#include "host/render/settings/textures.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"
#include "tests/scene_builder.h"
#include "tests/shared_kernels.h"
#include "tests/statistics.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {
namespace {

void add_noise(Scene& scene, std::uint32_t width, std::uint32_t height, int least_alpha = 255) {
  std::mt19937 random(static_cast<std::uint32_t>(scene.images.size()) + 3);
  Image& image = scene.images.emplace_back();
  image.width = width, image.height = height;
  for (std::uint32_t i = 0; i < 4 * width * height; ++i)
    image.bytes.push_back(static_cast<std::uint8_t>(i % 4 == 3 ? least_alpha + int(random() % (256 - least_alpha))
                                                               : int(random() % 256)));
}

std::uint32_t add_square(Scene& scene, const glm::vec3& corner, const glm::vec3& a, const glm::vec3& b,
                         const Material& material, float repeats) {
  scene.materials.push_back(material);
  const auto index = static_cast<std::uint32_t>(scene.materials.size() - 1);
  const std::uint32_t mesh =
      add_mesh(scene, {corner, corner + a, corner + a + b, corner, corner + a + b, corner + b}, index);
  const float lo = -0.3f * repeats, hi = repeats;
  scene.meshes[mesh].uvs[0] = {{lo, lo}, {hi, lo}, {hi, hi}, {lo, lo}, {hi, hi}, {lo, hi}};
  add_instance(scene, mesh);
  return index;
}

// A wall with every kind of map, a mask that throws a shadow on it, a lamp whose emission varies; images of several
// sizes, one of them moved and turned.
Scene room() {
  Scene scene;
  scene.path = "test";
  add_noise(scene, 16, 16);
  add_noise(scene, 7, 12);
  add_noise(scene, 8, 8, 0);
  add_noise(scene, 5, 5);
  Material wall = plain_material();
  wall.base_color = glm::vec4(0.9f);
  wall.roughness = 0.9f;
  wall.specular = 1.0f;
  wall.metallic = 0.3f;
  wall.base_color_texture = {.image = 0, .wrap_v = Wrap::mirror, .srgb = true};
  wall.metallic_roughness_texture = {.image = 1, .wrap_u = Wrap::clamp, .wrap_v = Wrap::clamp};
  wall.normal_texture = {.image = 1};
  wall.normal_scale = 0.2f;
  wall.base_color_texture.uv_matrix = glm::mat2(0.8f, 0.6f, -0.6f, 0.8f);
  wall.base_color_texture.uv_offset = {0.25f, -0.5f};
  add_square(scene, {-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, wall, 2.0f);
  Material mask = plain_material();
  mask.alpha_mode = AlphaMode::mask;
  mask.alpha_cutoff = 0.5f;
  mask.base_color_texture = {.image = 2, .nearest = true, .srgb = true};
  add_square(scene, {-1, -1, 0.5f}, {2, 0, 0}, {0, 2, 0}, mask, 1.0f);
  Material lamp = plain_material();
  lamp.base_color = glm::vec4(0, 0, 0, 1);
  lamp.emission = glm::vec3(4.0f);
  lamp.emission_texture = {.image = 3, .srgb = true};
  add_square(scene, {-2, 2, 2}, {4, 0, 0}, {0, 0.5f, -1}, lamp, 1.0f);
  scene.environment.radiance = glm::vec3(0.2f);
  Camera camera;
  camera.world_from_camera = glm::dmat4(1.0);
  camera.world_from_camera[3] = {0, 0, 5, 1};
  camera.yfov = 0.8;
  scene.cameras.push_back(camera);
  return scene;
}

class SampledTextures : public VulkanTest {
protected:
  static RenderPlan settings(const IntegratorKind& integrator, std::uint32_t textures, std::uint32_t spp) {
    RenderPlan settings;
    settings.width = settings.height = 48;
    settings.last_sample = spp;
    settings.max_depth = 2;
    settings.integrator = &integrator;
    settings.textures = textures;
    return settings;
  }

  RenderResult render(Scene scene, const RenderPlan& settings) {
    const View view = resolve_view(scene, {}, settings.width, settings.height);
    const PackedScene packed = pack(scene, {.direct = settings.direct,
                                            .eye = view.position,
                                            .lights = settings.lights,
                                            .mips = wants_mips(settings),
                                            .samplers = sampler_limits(settings, device().info())});
    EXPECT_EQ((packed.features & gpu::kFeatureSampledTextures) != 0,
              settings.textures == kTexturesHardware && !packed.textures.empty());
    return wavepath::render(device(), packed, view, settings, RenderHooks{}, shared_kernels(device()));
  }
};

struct Distance {
  double rms = 0.0, ratio = 0.0; // over the mean; of the means
};
Distance distance(const RenderResult& a, const RenderResult& b) {
  double squares = 0.0, sum_a = 0.0, sum_b = 0.0;
  std::size_t count = 0;
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < a.picture.channels[c].values.size(); ++i, ++count) {
      const double x = a.picture.channels[c].values[i], y = b.picture.channels[c].values[i];
      squares += (x - y) * (x - y), sum_a += x, sum_b += y;
    }
  return {std::sqrt(squares / static_cast<double>(count)) / (sum_b / static_cast<double>(count)), sum_a / sum_b};
}

// Equal seeds trace equal paths but where a look-up decides, so that pictures differ by what weights of eight bits
// change: the noise of 1/512 of the contrast a look-up, and single paths that take another turn.
TEST_F(SampledTextures, PicturesAreThoseOfExactOnes) {
  for (const IntegratorKind* kind : {&kPath, &kHybrid, &kWhitted, &kBidirectional, &kAo}) {
    const std::uint32_t spp = kind == &kPath || kind == &kBidirectional ? 16 : 4;
    const RenderResult exact = render(room(), settings(*kind, kTexturesExact, spp)),
                       sampled = render(room(), settings(*kind, kTexturesHardware, spp));
    const Distance apart = distance(sampled, exact);
    EXPECT_NEAR(apart.ratio, 1.0, 0.003) << kind->name;
    EXPECT_LT(apart.rms, 0.05) << kind->name;
    EXPECT_EQ(*sampled.film == *exact.film, kind == &kAo) << kind->name << ": whether samplers were asked";
  }
}

TEST_F(SampledTextures, GenericKernelsGiveTheSameBits) {
  RenderPlan one = settings(kPath, kTexturesHardware, 2);
  const RenderResult specialized = render(room(), one);
  one.specialize = false;
  EXPECT_TRUE(*render(room(), one).film == *specialized.film);
}

TEST_F(SampledTextures, AWrongGuessOfTheKernelsChangesNoBit) {
  for (const std::uint32_t textures : {kTexturesExact, kTexturesHardware}) {
    const RenderPlan asked = settings(kPath, textures, 2);
    const RenderResult right = render(room(), asked);
    KernelCompiler kernels(device());
    const gpu::Feature guess = gpu::kFeaturesAll & ~gpu::kFeatureNearestTextures;
    kPath.start_kernels(kernels, device().info(),
                        guess | (textures == kTexturesExact ? gpu::kFeatureSampledTextures : 0), asked);
    kernels.all();
    Scene scene = room();
    const View view = resolve_view(scene, {}, asked.width, asked.height);
    const PackedScene packed = pack(scene, {.direct = asked.direct,
                                            .eye = view.position,
                                            .lights = asked.lights,
                                            .samplers = sampler_limits(asked, device().info())});
    EXPECT_TRUE(*wavepath::render(device(), packed, view, asked, RenderHooks{}, kernels).film == *right.film);
  }
}

// Radiance that is met and radiance that is sampled is looked up alike, so that both find as much light.
TEST_F(SampledTextures, LampsShineAlikeByAllEstimators) {
  std::vector<double> means, errors;
  for (const std::uint32_t direct : {gpu::kDirectMis, gpu::kDirectNee, gpu::kDirectBsdf}) {
    RenderPlan by = settings(kPath, kTexturesHardware, 256);
    by.direct = direct;
    by.max_depth = 1;
    Mean mean;
    for (std::uint32_t seed = 0; seed < 4; ++seed) {
      by.seed = seed;
      const RenderResult one = render(room(), by);
      double sum = 0.0;
      for (const float value : one.picture.channels[1].values) sum += value;
      mean.add(sum / static_cast<double>(one.picture.channels[1].values.size()));
    }
    means.push_back(mean.mean());
    errors.push_back(mean.error());
  }
  EXPECT_NEAR(means[1], means[0], 4.0 * std::hypot(errors[0], errors[1]) + 1e-4 * means[0]);
  EXPECT_NEAR(means[2], means[0], 4.0 * std::hypot(errors[0], errors[2]) + 1e-4 * means[0]);
}

// Frames of one sample look up mip levels, in an atlas as in the texel buffer.
TEST_F(SampledTextures, HaveMipLevels) {
  RenderPlan exact = settings(kHybrid, kTexturesExact, 1), sampled = settings(kHybrid, kTexturesHardware, 1);
  Scene far = room();
  far.cameras[0].world_from_camera[3] = {0, 0, 60, 1};
  far.cameras[0].yfov = 0.07;
  for (RenderPlan* one : {&exact, &sampled}) one->width = one->height = 12;
  const RenderResult a = render(far, sampled), b = render(far, exact);
  EXPECT_LT(distance(a, b).rms, 0.03);
  exact.mips = false;
  EXPECT_GT(distance(b, render(far, exact)).rms, 0.1) << "levels were not looked up";
}

// A scene of floats and of bytes: kernels take each from where it is.
TEST_F(SampledTextures, StandBesideExactOnes) {
  Scene mixed = room();
  Image& image = mixed.images[0];
  for (const std::uint8_t byte : image.bytes) image.floats.push_back(static_cast<float>(byte) / 255.0f);
  image.bytes.clear();
  const RenderResult exact = render(mixed, settings(kPath, kTexturesExact, 16)),
                     sampled = render(mixed, settings(kPath, kTexturesHardware, 16));
  const Distance apart = distance(sampled, exact);
  EXPECT_NEAR(apart.ratio, 1.0, 0.003);
  EXPECT_LT(apart.rms, 0.05);
}

TEST_F(SampledTextures, ASceneWithoutTexturesIsAsEver) {
  Scene bare = room();
  for (Material& material : bare.materials)
    material.base_color_texture = material.metallic_roughness_texture = material.normal_texture =
        material.emission_texture = {};
  EXPECT_TRUE(*render(bare, settings(kPath, kTexturesHardware, 2)).film ==
              *render(bare, settings(kPath, kTexturesExact, 2)).film);
}

TEST(SamplerLimitsOf, SeveralDevicesAreWhatAllCanHold) {
  RenderPlan settings;
  DeviceInfo a, b;
  a.max_image_side = 4096, a.max_image_layers = 2048, a.max_image_bytes = 1u << 30, a.max_allocation = 1u << 29;
  b.max_image_side = 16384, b.max_image_layers = 256, b.max_image_bytes = 1u << 28, b.max_allocation = 1u << 30;
  EXPECT_FALSE(sampler_limits(settings, a));
  EXPECT_FALSE(common_limits({}, b));
  settings.textures = kTexturesHardware;
  EXPECT_EQ(sampler_limits(settings, a)->bytes, 1u << 29);
  const SamplerLimits both = common_limits(sampler_limits(settings, a), b).value();
  EXPECT_EQ(both.side, 4096u);
  EXPECT_EQ(both.layers, 256u);
  EXPECT_EQ(both.bytes, 1u << 28);
}

} // namespace
} // namespace wavepath::test
