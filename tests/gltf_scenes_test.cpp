// Loads every real scene in shared/scenes: what its INDEX.md says must come out, or a refusal that is true.
#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "host/base/error.h"
#include "host/scene/gltf/gltf.h"
#include "host/scene/gltf/tangents.h"

namespace wavepath {
namespace {

const std::filesystem::path kScenes = std::filesystem::path(WAVEPATH_SOURCE_DIR) / "../shared/scenes";

std::vector<std::string> split(const std::string& text, const std::string& separator) {
  std::vector<std::string> parts;
  std::size_t first = 0;
  for (std::size_t at; (at = text.find(separator, first)) != std::string::npos; first = at + separator.size()) {
    parts.push_back(text.substr(first, at - first));
  }
  parts.push_back(text.substr(first));
  return parts;
}

std::size_t triangles_seen(const Scene& scene) {
  std::size_t count = 0;
  for (const Instance& instance : scene.instances) count += scene.meshes[instance.mesh].indices.size() / 3;
  return count;
}

// Every index in range, every array of the right size, every number that others rely on finite.
void expect_sound(const Scene& scene) {
  for (const Mesh& mesh : scene.meshes) {
    const std::size_t count = mesh.positions.size();
    EXPECT_TRUE(mesh.normals.empty() || mesh.normals.size() == count);
    EXPECT_TRUE(mesh.tangents.empty() || mesh.tangents.size() == count);
    EXPECT_TRUE(mesh.colors.empty() || mesh.colors.size() == count);
    for (const auto& uvs : mesh.uvs) EXPECT_TRUE(uvs.empty() || uvs.size() == count);
    for (const std::uint32_t index : mesh.indices) ASSERT_LT(index, count);
    for (const Primitive& primitive : mesh.primitives) {
      ASSERT_LE(primitive.first_index + primitive.index_count, mesh.indices.size());
      ASSERT_LT(primitive.material, scene.materials.size());
      const bool bumped = scene.materials[primitive.material].normal_texture.present();
      for (std::uint32_t i = 0; i < primitive.index_count; ++i) {
        const std::uint32_t vertex = mesh.indices[primitive.first_index + i];
        if (primitive.has_normals) {
          ASSERT_NEAR(glm::length(mesh.normals[vertex]), 1.0f, 1e-5f);
        }
        if (bumped) {
          ASSERT_NEAR(glm::length(glm::vec3(mesh.tangents[vertex])), 1.0f, 1e-5f);
          ASSERT_EQ(std::abs(mesh.tangents[vertex].w), 1.0f);
        }
      }
    }
  }
  for (const Image& image : scene.images) {
    EXPECT_EQ(image.bytes.size() + image.floats.size(), std::size_t{image.width} * image.height * 4);
  }
}

TEST(GltfScenes, EverySceneLoadsAsItsIndexSays) {
  std::ifstream index(kScenes / "INDEX.md");
  if (!index) GTEST_SKIP() << "no shared/scenes beside the repository";
  int loaded = 0;
  for (std::string line; std::getline(index, line);) {
    const std::vector<std::string> cells =
        split(line, " | "); // "| file", triangles [/ in the default scene], cameras, ...
    if (cells.size() < 9 || cells[0].find(".gl") == std::string::npos) continue;
    const std::string name = cells[0].substr(2);
    SCOPED_TRACE(name);
    std::string expected = split(cells[1], " / ").back();
    std::erase(expected, ',');
    try {
      const Scene scene = load_gltf(kScenes / name);
      EXPECT_EQ(triangles_seen(scene), std::stoul(expected));
      EXPECT_EQ(scene.cameras.size(), std::stoul(cells[2]));
      expect_sound(scene);
      ++loaded;
    } catch (const Error& error) {
      const std::string message = error.what();
      const bool iridescence =
          name.starts_with("IridescenceSuzanne") && message.find("KHR_materials_iridescence") != std::string::npos;
      EXPECT_TRUE(iridescence) << message;
    }
  }
  EXPECT_GE(loaded, 60); // the folder grows
}

// The box around all instances, and the summed area of their triangles.
struct Measure {
  glm::dvec3 lo{1e300}, hi{-1e300};
  double area = 0.0;
};

Measure measure(const Scene& scene) {
  Measure result;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    const auto at = [&](std::size_t i) {
      return glm::dvec3(instance.world_from_object * glm::dvec4(glm::dvec3(mesh.positions[mesh.indices[i]]), 1.0));
    };
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
      const glm::dvec3 a = at(i), b = at(i + 1), c = at(i + 2);
      result.lo = glm::min(result.lo, glm::min(a, glm::min(b, c)));
      result.hi = glm::max(result.hi, glm::max(a, glm::max(b, c)));
      result.area += 0.5 * glm::length(glm::cross(b - a, c - a));
    }
  }
  return result;
}

TEST(GltfScenes, CompressedFilesEqualPlainOnes) {
  if (!std::filesystem::exists(kScenes)) GTEST_SKIP() << "no shared/scenes beside the repository";
  const std::pair<const char*, const char*> pairs[] = {
      {"Box/glTF-Draco/Box.gltf", "Box/glTF/Box.gltf"},
      {"StanfordDragon/dragon-draco.gltf", "StanfordDragon/dragon-plain.glb"},
      {"HotelRoom/HotelRoom-meshopt.glb", "HotelRoom/HotelRoom-plain.glb"},
      {"MorphPrimitivesTest/glTF-Draco/MorphPrimitivesTest.gltf",
       "MorphPrimitivesTest/glTF-Binary/MorphPrimitivesTest.glb"}};
  for (const auto& [compressed_name, plain_name] : pairs) {
    SCOPED_TRACE(compressed_name);
    const Scene compressed = load_gltf(kScenes / compressed_name), plain = load_gltf(kScenes / plain_name);
    EXPECT_EQ(triangles_seen(compressed), triangles_seen(plain));
    EXPECT_EQ(compressed.materials.size(), plain.materials.size());
    const Measure a = measure(compressed), b = measure(plain);
    // Draco quantizes positions to 11 bits or more of the box.
    const double step = glm::length(b.hi - b.lo) / 1024;
    EXPECT_LT(glm::length(a.lo - b.lo), step);
    EXPECT_LT(glm::length(a.hi - b.hi), step);
    EXPECT_NEAR(a.area / b.area, 1.0, 2e-3);
  }
}

// Corner by corner, because vertices may have been split: the cosine between the tangents that a file has and those
// made of its positions, normals and texture coordinates; -1 for another handedness. Corners of triangles without an
// area in the texture are left out, for they have no tangent of their own.
std::vector<double> tangent_cosines(const std::filesystem::path& path) {
  std::vector<double> cosines;
  for (const Mesh& given : load_gltf(path).meshes) {
    if (given.tangents.empty()) continue;
    Mesh made = given;
    generate_tangents(made, made.uvs[0]);
    for (std::size_t i = 0; i < given.indices.size(); ++i) {
      const auto uv = [&](std::size_t k) { return glm::dvec2(given.uvs[0][given.indices[i - i % 3 + k]]); };
      const glm::dmat2 sides(uv(1) - uv(0), uv(2) - uv(0));
      if (glm::determinant(sides) == 0.0) continue;
      const glm::vec4 a = given.tangents[given.indices[i]], b = made.tangents[made.indices[i]];
      cosines.push_back(a.w == b.w ? glm::dot(glm::dvec3(a), glm::dvec3(b)) : -1.0);
    }
  }
  std::ranges::sort(cosines);
  return cosines;
}

TEST(GltfScenes, GeneratedTangentsEqualGivenOnes) {
  if (!std::filesystem::exists(kScenes)) GTEST_SKIP() << "no shared/scenes beside the repository";
  const std::vector<double> cosines = tangent_cosines(kScenes / "WaterBottle/glTF/WaterBottle.gltf");
  ASSERT_GT(cosines.size(), 13'000u);
  EXPECT_GT(cosines.front(), 1.0 - 1e-5) << "the worst corner";
}

// The tool that made this file's tangents is not MikkTSpace: Mikkelsen's own code differs from them by as much.
TEST(GltfScenes, GeneratedTangentsAreCloseToThoseOfAnotherTool) {
  if (!std::filesystem::exists(kScenes)) GTEST_SKIP() << "no shared/scenes beside the repository";
  const std::vector<double> cosines = tangent_cosines(kScenes / "FlightHelmet/FlightHelmet.gltf");
  ASSERT_GT(cosines.size(), 280'000u);
  const auto fraction_below = [&](double cosine) {
    return static_cast<double>(std::ranges::lower_bound(cosines, cosine) - cosines.begin()) /
           static_cast<double>(cosines.size());
  };
  EXPECT_LT(fraction_below(0.0), 1e-4);
  EXPECT_LT(fraction_below(0.9), 0.0012);
  EXPECT_LT(fraction_below(0.99), 0.017);
}

} // namespace
} // namespace wavepath
