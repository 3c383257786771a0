#include "host/integrators/radiosity/patch_mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <unordered_map>

#include "host/scene/pack/hit_surface.h"
#include "host/scene/pack/packed_scene.h"

namespace wavepath {
namespace {

struct Corner {
  glm::dvec3 position, normal;
};

struct VertexKey {
  std::array<std::uint32_t, 4> words{};
  bool operator==(const VertexKey&) const = default;
};
struct VertexKeyHash {
  std::size_t operator()(const VertexKey& key) const {
    std::uint64_t hash = 0;
    for (const std::uint32_t word : key.words) hash = (hash ^ word) * 0x9e3779b97f4a7c15u, hash ^= hash >> 29;
    return static_cast<std::size_t>(hash);
  }
};
using VertexTable = std::unordered_map<VertexKey, std::uint32_t, VertexKeyHash>;

// Normals are compared in steps of 1/100: those of one vertex differ by rounding alone.
VertexKey key_of(const Corner& corner) {
  VertexKey key;
  for (int i = 0; i < 3; ++i) {
    key.words[static_cast<std::size_t>(i)] =
        std::bit_cast<std::uint32_t>(static_cast<float>(corner.position[i]) + 0.0f);
    key.words[3] = key.words[3] << 8 | static_cast<std::uint32_t>(std::lround(corner.normal[i] * 100.0) + 128);
  }
  return key;
}

// Normals of the corners of a patch on its front: those of the vertices where the mesh is smooth.
std::array<glm::dvec3, 3> normals_of(const PackedScene& scene, const gpu::Patch& patch) {
  const gpu::Hit hit = {patch.triangle, patch.instance, 0.25f, 0.25f};
  const glm::dvec3 flat = geometric_normal(scene, hit);
  std::array<glm::dvec3, 3> normals = {flat, flat, flat};
  if (!(scene.triangles[patch.triangle].surface & gpu::kTriangleSmooth)) return normals;
  const glm::uvec4 vertex = scene.triangle_vertices[patch.triangle];
  const auto at = [&](std::uint32_t index) { return glm::dvec3(scene.vertex_normals[index]); };
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec2 b(patch.corner[i]);
    glm::dvec3 n = (1.0 - b.x - b.y) * at(vertex.x) + b.x * at(vertex.y) + b.y * at(vertex.z);
    if (scene.root_is_top) { // normals go by the inverse transpose
      const auto& rows = scene.instances[patch.instance].object_from_world;
      n = n.x * glm::dvec3(rows[0]) + n.y * glm::dvec3(rows[1]) + n.z * glm::dvec3(rows[2]);
    }
    const double length = glm::length(n);
    if (length > 0.0) normals[i] = glm::dot(n, flat) < 0.0 ? -n / length : n / length;
  }
  return normals;
}

std::array<Corner, 3> make_corners(const PackedScene& scene, const gpu::Patch& patch) {
  const std::array<glm::dvec3, 3> positions = corners_of(scene, patch), normals = normals_of(scene, patch);
  return {{{positions[0], normals[0]}, {positions[1], normals[1]}, {positions[2], normals[2]}}};
}

struct LeveledVertex {
  std::uint32_t level;
  HangingVertex vertex;
};

// Finds vertices of finer patches on the side from a to b.
void find_hanging(const VertexTable& table, const Corner& a, const Corner& b, std::uint32_t level,
                  std::vector<LeveledVertex>& found) {
  const glm::dvec3 normal = a.normal + b.normal;
  const Corner middle = {0.5 * (a.position + b.position), normal / std::max(glm::length(normal), 1e-30)};
  const auto vertex = table.find(key_of(middle));
  if (vertex == table.end() || level > gpu::kDeepestPatch) return;
  const HangingVertex hanging = {vertex->second, table.at(key_of(a)), table.at(key_of(b))};
  if (hanging.vertex == hanging.a || hanging.vertex == hanging.b) return; // too short for floats to have a middle
  found.push_back({level, hanging});
  find_hanging(table, a, middle, level + 1, found);
  find_hanging(table, middle, b, level + 1, found);
}

} // namespace

PatchMesh make_mesh(const PackedScene& scene, const PatchTree& tree) {
  PatchMesh mesh;
  VertexTable table;
  for (const gpu::Patch& patch : tree.patches) {
    const std::array<Corner, 3> corners = make_corners(scene, patch);
    std::array<std::uint32_t, 3> vertices{};
    for (std::size_t i = 0; i < 3; ++i)
      vertices[i] = table.try_emplace(key_of(corners[i]), static_cast<std::uint32_t>(table.size())).first->second;
    mesh.vertices.push_back(vertices);
    mesh.areas.push_back(0.5 * glm::length(glm::cross(corners[1].position - corners[0].position,
                                                      corners[2].position - corners[0].position)));
  }
  mesh.vertex_count = static_cast<std::uint32_t>(table.size());
  std::vector<LeveledVertex> found;
  for (std::uint32_t patch = 0; patch < tree.size(); ++patch) {
    const std::array<Corner, 3> corners = make_corners(scene, tree.patches[patch]);
    for (std::size_t i = 0; i < 3; ++i)
      find_hanging(table, corners[i], corners[(i + 1) % 3], tree.levels[patch], found);
  }
  std::ranges::stable_sort(found, {}, &LeveledVertex::level);
  for (const LeveledVertex& one : found) mesh.hanging.push_back(one.vertex);
  return mesh;
}

std::vector<glm::vec4> light_at_corners(const PatchMesh& mesh, std::span<const glm::dvec3> faces) {
  std::vector<glm::vec4> corners(faces.size() * 3, glm::vec4(0.0f));
  for (std::size_t side = 0; side < 2; ++side) {
    std::vector<glm::dvec4> sums(mesh.vertex_count, glm::dvec4(0.0));
    for (std::size_t patch = 0; patch < mesh.areas.size(); ++patch)
      for (const std::uint32_t vertex : mesh.vertices[patch])
        sums[vertex] += mesh.areas[patch] * glm::dvec4(faces[2 * patch + side], 1.0);
    for (glm::dvec4& sum : sums) sum /= std::max(sum.w, 1e-300);
    for (const HangingVertex& one : mesh.hanging) sums[one.vertex] = 0.5 * (sums[one.a] + sums[one.b]);
    for (std::size_t patch = 0; patch < mesh.areas.size(); ++patch)
      for (std::size_t i = 0; i < 3; ++i)
        corners[3 * (2 * patch + side) + i] = glm::vec4(glm::vec3(sums[mesh.vertices[patch][i]]), 0.0f);
  }
  return corners;
}

} // namespace wavepath
