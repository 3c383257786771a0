// Path guiding: its densities are what its samples follow, the picture stays the same and gets less noise where light
// is hidden, and the bits depend neither on how the work is cut up nor on interrupts.
#include <algorithm>
#include <bit>
#include <cmath>
#include <fstream>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/integrators/path/guide_field.h"
#include "host/integrators/path/guide_map.h"
#include "host/integrators/path/guiding.h"
#include "host/picture/files/picture_io.h"
#include "host/plan/training.h"
#include "host/render/render.h"
#include "host/render/report/state_file.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/scene/gltf/gltf.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"
#include "tests/coverage.h"
#include "tests/gltf_builder.h"
#include "tests/probe.h"
#include "tests/run_wavepath.h"
#include "tests/shared_kernels.h"
#include "tests/statistics.h"

#include "kernels/film/film_types.h"
#include "tests/probes/guide_probe.spv.h"

namespace wavepath::test {
namespace {

constexpr double kPi = std::numbers::pi;

class Random {
public:
  float next() { return float((state_ = state_ * 6364136223846793005u + 1442695040888963407u) >> 40) * 0x1p-24f; }
  glm::vec3 direction() {
    const double y = 2.0 * next() - 1.0, phi = 2.0 * kPi * next(), r = std::sqrt(1.0 - y * y);
    return {r * std::cos(phi), y, r * std::sin(phi)};
  }

private:
  std::uint64_t state_ = 1;
};

// Vertices on a square whose light comes from a small lamp above it, and a little from everywhere.
const glm::vec3 kLamp(0.3f, 1.0f, 0.2f);
std::vector<GuideVertex> vertices_below_a_lamp(std::size_t count) {
  Random random;
  std::vector<GuideVertex> vertices;
  for (std::size_t i = 0; i < count; ++i) {
    GuideVertex v{
        .position = {random.next(), 0.0f, random.next()}, .direction = random.direction(), .guidable_fraction = 1.0f};
    v.pdf = v.bsdf_pdf = static_cast<float>(0.25 / kPi);
    const bool lamp = glm::dot(v.direction, glm::normalize(kLamp - v.position)) > 0.97f;
    v.radiance = lamp ? 50.0f : 0.1f;
    v.contribution = v.radiance;
    v.odd = i & 1;
    vertices.push_back(v);
  }
  return vertices;
}

// Azimuth about +y by turns that cells have equal parts of; the angle is that of an arc tangent.
double angle_of(double turn) {
  const double quarters = 4.0 * turn - 1.0, across = quarters > 1.0 ? 2.0 - quarters : quarters;
  const double angle = std::atan2(across, 1.0 - std::abs(across));
  return quarters > 1.0 ? kPi - angle : angle;
}
double turn_of(const glm::dvec3& d) {
  const double across = d.z / std::max(std::abs(d.x) + std::abs(d.z), 1e-30);
  return 0.25 * (d.x < 0.0 ? 3.0 - across : 1.0 + across);
}

// In the middle of a cell.
glm::vec3 direction_of(std::uint32_t x, std::uint32_t y) {
  const double height = 2.0 * (y + 0.5) / gpu::kGuideSide - 1.0, r = std::sqrt(1.0 - height * height);
  const double angle = angle_of((x + 0.5) / gpu::kGuideSide);
  return {r * std::cos(angle), height, r * std::sin(angle)};
}

const glm::uvec4* map_of(const GuideField& field, std::uint32_t leaf) {
  return &field.maps[std::size_t{leaf} * gpu::kGuideMapTexels];
}
float density_of(const glm::uvec4* map, std::uint32_t x, std::uint32_t y) {
  const glm::uvec4& quad = map[gpu::kGuideBlocks + y / 2 * (gpu::kGuideSide / 2) + x / 2];
  return std::bit_cast<float>(quad[static_cast<int>(2 * (y & 1) + (x & 1))]);
}

// How often a block draws a part.
double fraction_of(const glm::uvec4& block, std::uint32_t column, std::uint32_t row) {
  double sum = 0.0, own = 0.0;
  for (std::uint32_t x = 0; x < 4; ++x)
    for (std::uint32_t y = 0; y < 4; ++y) {
      const std::uint32_t byte = block[static_cast<int>(x)] >> (8 * y) & 255u;
      const auto weight = std::bit_cast<float>(byte << gpu::kGuideWeightShift | gpu::kGuideWeightExponent << 23);
      sum += weight;
      if (x == column && y == row) own = weight;
    }
  return own / sum;
}

TEST(GuideField, DensitiesIntegrateToOneAndAreWhatBlocksDraw) {
  const GuideField field = build_field(vertices_below_a_lamp(20000));
  ASSERT_GT(field.leaves(), 16u);
  constexpr double kCell = 4.0 * kPi / kGuideCells;
  for (std::uint32_t leaf = 0; leaf < field.leaves(); ++leaf) {
    const glm::uvec4* map = map_of(field, leaf);
    double whole = 0.0;
    for (std::uint32_t y = 0; y < gpu::kGuideSide; y += 2)
      for (std::uint32_t x = 0; x < gpu::kGuideSide; x += 2) {
        const std::uint32_t part = y / 8 * 4 + x / 8;
        const double drawn = fraction_of(map[0], x / 8, y / 8) * fraction_of(map[1 + part], x / 2 % 4, y / 2 % 4);
        double quad = 0.0;
        for (std::uint32_t k = 0; k < 4; ++k) quad += kCell * density_of(map, x + k % 2, y + k / 2);
        ASSERT_NEAR(quad / drawn, 1.0, 1e-5) << leaf << " " << x << " " << y;
        whole += quad;
      }
    ASSERT_NEAR(whole, 1.0, 1e-5) << leaf;
  }
  EXPECT_LT(field.gain, 0.3);
  EXPECT_GT(field.probability, 0.4);
}

// What no sample comes from has ever less density the further space is divided, until floats hold none; blocks still
// draw it once in a great while.
TEST(GuideMap, WhatIsDarkHasTheDensityItIsDrawnWith) {
  Histogram lamp;
  for (int i = 0; i < 4'000'000; ++i) lamp.add(map_cell({0.6f, 0.64f, 0.48f}), 1.0);
  GuideMap map = even_map();
  for (int depth = 0; depth < 16; ++depth) map = train_map(lamp, map);
  const auto [least, most] = std::ranges::minmax_element(map);
  EXPECT_EQ(*least, 0.0f);
  EXPECT_TRUE(std::isfinite(*most));
  std::vector<glm::uvec4> texels(gpu::kGuideMapTexels);
  write_map(map, std::span(texels).first<gpu::kGuideMapTexels>());
  double whole = 0.0;
  for (std::uint32_t y = 0; y < gpu::kGuideSide; ++y)
    for (std::uint32_t x = 0; x < gpu::kGuideSide; ++x) {
      const double quad = density_of(texels.data(), x & ~1u, y & ~1u) + density_of(texels.data(), x | 1u, y & ~1u) +
                          density_of(texels.data(), x & ~1u, y | 1u) + density_of(texels.data(), x | 1u, y | 1u);
      EXPECT_GT(quad, 0.0) << x << " " << y;
      whole += 4.0 * kPi / kGuideCells * density_of(texels.data(), x, y);
    }
  EXPECT_NEAR(whole, 1.0, 1e-5);
}

// Rounded weights cost next to nothing, also where nearly all light comes from one cell.
TEST(GuideMap, RoundedWeightsStayNearWhatWasLearned) {
  Random random;
  Histogram histogram;
  for (int i = 0; i < 2000; ++i) histogram.add(map_cell(random.direction()), 0.01);
  for (int i = 0; i < 2000; ++i) histogram.add(map_cell({0.6f, 0.64f, 0.48f}), 1.0);
  const GuideMap map = train_map(histogram, even_map());
  std::vector<glm::uvec4> texels(gpu::kGuideMapTexels);
  write_map(map, std::span(texels).first<gpu::kGuideMapTexels>());
  double whole = 0.0;
  for (std::uint32_t y = 0; y < gpu::kGuideSide; ++y)
    for (std::uint32_t x = 0; x < gpu::kGuideSide; ++x) {
      const float learned = map_density(map, map_cell(direction_of(x, y)));
      EXPECT_NEAR(density_of(texels.data(), x, y) / learned, 1.0, 0.14) << x << " " << y; // 1/16 in each of two blocks
      whole += 4.0 * kPi / kGuideCells * learned;
    }
  EXPECT_NEAR(whole, 1.0, 1e-4);
}

TEST(GuideField, EqualLightEverywherePromisesNoGain) {
  std::vector<GuideVertex> vertices = vertices_below_a_lamp(20000);
  for (GuideVertex& v : vertices) v.radiance = v.contribution = 1.0f;
  const GuideField field = build_field(vertices);
  EXPECT_GT(field.gain, 0.99);
  EXPECT_EQ(build_field({}).leaves(), 1u);
}

TEST(GuideField, ManyVerticesOfOneLocationEndInOneLeaf) {
  std::vector<GuideVertex> vertices = vertices_below_a_lamp(5000);
  for (GuideVertex& v : vertices) v.position = glm::vec3(1.0f);
  EXPECT_EQ(build_field(vertices).leaves(), 1u);
}

// Most of a scene may lie in one plane at the low end of its longest axis.
TEST(GuideField, DividesWhatTiesLeaveAbove) {
  std::vector<GuideVertex> vertices = vertices_below_a_lamp(20000);
  for (std::size_t i = 0; i < vertices.size(); ++i)
    vertices[i].position.y = i % 5 < 3 ? 0.0f : 10.0f + 1e-4f * float(i);
  EXPECT_GT(build_field(vertices).leaves(), 16u);
  for (GuideVertex& v : vertices) v.position.y = -v.position.y;
  EXPECT_GT(build_field(vertices).leaves(), 16u);
}

TEST(GuideField, StaysWithinItsRoom) {
  const GuideField field = build_field(vertices_below_a_lamp(3'000'000));
  EXPECT_LE(field.leaves(), kMostGuideLeaves);
  EXPECT_GT(field.leaves(), kMostGuideLeaves / 2);
  EXPECT_LE(field.nodes.size() * sizeof(gpu::GuideNode), kGuideTreeBytes);
  EXPECT_LE(kGuideMapBytes + kGuideTreeBytes, 64u << 20);
}

struct Element {
  glm::vec4 a{0.0f}, b{0.0f};
};

class GuideProbe : public VulkanTest {
protected:
  std::vector<Element> run(const GuideField& field, std::uint32_t mode, const std::vector<Element>& elements) {
    const Buffer frame = upload(device(), std::vector<gpu::Frame>(1)), places = upload(device(), std::vector<int>(1));
    const Buffer tree = upload(device(), field.nodes), maps = upload(device(), field.maps);
    const Buffer records = upload(device(), std::vector<glm::vec4>(1)), in_out = upload(device(), elements);
    const std::vector<Binding> bindings{{gpu::kBindFrame, BindingKind::uniform, &frame},
                                        {gpu::kBindEntries, BindingKind::texels_r32ui, &places},
                                        {gpu::kBindGuideTree, BindingKind::texels_rgba32ui, &tree},
                                        {gpu::kBindGuideMaps, BindingKind::texels_rgba32ui, &maps},
                                        {gpu::kBindGuideRecords, BindingKind::storage, &records},
                                        {gpu::kBindFilm, BindingKind::storage, &in_out}};
    const gpu::Wave wave{.pixel_count = std::uint32_t(elements.size()), .bounce = mode};
    const BindingSet set(device(), bindings, sizeof wave);
    const Kernel kernel(device(), "guide_probe", wavepath_guide_probe_spv, set, {});
    Commands commands(device());
    commands.bind(set);
    commands.dispatch(kernel, (wave.pixel_count + gpu::kWorkgroupSize - 1) / gpu::kWorkgroupSize, &wave);
    commands.submit_and_wait();
    return download<Element>(in_out, elements.size());
  }
};

TEST_F(GuideProbe, SamplesFollowTheDensity) {
  const GuideField field = build_field(vertices_below_a_lamp(20000));
  Random random;
  for (const glm::vec3 place : {glm::vec3(0.1f, 0.0f, 0.9f), glm::vec3(0.8f, 0.0f, 0.2f)}) {
    // Expected counts by a grid in (azimuth, height) that is no multiple of the maps' own.
    constexpr int kColumns = 24, kRows = 12, kFine = 32;
    std::vector<Element> grid;
    for (int row = 0; row < kRows * kFine; ++row)
      for (int column = 0; column < kColumns * kFine; ++column) {
        const double y = 2.0 * (row + 0.5) / (kRows * kFine) - 1.0, r = std::sqrt(1.0 - y * y);
        const double phi = angle_of((column + 0.5) / (kColumns * kFine));
        grid.push_back({glm::vec4(place, 0), {r * std::cos(phi), y, r * std::sin(phi), 0}});
      }
    const auto densities = run(field, 0, grid);
    double total = 0.0;
    constexpr std::size_t kSamples = 1 << 19;
    std::vector<double> expected(kColumns * kRows), counts(kColumns * kRows);
    for (std::size_t i = 0; i < grid.size(); ++i) {
      const std::size_t row = i / (kColumns * kFine) / kFine, column = i % (kColumns * kFine) / kFine;
      const double fine = double(i % (kColumns * kFine)) / (kColumns * kFine), width = 1.0 / (kColumns * kFine);
      const double fraction = densities[i].b.w * (angle_of(fine + width) - angle_of(fine)) * 2.0 / (kRows * kFine);
      total += fraction;
      expected[row * kColumns + column] += fraction * double(kSamples);
    }
    EXPECT_NEAR(total, 1.0, 1e-4);
    std::vector<Element> in(kSamples, {glm::vec4(place, 0), {}});
    for (Element& e : in) e.b = {random.next(), random.next(), 0, 0};
    Mean inverse;
    for (const Element& e : run(field, 1, in)) {
      const glm::dvec3 d(e.b);
      ASSERT_NEAR(glm::length(d), 1.0, 1e-6);
      const int column = int(turn_of(d) * kColumns), row = int((d.y + 1.0) / 2.0 * kRows);
      counts[std::size_t(std::min(row, kRows - 1) * kColumns + std::min(column, kColumns - 1))] += 1.0;
      inverse.add(1.0 / e.b.w);
      ASSERT_EQ(e.a.w, densities[0].a.w) << "another leaf";
    }
    EXPECT_GT(chi_square(counts, expected).p_value, 0.005);
    EXPECT_NEAR(inverse.mean(), 4.0 * kPi, 4.0 * inverse.error());
  }
}

// Host and kernel cut the sphere alike, poles and axes included.
TEST_F(GuideProbe, CellsAreThoseOfTheHost) {
  const GuideField field = build_field(vertices_below_a_lamp(20000));
  Random random;
  std::vector<Element> in;
  for (const glm::vec3 axis : {glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)})
    for (const float sign : {-1.0f, 1.0f}) in.push_back({glm::vec4(0.3f, 0.0f, 0.6f, 0), glm::vec4(sign * axis, 0)});
  for (int i = 0; i < 20000; ++i) in.push_back({glm::vec4(0.3f, 0.0f, 0.6f, 0), glm::vec4(random.direction(), 0)});
  std::size_t others = 0; // a last bit may lie across a border
  for (const Element& e : run(field, 0, in)) {
    const auto x = std::uint32_t(std::min(turn_of(glm::dvec3(e.b)), 0.99999999) * gpu::kGuideSide);
    const auto y = std::uint32_t(std::min(0.5 * e.b.y + 0.5, 0.99999999) * gpu::kGuideSide);
    if (map_cell(glm::vec3(e.b)) != map_cell(direction_of(x, y))) ++others;
    const double expected =
        density_of(map_of(field, static_cast<std::uint32_t>(e.a.w)), x, y) * map_stretch(glm::vec3(e.b));
    if (!(std::abs(e.b.w / expected - 1.0) < 1e-5)) ++others;
  }
  EXPECT_LE(others, 5u);
}

// Two chambers, a hatch between them of a fiftieth of the wall; the lamp shines away from the one with the camera.
std::string hatch_room() {
  GltfBuilder builder;
  const auto material = [&](std::vector<double> color, double emission) {
    nlohmann::json json = {{"doubleSided", emission == 0.0},
                           {"pbrMetallicRoughness", {{"baseColorFactor", color}, {"metallicFactor", 0}}},
                           {"extensions", {{"KHR_materials_specular", {{"specularFactor", 0}}}}}};
    if (emission > 0.0) {
      json["emissiveFactor"] = {1, 1, 1};
      json["extensions"]["KHR_materials_emissive_strength"] = {{"emissiveStrength", emission}};
    }
    return builder.add("materials", json);
  };
  const int white = material({0.7, 0.7, 0.7, 1.0}, 0.0), lamp = material({0.0, 0.0, 0.0, 1.0}, 40.0);
  std::vector<float> walls, light;
  // A rectangle from `a` along u and v.
  const auto add = [](std::vector<float>& to, const glm::vec3& a, const glm::vec3& u, const glm::vec3& v) {
    for (const glm::vec3& p : {a, a + u, a + u + v, a, a + u + v, a + v}) to.insert(to.end(), {p.x, p.y, p.z});
  };
  const glm::vec3 x(4, 0, 0), y(0, 2, 0), z(0, 0, 2), corner(0, 0, -1);
  add(walls, corner, x, z), add(walls, corner + y, x, z);
  add(walls, corner, x, y), add(walls, corner + z, x, y);
  add(walls, corner, y, z), add(walls, corner + x, y, z);
  for (const float side : {-1.0f, 0.15f}) add(walls, {2.2f, 0.0f, side}, y, {0, 0, 0.85f});
  for (const float end : {0.0f, 1.15f}) add(walls, {2.2f, end, -0.15f}, {0, 0.85f, 0}, {0, 0, 0.3f});
  add(light, {2.25f, 0.8f, 0.3f}, {0, 0.4f, 0}, {0, 0, 0.4f}); // faces +x
  builder.mesh_node({{"POSITION", builder.floats("VEC3", walls)}}, {{"material", white}});
  builder.mesh_node({{"POSITION", builder.floats("VEC3", light)}}, {{"material", lamp}});
  builder.root["extensionsUsed"] = {"KHR_materials_specular", "KHR_materials_emissive_strength"};
  return builder.json();
}

class GuideTest : public VulkanTest {
protected:
  static RenderPlan settings(std::uint32_t spp) {
    RenderPlan settings;
    settings.width = 32, settings.height = 24;
    settings.last_sample = spp;
    settings.max_depth = 6;
    return settings;
  }
  void SetUp() override {
    VulkanTest::SetUp();
    Scene scene = load_gltf(folder_.write("hatch.gltf", hatch_room()).string(), {});
    const ViewRequest view{.eye = glm::dvec3(0.1, 1.0, 0.6), .look_at = glm::dvec3(2.2, 0.9, -0.5), .yfov = 1.2};
    view_ = resolve_view(scene, view, 32, 24);
    packed_ = pack(scene);
  }
  RenderResult render(const RenderPlan& settings) {
    KernelCompiler& kernels = shared_kernels(device());
    return wavepath::render(device(), packed_, view_, settings, RenderHooks{}, kernels);
  }
  static void expect_same_bits(const Picture& a, const Picture& b) {
    for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(a.channels[c].values, b.channels[c].values);
  }

  TempFolder folder_;
  PackedScene packed_;
  View view_;
};

TEST_F(GuideTest, SamePictureWithLessNoise) {
  constexpr std::uint32_t kRenders = 8;
  struct Pixel {
    Mean plain, guided;
  };
  std::vector<Pixel> pixels(32 * 24);
  Mean plain, guided;
  for (std::uint32_t seed = 0; seed < kRenders; ++seed)
    for (const bool guide : {false, true}) {
      RenderPlan asked = settings(128); // with fewer, unguided paths have not met rare light in every pixel
      asked.seed = seed;
      asked.guide = guide;
      const RenderResult result = render(asked);
      ASSERT_EQ(result.guide.has_value(), guide);
      if (guide) {
        EXPECT_TRUE(result.guide->used);
        EXPECT_LT(result.guide->variance, 0.8);
        EXPECT_GT(result.guide->leaves, 100u);
      }
      double sum = 0.0;
      for (std::size_t i = 0; i < pixels.size(); ++i) {
        const double value = result.picture.channels[1].values[i];
        (guide ? pixels[i].guided : pixels[i].plain).add(value);
        sum += value / double(pixels.size());
      }
      (guide ? guided : plain).add(sum);
    }
  EXPECT_NEAR(guided.mean(), plain.mean(), 4.0 * std::hypot(guided.error(), plain.error()));
  double plain_error = 0.0, guided_error = 0.0;
  std::size_t far = 0;
  for (const Pixel& pixel : pixels) {
    const double variance = std::pow(pixel.plain.error(), 2) + std::pow(pixel.guided.error(), 2);
    far += std::abs(pixel.plain.mean() - pixel.guided.mean()) > 4.0 * std::sqrt(variance);
    plain_error += std::pow(pixel.plain.error(), 2), guided_error += std::pow(pixel.guided.error(), 2);
  }
  EXPECT_LT(far, pixels.size() / 50); // Student's t with about 14 degrees of freedom: 0.1 %
  EXPECT_LT(guided_error, 0.6 * plain_error);
}

// As in error_test.cpp, by fewer seeds, of which each trains a field of its own.
TEST_F(GuideTest, TheIntervalHoldsTheTrueError) {
  constexpr std::uint32_t kRuns = 12, kReference = 16;
  RenderPlan coarse = settings(32);
  coarse.max_depth = 3;
  coarse.guide = true;
  coarse.filter = gpu::kFilterBox;
  RenderPlan fine = coarse;
  fine.last_sample *= kReference, fine.seed = 1000000;
  const Coverage found = measure_coverage(render(fine).picture, kRuns, [&](std::uint32_t seed) {
    coarse.seed = seed;
    RenderResult result = render(coarse);
    EXPECT_TRUE(result.guide->used);
    return result;
  });
  EXPECT_GE(found.covered, 9u);
  EXPECT_NEAR(found.ratio.mean(), 1.0, 0.1) << "its own noise is " << found.ratio.error();
}

TEST_F(GuideTest, BitsDependNeitherOnWavesNorOnGenericKernels) {
  RenderPlan asked = settings(8);
  asked.guide = true;
  const RenderResult whole = render(asked);
  ASSERT_TRUE(whole.guide->used);
  asked.wave_slots = 300;
  expect_same_bits(render(asked).picture, whole.picture);
  asked.wave_slots = 0;
  asked.specialize = false;
  expect_same_bits(render(asked).picture, whole.picture);
  asked.specialize = true;
  asked.guide = false;
  EXPECT_NE(render(asked).picture.channels[0].values, whole.picture.channels[0].values);
}

// Where the pilot finds that guiding would not pay, the picture is that of unguided paths.
TEST_F(GuideTest, PilotDecides) {
  Scene furnace = load_gltf(std::string(WAVEPATH_SOURCE_DIR) + "/scenes/analytic/inside_glowing_cube.gltf", {});
  packed_ = pack(furnace);
  view_ = resolve_view(furnace, {}, 32, 24);
  RenderPlan asked = settings(8);
  const RenderResult plain = render(asked);
  asked.guide = true;
  const RenderResult guided = render(asked);
  ASSERT_TRUE(guided.guide.has_value());
  EXPECT_FALSE(guided.guide->used);
  expect_same_bits(guided.picture, plain.picture);
}

// A pilot whose paths scatter once, with a lamp above each iteration in a place of its own. `direct`: noise of what no
// direction changes.
class GuideTrainingTest : public VulkanTest {
protected:
  GuideReport run(std::uint32_t iterations, float direct, GuideField& field) {
    constexpr std::uint32_t kSide = 64;
    GuideTraining pilot(kSide, kSide, iterations);
    std::vector<gpu::GuideRecord> records(std::size_t{kSide} * kSide * gpu::kGuideBounces);
    std::uint32_t iteration = 0;
    while (!pilot.is_done()) {
      for (std::size_t path = 0; path < records.size(); path += gpu::kGuideBounces) {
        gpu::GuideRecord& note = records[path];
        note.position = {random_.next(), 0.0f, random_.next()};
        note.direction = random_.direction();
        note.pdf = note.bsdf_pdf = static_cast<float>(0.25 / kPi);
        note.throughput = note.guidable_fraction = 1.0f;
        note.before = direct * random_.next();
        note.after = note.before + (glm::dot(note.direction, lamp_of(iteration)) > 0.94f ? 25.0f : 0.1f);
      }
      iteration += pilot.take(upload(device(), records));
    }
    field = pilot.field();
    return pilot.report();
  }
  // Where iterations had their lamps.
  static glm::vec3 lamp_of(std::uint32_t iteration) {
    const float angle = 1.2f * static_cast<float>(iteration);
    return {std::cos(angle), 0.0f, std::sin(angle)};
  }
  static float density_towards(const GuideField& field, const glm::vec3& direction) {
    const double x = turn_of(glm::dvec3(direction)) * gpu::kGuideSide, y = (0.5 * direction.y + 0.5) * gpu::kGuideSide;
    double sum = 0.0;
    for (std::uint32_t leaf = 0; leaf < field.leaves(); ++leaf)
      sum += density_of(map_of(field, leaf), std::uint32_t(x), std::uint32_t(y)) / field.leaves();
    return static_cast<float>(sum);
  }
  Random random_;
};

TEST_F(GuideTrainingTest, TrainsOnTheLastThreeIterations) {
  for (const std::uint32_t iterations : {kGuideIterations, kGuideIterations + 1}) {
    GuideField field;
    EXPECT_TRUE(run(iterations, 0.0f, field).used);
    for (std::uint32_t i = 0; i < iterations; ++i) {
      const bool is_trained = i + 3 >= iterations;
      EXPECT_EQ(density_towards(field, lamp_of(i)) > 0.5 * 0.25 / kPi, is_trained) << i << " of " << iterations;
    }
  }
}

// With noise that no direction changes guiding gains less than it costs, but not so little that it is seen at once.
TEST_F(GuideTrainingTest, IsNoLongerWhereGuidingDoesNotPay) {
  GuideField field;
  const GuideReport four = run(kGuideIterations, 22.0f, field), five = run(kGuideIterations + 1, 22.0f, field);
  EXPECT_FALSE(four.used);
  EXPECT_GT(four.variance, 0.75);
  EXPECT_LT(four.variance, 0.85);
  EXPECT_GT(four.training_paths, 1u << 18) << "four iterations";
  EXPECT_EQ(five.training_paths, four.training_paths);
  EXPECT_GT(run(kGuideIterations + 1, 0.0f, field).training_paths, four.training_paths);
}

TEST(GuideIterations, AreMoreInLongRenders) {
  RenderPlan settings;
  settings.width = 256, settings.height = 192;
  const auto iterations = [&](std::uint32_t spp) {
    settings.last_sample = spp;
    return guide_iterations(settings, DeviceClass::cpu);
  };
  EXPECT_EQ(iterations(1), kGuideIterations);
  EXPECT_EQ(iterations(64), kGuideIterations);
  EXPECT_EQ(iterations(256), kGuideIterations + 1);
  EXPECT_EQ(iterations(1u << 20), kGuideIterations + 1) << "the vertices of more would fill the memory";
  settings.last_sample = 256;
  EXPECT_EQ(guide_iterations(settings, DeviceClass::gpu), kGuideIterations)
      << "a GPU has rendered before the host has trained";
  settings.time_limit = 1.0;
  EXPECT_EQ(iterations(1u << 20), kGuideIterations) << "as many paths as a CPU has in that time";
  settings.time_limit = 0.0, settings.target_error = 0.1;
  EXPECT_EQ(iterations(1u << 20), kGuideIterations) << "it may be short";
}

// The command line: the field is trained anew when a render is resumed, and by every part of one.
TEST_F(GuideTest, ResumedAndMergedPicturesAreThoseOfTheWhole) {
  const auto wavepath = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), WAVEPATH_BINARY);
    RunOptions options;
    options.folder = folder_.path().string();
    const Outcome outcome = run_program(arguments, options);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  };
  const auto render_as = [&](const std::string& output, std::vector<std::string> flags) {
    std::vector<std::string> all{"render",      "hatch.gltf", "--guide",      "--size", "32x24", "--spp", "12", "--eye",
                                 "0.1,1.0,0.6", "--look-at",  "2.2,0.9,-0.5", "--yfov", "69",    "-q",    "-o", output};
    all.insert(all.end(), flags.begin(), flags.end());
    wavepath(all);
  };
  const auto picture = [&](const std::string& name) { return read_picture((folder_.path() / name).string()); };
  render_as("whole.exr", {"--stats", "whole.json"});
  const auto stats = nlohmann::json::parse(std::ifstream(folder_.path() / "whole.json"));
  EXPECT_EQ(stats["guide"]["used"], true);
  EXPECT_GT(stats["guide"]["bytes"], 1000);
  EXPECT_EQ(stats["settings"]["guide"], true);
  render_as("part.exr", {"--checkpoint", "state", "--spp", "5"});
  render_as("part.exr", {"--checkpoint", "state", "--resume"});
  expect_same_bits(picture("part.exr"), picture("whole.exr"));
  render_as("whole.exr", {"--mergeable"}); // alone, it trains the sky for another time
  render_as("a.exr", {"--samples", "0:5"});
  render_as("b.exr", {"--samples", "5:12"});
  wavepath({"merge", "b.exr", "a.exr", "-o", "merged.exr"});
  expect_same_bits(picture("merged.exr"), picture("whole.exr"));
}

// A render that was to be long when it began has trained for longer, and keeps to that; parts have not.
TEST_F(GuideTest, ResumedRendersKeepTheirTraining) {
  const std::string state = (folder_.path() / "state").string();
  const auto render_on = [&](std::vector<std::string> flags) {
    std::vector<std::string> all{
        WAVEPATH_BINARY, "render",       "hatch.gltf",  "--guide", "--integrator", "path",
        "--size",        "64x48",        "--max-depth", "3",       "--eye",        "0.1,1.0,0.6",
        "--look-at",     "2.2,0.9,-0.5", "--yfov",      "69",      "-q",           "-o",
        "part.exr",      "--checkpoint", "state",       "--stats", "stats.json"};
    all.insert(all.end(), flags.begin(), flags.end());
    RunOptions options;
    options.folder = folder_.path().string();
    return run_program(all, options);
  };
  const auto training_paths = [&] {
    return nlohmann::json::parse(std::ifstream(folder_.path() / "stats.json"))["guide"]["pilot_paths"]
        .get<std::uint64_t>();
  };
  ASSERT_EQ(render_on({"--spp", "2"}).exit_code, 0);
  const std::uint64_t of_short = training_paths();
  StateRecord record = read_state(state);
  const std::string short_training = R"("guide-iterations","taken":"4")";
  const std::size_t at = record.plan.find(short_training);
  ASSERT_NE(at, std::string::npos) << record.plan;
  record.plan.replace(at, short_training.size(), R"("guide-iterations","taken":"5")");
  write_state(state, record.identity, record.device, record.plan, record.state);
  const Outcome part = render_on({"--spp", "3", "--resume", "--mergeable"});
  EXPECT_EQ(part.exit_code, 1);
  EXPECT_NE(part.err.find("cannot be merged"), std::string::npos) << part.err;
  ASSERT_EQ(render_on({"--spp", "3", "--resume"}).exit_code, 0);
  EXPECT_GT(training_paths(), of_short + (7u << 16)) << "an iteration of 2^19 paths more";
  EXPECT_NE(read_state(state).plan.find(R"("guide-iterations","taken":"5")"), std::string::npos);
}

} // namespace
} // namespace wavepath::test
