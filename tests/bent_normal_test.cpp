// Facets, smooth normals and normal maps that point different ways: all estimators find the light that directions drawn
// from the BSDF alone find, on scenes that a seed makes. WAVEPATH_BENT_SCENES=A:B renders the seeds from A to
// before B instead of the suite's one, with more samples.
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/integrators/bidirectional/kind.h"
#include "host/integrators/hybrid/kind.h"
#include "host/integrators/path/kind.h"
#include "host/integrators/whitted/kind.h"
#include "host/render/render.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"
#include "tests/scene_builder.h"
#include "tests/shared_kernels.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {
namespace {

constexpr std::uint32_t kSide = 8;    // of the picture, in pixels
constexpr std::size_t kParts = 5;     // the picture and its quarters
constexpr std::uint32_t kRenders = 8; // of each estimator
constexpr double kLargestT = 5.5;     // of 14 degrees of freedom at most: chance alone fails one of 10,000 or so

struct Dice {
  std::mt19937 numbers;
  double between(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(numbers); }
  bool once_in(int n) { return std::uniform_int_distribution<int>(1, n)(numbers) == 1; }
  template <class T>
  T one_of(std::initializer_list<T> values) {
    return *(values.begin() + std::uniform_int_distribution<int>(0, static_cast<int>(values.size()) - 1)(numbers));
  }
  // Unit, up to `steepest` radians off `axis`.
  glm::vec3 around(const glm::vec3& axis, double steepest) {
    const double tilt = between(0.0, steepest), turn = between(0.0, 2.0 * std::numbers::pi);
    const glm::dvec3 n(axis),
        t = glm::normalize(glm::cross(n, std::abs(n.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
    return glm::vec3(std::cos(tilt) * n + std::sin(tilt) * (std::cos(turn) * t + std::sin(turn) * glm::cross(n, t)));
  }
};

// ---- scenes ---------------------------------------------------------------------------------------------------------
// Names of materials, by which a failure tells its scene.
const char* const kMaterialNames[] = {"matt",  "rough dielectric", "rough metal", "coated",    "sheen", "soap", "grain",
                                      "paper", "thin glass",       "glass",       "all layers"};

Material material_of(Dice& dice, int kind) {
  Material m = plain_material();
  m.base_color = {dice.between(0.3, 1.0), dice.between(0.3, 1.0), dice.between(0.3, 1.0), 1.0};
  if (kind == 0) return m;
  m.specular = 1.0f;
  m.roughness = static_cast<float>(dice.between(0.35, 1.0));
  if (kind == 2) m.metallic = 1.0f;
  if (kind == 3 || kind == 10) {
    m.coat = static_cast<float>(dice.between(0.4, 1.0));
    m.coat_roughness = static_cast<float>(dice.between(0.3, 0.6));
  }
  if (kind == 4 || kind == 10) m.sheen_color = glm::vec3(0.8f), m.sheen_roughness = 0.5f;
  if (kind == 5 || kind == 10) m.iridescence = 1.0f;
  if (kind == 6) m.metallic = 1.0f, m.anisotropy = 0.7f, m.anisotropy_rotation = 0.6f;
  if (kind == 7 || kind == 10) m.diffuse_transmission = 0.5f;
  if (kind == 8 || kind == 9) m.transmission = static_cast<float>(dice.between(0.5, 1.0));
  if (kind == 9) m.volume = true, m.attenuation = {0.3f, 0.1f, 0.5f};
  return m;
}

Image bumps(Dice& dice, double steepest) {
  Image map;
  map.name = "bumps";
  map.width = map.height = 8;
  for (int i = 0; i < 64; ++i) {
    const glm::vec3 n = dice.around({0, 0, 1}, steepest);
    for (const float v : {n.x, n.y, n.z, 1.0f})
      map.bytes.push_back(static_cast<std::uint8_t>(std::lround(127.5f + 127.5f * v)));
  }
  return map;
}

// A quilt of facets over x and y in [-1, 1], each corner with a normal of its own: neighbours share neither.
std::uint32_t add_quilt(Scene& scene, Dice& dice, float z, double uneven, double steepest, std::uint32_t material) {
  constexpr int kCells = 4;
  std::array<std::array<glm::vec3, kCells + 1>, kCells + 1> at;
  for (int i = 0; i <= kCells; ++i)
    for (int j = 0; j <= kCells; ++j)
      at[i][j] = {-1.0 + 2.0 * i / kCells, -1.0 + 2.0 * j / kCells, z + dice.between(-uneven, uneven)};
  std::vector<glm::vec3> corners;
  for (int i = 0; i < kCells; ++i)
    for (int j = 0; j < kCells; ++j)
      corners.insert(corners.end(),
                     {at[i][j], at[i + 1][j], at[i + 1][j + 1], at[i][j], at[i + 1][j + 1], at[i][j + 1]});
  const std::uint32_t index = add_mesh(scene, corners, material);
  Mesh& mesh = scene.meshes[index];
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const std::size_t first = i / 3 * 3;
    const glm::vec3 facet =
        glm::normalize(glm::cross(corners[first + 1] - corners[first], corners[first + 2] - corners[first]));
    mesh.normals.push_back(dice.around(facet, steepest));
    mesh.tangents.emplace_back(dice.around({1, 0, 0}, 0.3), i / 3 % 2 == 0 ? 1.0f : -1.0f);
    mesh.uvs[0].push_back(glm::vec2(corners[i]) * 0.9f);
  }
  mesh.primitives[0].has_normals = true;
  return index;
}

struct Made {
  Scene scene;
  std::string name;
};

Made make(std::uint32_t seed) {
  Dice dice{std::mt19937(seed)};
  Made made;
  Scene& scene = made.scene;
  scene.path = "test";
  const int kind = static_cast<int>(seed % std::size(kMaterialNames));
  const double tilt = dice.one_of({0.2, 0.6, 1.0, 1.3}), bend = dice.one_of({0.3, 0.9, 1.4});
  made.name = fmt::format("seed {}: {}, tilted by {}, bent by {}", seed, kMaterialNames[kind], tilt, bend);
  scene.materials = {material_of(dice, kind), plain_material()};
  scene.images = {bumps(dice, bend)};
  scene.materials[0].normal_texture.image = 0;
  if (kind == 3 && dice.once_in(2)) scene.materials[0].coat_normal_texture.image = 0;
  add_instance(scene, add_quilt(scene, dice, 0.0f, dice.one_of({0.0, 0.15}), tilt, 0));
  if (kind == 9) add_instance(scene, add_quilt(scene, dice, -0.6f, 0.05, tilt, 0)); // the body's other side
  // What stands beside it catches the light that it scatters.
  add_instance(
      scene,
      add_mesh(scene, {{1.2f, -1, -1}, {1.2f, 1, 1}, {1.2f, 1, -1}, {1.2f, -1, -1}, {1.2f, -1, 1}, {1.2f, 1, 1}}, 1));
  Material lamp = plain_material();
  lamp.base_color = glm::vec4(0.0f, 0.0f, 0.0f, 1.0f);
  lamp.emission = {5.0f, 4.0f, 3.0f};
  scene.materials.push_back(lamp);
  for (const float side : {1.0f, -1.0f}) // above, grazing, and below
    add_instance(scene,
                 add_mesh(scene, {{-2.0f, -1, side * 0.1f}, {-2.0f, 1, side * 0.1f}, {-1.6f, 0, side * 1.2f}}, 2));
  Environment& sky = scene.environment;
  sky.radiance = glm::vec3(1.0f);
  sky.width = 8, sky.height = 4;
  for (int i = 0; i < 32; ++i) sky.map.emplace_back(dice.between(0.1, 2.0), dice.between(0.1, 2.0), 1.0);
  Camera camera;
  camera.orthographic = true;
  camera.xmag = camera.ymag = 0.9;
  const glm::dvec3 back = glm::dvec3(dice.around({0, 0, 1}, 0.9)),
                   right = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), back));
  camera.world_from_camera = glm::dmat4(glm::dvec4(right, 0), glm::dvec4(glm::cross(back, right), 0),
                                        glm::dvec4(back, 0), glm::dvec4(6.0 * back, 1));
  scene.cameras.push_back(camera);
  return made;
}

// ---- estimators -----------------------------------------------------------------------------------------------------
struct Mean {
  std::array<double, kParts> value{}, variance{};
};

struct Estimator {
  std::string name;
  const IntegratorKind* kind = &kPath;
  std::uint32_t direct = gpu::kDirectMis, spp = 64;
  std::uint32_t techniques = gpu::kTechniquesAll;
};

bool asks_for_scenes() { return std::getenv("WAVEPATH_BENT_SCENES") != nullptr; } // who asks wants to know it precisely

class BentNormals : public VulkanTest {
protected:
  Mean mean(const Scene& made, const Estimator& estimator, std::uint32_t depth) {
    RenderPlan asked;
    asked.width = asked.height = kSide;
    asked.last_sample = asks_for_scenes() ? estimator.spp : estimator.spp / 8;
    asked.max_depth = depth;
    asked.filter = gpu::kFilterBox;
    asked.integrator = estimator.kind;
    asked.direct = estimator.direct;
    asked.techniques = estimator.techniques;
    if (estimator.kind == &kHybrid) asked.ambient = glm::vec3(0.0f);
    Scene scene = made;
    const View view = resolve_view(scene, {}, kSide, kSide);
    const PackedScene packed = pack(scene, {.direct = asked.direct});
    Mean mean;
    for (asked.seed = 1; asked.seed <= kRenders; ++asked.seed) {
      const RenderResult result = render(device(), packed, view, asked, RenderHooks{}, shared_kernels(device()));
      EXPECT_EQ(result.nonfinite.samples(), 0u);
      std::array<double, kParts> parts{};
      for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
        double light = 0.0;
        for (std::size_t c = 0; c < 3; ++c) light += result.picture.channels[c].values[i];
        parts[0] += light / 4.0;
        parts[1 + (i % kSide) / (kSide / 2) + 2 * (i / kSide / (kSide / 2))] += light;
      }
      for (std::size_t i = 0; i < kParts; ++i)
        mean.value[i] += parts[i] / kRenders, mean.variance[i] += parts[i] * parts[i] / kRenders;
    }
    for (std::size_t i = 0; i < kParts; ++i)
      mean.variance[i] = std::max(mean.variance[i] - mean.value[i] * mean.value[i], 0.0) / (kRenders - 1);
    return mean;
  }

  void expect_agreement(const Made& made, std::uint32_t depth, const std::vector<Estimator>& estimators) {
    const Mean oracle = mean(made.scene, {"bsdf", &kPath, gpu::kDirectBsdf, 1024}, depth);
    for (const Estimator& estimator : estimators) {
      const Mean found = mean(made.scene, estimator, depth);
      double worst = 0.0;
      for (std::size_t i = 0; i < kParts; ++i) {
        const double error = std::sqrt(found.variance[i] + oracle.variance[i]) + 1e-6 * oracle.value[i];
        const double t = (found.value[i] - oracle.value[i]) / error;
        worst = std::abs(t) > std::abs(worst) ? t : worst;
        EXPECT_LT(std::abs(t), kLargestT) << made.name << ", depth " << depth << ", " << estimator.name << ", part "
                                          << i << ": " << found.value[i] << " instead of " << oracle.value[i];
        EXPECT_LT(error, 0.06 * oracle.value[i]) << made.name << ", " << estimator.name << ": too much noise to tell";
      }
      if (asks_for_scenes())
        fmt::print("{}, depth {}, {}: t {:.2f}, ratio {:.4f}\n", made.name, depth, estimator.name, worst,
                   found.value[0] / oracle.value[0]),
            std::fflush(stdout);
    }
  }
};

const std::vector<Estimator> kOneBounce = {{"nee", &kPath, gpu::kDirectNee, 256},
                                           {"mis", &kPath, gpu::kDirectMis, 256},
                                           {"whitted", &kWhitted, gpu::kDirectMis, 256},
                                           {"hybrid", &kHybrid, gpu::kDirectMis, 256},
                                           {"bidirectional", &kBidirectional, gpu::kDirectMis, 128}};
const std::vector<Estimator> kThreeBounces = {
    {"nee", &kPath, gpu::kDirectNee, 256},
    {"mis", &kPath, gpu::kDirectMis, 256},
    {"bidirectional", &kBidirectional, gpu::kDirectMis, 256},
    {"light", &kBidirectional, gpu::kDirectMis, 256, gpu::kTechniqueHit | gpu::kTechniqueLight},
    {"connect", &kBidirectional, gpu::kDirectMis, 256, gpu::kTechniqueHit | gpu::kTechniqueConnect},
    {"splat", &kBidirectional, gpu::kDirectMis, 512, gpu::kTechniqueHit | gpu::kTechniqueSplat}};

TEST_F(BentNormals, AllEstimatorsFindTheSameLight) {
  if (!asks_for_scenes()) {
    expect_agreement(make(1), 1, kOneBounce);
    expect_agreement(make(1), 3, {kThreeBounces.begin(), kThreeBounces.begin() + 3});
    return;
  }
  const std::string asked = std::getenv("WAVEPATH_BENT_SCENES");
  for (unsigned long seed = std::stoul(asked); seed < std::stoul(asked.substr(asked.find(':') + 1)); ++seed) {
    const Made made = make(static_cast<std::uint32_t>(seed));
    expect_agreement(made, 1, kOneBounce);
    expect_agreement(made, 3, kThreeBounces);
  }
}

} // namespace
} // namespace wavepath::test
