// Bounds of alpha over triangles against exact look-ups, and what they leave out of a packed scene.
#include "host/scene/pack/alpha.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "bvh/traverse.h"
#include "host/scene/pack/pack.h"
#include "kernels/base/scene_types.h"
#include "tests/scene_builder.h"

namespace wavepath {
namespace {

// ---- the look-up of kernels/surface/texture.glsl and kernels/surface/surface.glsl, in single precision --------------
float wrapped(float u, Wrap wrap) {
  const auto fraction = [](float x) { return x - std::floor(x); };
  u = std::isfinite(u) ? u : 0.0f;
  if (wrap == Wrap::clamp) return std::clamp(u, 0.0f, 1.0f);
  if (wrap == Wrap::mirror) return 1.0f - std::abs(1.0f - 2.0f * fraction(0.5f * u));
  return fraction(u);
}

float texel_alpha(const Image& image, int x, int y) {
  const std::size_t i = 4 * (static_cast<std::size_t>(y) * image.width + static_cast<std::size_t>(x)) + 3;
  return image.floats.empty() ? image.bytes[i] : image.floats[i];
}

struct Taps {
  int first, second;
  float weight; // of the second
};

Taps taps(float x, int size, const TextureSlot& slot, Wrap wrap) {
  if (slot.nearest) return {std::clamp(static_cast<int>(x), 0, size - 1), 0, 0.0f};
  const float first = std::floor(x - 0.5f);
  int a = static_cast<int>(first), b = a + 1;
  if (wrap == Wrap::repeat) a = a < 0 ? a + size : a, b = b >= size ? b - size : b;
  return {std::clamp(a, 0, size - 1), std::clamp(b, 0, size - 1), x - 0.5f - first};
}

float looked_up(const Image& image, const TextureSlot& slot, glm::vec2 uv) {
  uv = slot.uv_matrix * uv + slot.uv_offset;
  const int width = static_cast<int>(image.width), height = static_cast<int>(image.height);
  const Taps column = taps(wrapped(uv.x, slot.wrap_u) * static_cast<float>(width), width, slot, slot.wrap_u),
             row = taps(wrapped(uv.y, slot.wrap_v) * static_cast<float>(height), height, slot, slot.wrap_v);
  const auto between = [](float first, float second, float fraction) { return first + fraction * (second - first); };
  const auto mixed = [&](int y) {
    return between(texel_alpha(image, column.first, y), texel_alpha(image, column.second, y), column.weight);
  };
  return between(mixed(row.first), mixed(row.second), row.weight) / (image.floats.empty() ? 255.0f : 1.0f);
}

template <typename T>
T interpolated(const T& a, const T& b, const T& c, const glm::vec3& weights) {
  return a + weights.y * (b - a) + weights.z * (c - a);
}

float looked_up_alpha(const Scene& scene, const glm::vec3& weights) {
  const Material& m = scene.materials[0];
  const Mesh& mesh = scene.meshes[0];
  float alpha = m.base_color.a;
  if (!mesh.colors.empty()) {
    const auto [lo, hi] = std::minmax({mesh.colors[0].a, mesh.colors[1].a, mesh.colors[2].a});
    alpha *= std::clamp(interpolated(mesh.colors[0].a, mesh.colors[1].a, mesh.colors[2].a, weights), lo, hi);
  }
  if (const TextureSlot& slot = m.base_color_texture; slot.present()) {
    const auto& uvs = mesh.uvs[slot.uv_set];
    alpha *= looked_up(scene.images[slot.image], slot, interpolated(uvs[0], uvs[1], uvs[2], weights));
  }
  return alpha;
}

// ---- random triangles -----------------------------------------------------------------------------------------------
class Dice {
public:
  explicit Dice(unsigned seed) : numbers_(seed) {}
  int below(int end) { return std::uniform_int_distribution<int>(0, end - 1)(numbers_); }
  float between(float lo, float hi) { return std::uniform_real_distribution<float>(lo, hi)(numbers_); }
  template <typename T>
  T one_of(std::initializer_list<T> values) {
    return *(values.begin() + below(static_cast<int>(values.size())));
  }

private:
  std::mt19937 numbers_;
};

// Patches of alpha, so that triangles lie in one or across several.
Image random_image(Dice& dice) {
  Image image{.width = static_cast<std::uint32_t>(1 + dice.below(24)),
              .height = static_cast<std::uint32_t>(1 + dice.below(24))};
  image.bytes.assign(std::size_t{4} * image.width * image.height, dice.one_of<std::uint8_t>({0, 255}));
  for (int patch = 0; patch < 3; ++patch) {
    const std::uint32_t x = static_cast<std::uint32_t>(dice.below(static_cast<int>(image.width))),
                        y = static_cast<std::uint32_t>(dice.below(static_cast<int>(image.height)));
    const auto alpha = dice.one_of<std::uint8_t>({0, 100, 140, 255, 255});
    for (std::uint32_t v = y; v < std::min(y + 9, image.height); ++v)
      for (std::uint32_t u = x; u < std::min(x + 9, image.width); ++u)
        image.bytes[4 * (v * image.width + u) + 3] = alpha;
  }
  if (dice.below(4) == 0) {
    for (const std::uint8_t byte : image.bytes) image.floats.push_back(byte / 255.0f * dice.one_of({1.0f, 0.99f}));
    image.bytes.clear();
  }
  return image;
}

Scene random_scene(Dice& dice) {
  Scene scene = triangle_scene();
  scene.images.push_back(random_image(dice));
  Material& m = scene.materials[0];
  m.alpha_mode = dice.one_of({AlphaMode::mask, AlphaMode::mask, AlphaMode::blend});
  m.alpha_cutoff = dice.one_of({0.5f, 0.3f, 0.9f, 1.0f, 140 / 255.0f});
  m.base_color.a = dice.one_of({1.0f, 1.0f, 0.8f});
  TextureSlot& slot = m.base_color_texture;
  slot.image = 0;
  slot.wrap_u = dice.one_of({Wrap::repeat, Wrap::clamp, Wrap::mirror});
  slot.wrap_v = dice.one_of({Wrap::repeat, Wrap::clamp, Wrap::mirror});
  slot.nearest = dice.below(3) == 0;
  slot.uv_set = static_cast<std::uint32_t>(dice.below(2));
  if (dice.below(3) == 0) {
    const float turn = dice.between(0.0f, 6.28f), size = dice.between(0.3f, 2.0f);
    slot.uv_matrix = size * glm::mat2(std::cos(turn), std::sin(turn), -std::sin(turn), 0.7f * std::cos(turn));
    slot.uv_offset = {dice.between(-2.0f, 2.0f), dice.between(-2.0f, 2.0f)};
  }
  Mesh& mesh = scene.meshes[0];
  const glm::vec2 middle(dice.between(-1.5f, 2.5f), dice.between(-1.5f, 2.5f));
  const float radius = dice.one_of({0.02f, 0.1f, 0.3f, 1.0f});
  for (auto& uvs : mesh.uvs)
    for (int k = 0; k < 3; ++k)
      uvs.push_back(middle + radius * glm::vec2(dice.between(-1.0f, 1.0f), dice.between(-1.0f, 1.0f)));
  if (dice.below(4) == 0)
    for (int k = 0; k < 3; ++k) mesh.colors.emplace_back(1.0f, 1.0f, 1.0f, dice.one_of({1.0f, 0.9f, 0.4f, 0.3f}));
  return scene;
}

Coverage coverage_of(const Scene& scene) {
  return AlphaCoverage(scene, find_usage(scene)).of_triangle(scene.meshes[0], scene.materials[0], 0);
}

// Points of the triangle, its corners and edges among them.
glm::vec3 random_weights(Dice& dice, int point) {
  glm::vec3 weights(0.0f);
  if (point < 3) {
    weights[point] = 1.0f;
    return weights;
  }
  const float a = dice.between(0.0f, 1.0f), b = dice.between(0.0f, 1.0f - a);
  weights = point < 60 ? glm::vec3(a, 1.0f - a, 0.0f) : glm::vec3(a, b, 1.0f - a - b);
  std::swap(weights[2], weights[dice.below(3)]);
  return weights;
}

TEST(Alpha, BoundsWhatLookUpsFind) {
  Dice dice(7);
  int counts[4] = {}, pure = 0, missed = 0;
  for (int round = 0; round < 20000; ++round) {
    const Scene scene = random_scene(dice);
    const Coverage found = coverage_of(scene);
    ++counts[static_cast<std::size_t>(found)];
    float lo = 2.0f, hi = -1.0f;
    for (int point = 0; point < 200; ++point) {
      const float alpha = looked_up_alpha(scene, random_weights(dice, point));
      lo = std::min(lo, alpha), hi = std::max(hi, alpha);
    }
    const Material& m = scene.materials[0];
    const float wanted = m.alpha_mode == AlphaMode::mask ? m.alpha_cutoff : 1.0f;
    ASSERT_TRUE(found != Coverage::opaque || lo >= wanted) << round; // a blend of equals does not round
    ASSERT_TRUE(found != Coverage::hole || (m.alpha_mode == AlphaMode::mask && hi < wanted)) << round;
    const bool is_pure = lo >= wanted || (m.alpha_mode == AlphaMode::mask && hi < wanted);
    pure += is_pure, missed += is_pure && found == Coverage::mixed;
  }
  EXPECT_EQ(counts[0], 0);
  EXPECT_GT(counts[static_cast<std::size_t>(Coverage::opaque)], 3000);
  EXPECT_GT(counts[static_cast<std::size_t>(Coverage::hole)], 1000);
  EXPECT_GT(counts[static_cast<std::size_t>(Coverage::mixed)], 3000);
  EXPECT_LT(missed, pure / 8) << pure; // bounds over texels cannot tell where a blend crosses the cutoff
}

// A row of 16 texels, of which 5 to 10 are opaque.
Scene striped_scene(float from, float to) {
  Scene scene = triangle_scene();
  Image image{.width = 16, .height = 4};
  for (std::uint32_t i = 0; i < 64; ++i) {
    const bool solid = i % 16 >= 5 && i % 16 <= 10;
    image.bytes.insert(image.bytes.end(), {255, 255, 255, static_cast<std::uint8_t>(solid ? 255 : 0)});
  }
  scene.images.push_back(image);
  scene.materials[0].alpha_mode = AlphaMode::mask;
  scene.materials[0].base_color_texture.image = 0;
  scene.meshes[0].uvs[0] = {{from / 16, 0.1f}, {to / 16, 0.2f}, {to / 16, 0.9f}};
  return scene;
}

TEST(Alpha, IsBoundedToAFractionOfATexel) {
  EXPECT_EQ(coverage_of(striped_scene(5.53f, 10.47f)), Coverage::opaque); // centres at 5.5 and 10.5
  EXPECT_EQ(coverage_of(striped_scene(5.47f, 10.47f)), Coverage::mixed);
  EXPECT_EQ(coverage_of(striped_scene(5.53f, 10.53f)), Coverage::mixed);
  EXPECT_EQ(coverage_of(striped_scene(11.53f, 15.9f)), Coverage::hole);
  EXPECT_EQ(coverage_of(striped_scene(11.53f, 20.47f)), Coverage::hole); // repeats
  EXPECT_EQ(coverage_of(striped_scene(11.53f, 20.53f)), Coverage::mixed);
  EXPECT_EQ(coverage_of(striped_scene(16 * 1000 + 5.6f, 16 * 1000 + 10.4f)), Coverage::opaque);
  Scene unfiltered = striped_scene(5.03f, 10.97f);
  EXPECT_EQ(coverage_of(unfiltered), Coverage::mixed);
  unfiltered.materials[0].base_color_texture.nearest = true;
  EXPECT_EQ(coverage_of(unfiltered), Coverage::opaque);
  Scene clamped = striped_scene(11.53f, 900.0f);
  EXPECT_EQ(coverage_of(clamped), Coverage::mixed);
  clamped.materials[0].base_color_texture.wrap_u = Wrap::clamp;
  EXPECT_EQ(coverage_of(clamped), Coverage::hole);
  EXPECT_EQ(coverage_of(striped_scene(5.6f, 1e30f)), Coverage::mixed);
  EXPECT_EQ(coverage_of(striped_scene(5.6f, std::numeric_limits<float>::infinity())), Coverage::mixed); // u = 0
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(coverage_of(striped_scene(nan, nan)), Coverage::mixed);
}

// A long triangle in a diagonal band of texels, whose box holds others.
TEST(Alpha, IsBoundedWithinTheTriangle) {
  Scene scene = striped_scene(0.0f, 0.0f);
  Image& image = scene.images[0];
  image = {.width = 32, .height = 32};
  for (int i = 0; i < 1024; ++i) {
    const bool solid = std::abs(i % 32 - i / 32) < 4;
    image.bytes.insert(image.bytes.end(), {255, 255, 255, static_cast<std::uint8_t>(solid ? 255 : 0)});
  }
  scene.meshes[0].uvs[0] = {{0.1f, 0.1f}, {0.9f, 0.9f}, {0.5f, 0.52f}};
  EXPECT_EQ(coverage_of(scene), Coverage::opaque);
  scene.meshes[0].uvs[0][2].y = 0.65f;
  EXPECT_EQ(coverage_of(scene), Coverage::mixed);
}

TEST(Alpha, OfFloatsIsRoundedOutwards) {
  Scene scene = striped_scene(0.0f, 16.0f);
  for (const auto& [alpha, expected] : {std::pair{0.49f, Coverage::hole},
                                        {0.4999f, Coverage::mixed},
                                        {0.5001f, Coverage::mixed},
                                        {0.51f, Coverage::opaque}}) {
    scene.images[0] = {.width = 2, .height = 1, .floats = std::vector<float>(8, alpha)};
    EXPECT_EQ(coverage_of(scene), expected) << alpha;
  }
}

TEST(Alpha, OfVerticesThatIsNotANumberMayBeAnything) {
  Scene scene = striped_scene(5.53f, 10.47f);
  scene.meshes[0].colors.assign(3, glm::vec4(1.0f));
  EXPECT_EQ(coverage_of(scene), Coverage::opaque);
  scene.meshes[0].colors[1].a = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(coverage_of(scene), Coverage::mixed);
}

// ---- packing --------------------------------------------------------------------------------------------------------
// Triangles in a row: opaque, a hole, cut out, and opaque.
Scene row_of_four() {
  Scene scene = striped_scene(5.53f, 10.47f);
  Mesh& mesh = scene.meshes[0];
  for (const auto& [from, to] : {std::pair{11.53f, 15.0f}, {4.0f, 7.0f}, {6.0f, 9.0f}}) {
    const float x = static_cast<float>(mesh.positions.size());
    const std::vector<glm::vec2> uvs = striped_scene(from, to).meshes[0].uvs[0];
    for (std::size_t k = 0; k < 3; ++k) {
      mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
      mesh.positions.push_back(kUnitTriangle[k] + glm::vec3(x, 0.0f, 0.0f));
      mesh.uvs[0].push_back(uvs[k]);
    }
  }
  mesh.primitives[0].index_count = 12;
  return scene;
}

std::vector<std::pair<std::uint32_t, bool>> asked_by_id(const PackedScene& packed) {
  std::vector<std::pair<std::uint32_t, bool>> list;
  for (const gpu::Triangle& t : packed.triangles) list.emplace_back(t.id, (t.surface & gpu::kTriangleAlpha) != 0);
  std::ranges::sort(list);
  return list;
}

// Whether a ray at the triangle's middle finds it in the tree.
bool is_met(const PackedScene& packed, const gpu::Triangle& triangle) {
  const glm::vec3 middle = (triangle.v0 + triangle.v1 + triangle.v2) / 3.0f;
  bool met = false;
  bvh::traverse(packed.nodes, packed.root, bvh::prepare({{middle.x, middle.y, 9.0f}, {0.0f, 0.0f, -1.0f}}),
                bvh::Order::nearest_first, [&](std::uint32_t first, std::uint32_t count, float&) {
                  for (std::uint32_t i = first; i < first + count; ++i) met |= &packed.triangles[i] == &triangle;
                  return false;
                });
  return met;
}

using Asked = std::vector<std::pair<std::uint32_t, bool>>;

TEST(Alpha, OfTrianglesDecidesWhatRaysLookUp) {
  Scene scene = row_of_four();
  const PackedScene packed = pack(scene);
  EXPECT_EQ(asked_by_id(packed), (Asked{{0, false}, {2, true}, {3, false}})); // ids as if the hole were there
  EXPECT_EQ(packed.alpha.asked, 1u);
  EXPECT_EQ(packed.alpha.opaque, 2u);
  EXPECT_EQ(packed.alpha.holes, 1u);
  EXPECT_EQ(packed.triangle_count, 3u);
  EXPECT_EQ(packed.dropped_triangles, 0u);
  EXPECT_EQ(scene.warnings.counts().size(), 0u);
  const auto told = std::ranges::find(packed.left_out, "alpha look-ups", &LeftOut::what);
  ASSERT_NE(told, packed.left_out.end());
  EXPECT_EQ(told->why, "2 of 4 triangles are opaque, 1 are holes");
  EXPECT_EQ(told->bytes, 64u);
  for (const gpu::Triangle& t : packed.triangles) { // each with its own corners and vertices
    const auto item = static_cast<std::size_t>(&t - packed.triangles.data());
    EXPECT_EQ(packed.triangle_vertices[item].x, 3 * t.id);
    EXPECT_EQ(glm::dvec3(t.v0) + packed.origin, glm::dvec3(scene.meshes[0].positions[3 * t.id]));
    EXPECT_TRUE(is_met(packed, t));
  }
}

TEST(Alpha, LeavesNoLookUpsWhereNoneAreNeeded) {
  Scene scene = striped_scene(5.53f, 10.47f);
  const PackedScene packed = pack(scene);
  EXPECT_EQ(packed.features & gpu::kFeatureAlpha, 0u);
  Scene scene_without = triangle_scene();
  const PackedScene plain = pack(scene_without);
  EXPECT_EQ(plain.alpha.total(), 0u);
  EXPECT_EQ(std::ranges::find(plain.left_out, "alpha look-ups", &LeftOut::what), plain.left_out.end());
}

TEST(Alpha, OfOpaqueUnlitSurfacesIsNotBounded) {
  Scene scene = row_of_four();
  scene.materials[0].unlit = true;
  scene.materials[0].alpha_mode = AlphaMode::opaque;
  const PackedScene packed = pack(scene);
  EXPECT_EQ(asked_by_id(packed), (Asked{{0, true}, {1, true}, {2, true}, {3, true}})); // rays pass, except the eye's
  EXPECT_EQ(packed.alpha.total(), 0u);
}

TEST(Alpha, KeepsHolesThatSomethingElseCounts) {
  Scene shining = row_of_four();
  shining.materials[0].emission = glm::vec3(1.0f);
  const PackedScene lights = pack(shining);
  EXPECT_EQ(asked_by_id(lights), (Asked{{0, false}, {1, true}, {2, true}, {3, false}}));
  EXPECT_EQ(lights.lights.size(), 4u);
  EXPECT_EQ(lights.alpha.holes, 0u);
  Scene glass = row_of_four();
  glass.materials[0].transmission = 1.0f, glass.materials[0].volume = true;
  EXPECT_EQ(asked_by_id(pack(glass)), (Asked{{0, false}, {1, true}, {2, true}, {3, false}}));
  Scene unlit = row_of_four();
  unlit.materials[0].unlit = true; // opaque for the eye alone
  EXPECT_EQ(asked_by_id(pack(unlit)), (Asked{{0, true}, {2, true}, {3, true}}));
}

TEST(Alpha, OfSharedMeshesIsCountedOnce) {
  Scene scene = row_of_four();
  add_instance(scene, 0, glm::translate(glm::dmat4(1.0), glm::dvec3(0.0, 5.0, 0.0)));
  const PackedScene packed = pack(scene);
  EXPECT_EQ(packed.alpha.holes, 1u);
  EXPECT_EQ(packed.triangle_count, 6u);
  EXPECT_EQ(packed.triangles.size(), 3u);
}

TEST(Alpha, OfAMeshThatIsAllHolesLeavesNothing) {
  Scene scene = striped_scene(11.53f, 15.0f);
  EXPECT_TRUE(pack(scene).triangles.empty());
  EXPECT_TRUE(pack(scene).draws.empty());
  add_instance(scene, 0, glm::translate(glm::dmat4(1.0), glm::dvec3(0.0, 5.0, 0.0)));
  EXPECT_EQ(pack(scene).triangle_count, 0u);
}

TEST(Alpha, OfWhatMovesKeepsTheMotionOfItsTriangle) {
  Scene scene = row_of_four();
  Mesh& mesh = scene.meshes[0];
  mesh.end_positions = mesh.positions;
  for (std::size_t v = 0; v < 12; ++v) mesh.end_positions[v].z += static_cast<float>(v / 3);
  const PackedScene packed = pack(scene);
  ASSERT_EQ(packed.motions.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(packed.motions[i].v0, glm::vec3(0.0f, 0.0f, static_cast<float>(packed.triangles[i].id)));
}

} // namespace
} // namespace wavepath
