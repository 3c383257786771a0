#include "host/integrators/radiosity/patch_tree.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "host/scene/pack/packed_scene.h"

namespace wavepath {
namespace {

glm::dvec3 to_world(const PackedScene& scene, std::uint32_t instance, const glm::dvec3& p) {
  if (!scene.root_is_top) return p;
  const auto& rows = scene.instances[instance].world_from_object;
  const glm::dvec4 q(p, 1.0);
  return {glm::dot(glm::dvec4(rows[0]), q), glm::dot(glm::dvec4(rows[1]), q), glm::dot(glm::dvec4(rows[2]), q)};
}

gpu::Patch whole_triangle(std::uint32_t triangle, std::uint32_t instance) {
  return {triangle, instance, {{0.0f, 0.0f}, {1.0f, 0.0f}, {0.0f, 1.0f}}};
}

// Every placed triangle as one patch. Copies of a triangle, which trees with spatial splits have, share its root.
PatchTree whole_triangles(const PackedScene& scene) {
  PatchTree tree;
  tree.roots.assign(scene.root_is_top ? scene.instances.size() : 1, 0);
  for (const Draw& draw : scene.draws)
    for (std::uint32_t k = draw.first_instance; k < draw.first_instance + draw.instance_count; ++k) {
      tree.roots[k] = static_cast<std::uint32_t>(tree.roots.size()) - draw.first_triangle; // modulo 2^32
      std::unordered_map<std::uint32_t, std::uint32_t> root_of_id;
      for (std::uint32_t i = draw.first_triangle; i < draw.first_triangle + draw.triangle_count; ++i) {
        const auto [found, is_new] =
            root_of_id.try_emplace(scene.triangles[i].id, static_cast<std::uint32_t>(tree.nodes.size()));
        tree.roots.push_back(found->second);
        if (!is_new) continue;
        tree.leaves.push_back(found->second);
        tree.nodes.push_back(gpu::kPatchLeaf | tree.size());
        tree.patches.push_back(whole_triangle(i, k));
        tree.levels.push_back(0);
      }
    }
  return tree;
}

double area_of(const std::array<glm::dvec3, 3>& p) { return 0.5 * glm::length(glm::cross(p[1] - p[0], p[2] - p[0])); }

// Cuts that leave no patch of a triangle larger than `largest`.
std::uint32_t cuts_for(double area, double largest) {
  std::uint32_t cuts = 0;
  while (area > largest && cuts < gpu::kDeepestPatch) area /= 4.0, ++cuts;
  return cuts;
}

double patches_for(const std::vector<double>& areas, double largest) {
  double sum = 0.0;
  for (const double area : areas) sum += std::pow(4.0, cuts_for(area, largest));
  return sum;
}

} // namespace

std::array<glm::dvec3, 3> corners_of(const PackedScene& scene, const gpu::Patch& patch) {
  const gpu::Triangle& t = scene.triangles[patch.triangle];
  std::array<glm::dvec3, 3> corners;
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec2 b(patch.corner[i]);
    corners[i] = to_world(scene, patch.instance,
                          (1.0 - b.x - b.y) * glm::dvec3(t.v0) + b.x * glm::dvec3(t.v1) + b.y * glm::dvec3(t.v2));
  }
  return corners;
}

bool split(PatchTree& tree, std::uint32_t patch) {
  if (tree.levels[patch] >= gpu::kDeepestPatch) return false;
  const gpu::Patch whole = tree.patches[patch];
  const auto level = static_cast<std::uint8_t>(tree.levels[patch] + 1);
  const glm::vec2 a = whole.corner[0], b = whole.corner[1], c = whole.corner[2];
  const glm::vec2 ab = 0.5f * (a + b), bc = 0.5f * (b + c), ca = 0.5f * (c + a);
  const std::array<std::array<glm::vec2, 3>, 4> parts = {{{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {bc, ca, ab}}};
  const auto first = static_cast<std::uint32_t>(tree.nodes.size());
  tree.nodes[tree.leaves[patch]] = first;
  for (std::uint32_t k = 0; k < 4; ++k) {
    const gpu::Patch part = {whole.triangle, whole.instance, {parts[k][0], parts[k][1], parts[k][2]}};
    const std::uint32_t index = k == 0 ? patch : tree.size();
    if (k > 0) {
      tree.patches.push_back(part);
      tree.leaves.push_back(first + k);
      tree.levels.push_back(level);
    }
    tree.patches[index] = part;
    tree.leaves[index] = first + k;
    tree.levels[index] = level;
    tree.nodes.push_back(gpu::kPatchLeaf | index);
  }
  return true;
}

PatchTree uniform_patches(const PackedScene& scene, std::uint32_t count) {
  PatchTree tree = whole_triangles(scene);
  std::vector<double> areas;
  areas.reserve(tree.size());
  for (const gpu::Patch& patch : tree.patches) areas.push_back(area_of(corners_of(scene, patch)));
  double high = 0.0;
  for (const double area : areas) high = std::max(high, area);
  double low = high * std::pow(0.25, gpu::kDeepestPatch);
  if (tree.size() >= count || !(high > 0.0)) return tree;
  for (int i = 0; i < 60; ++i) { // bisection of the logarithm, to its last bits
    const double middle = std::sqrt(low * high);
    (patches_for(areas, middle) <= count ? high : low) = middle;
  }
  for (std::uint32_t patch = 0; patch < areas.size(); ++patch) {
    const std::uint32_t cuts = cuts_for(areas[patch], high);
    std::vector<std::uint32_t> parts = {patch};
    for (std::uint32_t k = 0; k < cuts; ++k)
      for (std::size_t i = 0, n = parts.size(); i < n; ++i) {
        const std::uint32_t next = tree.size();
        split(tree, parts[i]);
        parts.insert(parts.end(), {next, next + 1, next + 2});
      }
  }
  return tree;
}

std::uint64_t patch_bytes(std::uint64_t patches, std::uint64_t triangles, bool links) {
  constexpr std::uint64_t kOfFace = 3 * sizeof(gpu::vec4) + sizeof(gpu::vec4);
  constexpr std::uint64_t kOfPatch = sizeof(gpu::Patch) + sizeof(gpu::PatchSurface) + 2 * kOfFace;
  const std::uint64_t size = std::max(patches, triangles), nodes = links ? size + size / 3 : 0;
  return size * (kOfPatch + 2 * sizeof(std::uint32_t)) + triangles * sizeof(std::uint32_t) + nodes * sizeof(gpu::Patch);
}

} // namespace wavepath
