// Fills the vertex streams; see vertices.h.
#include "host/scene/pack/vertices.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <tbb/parallel_for.h>

namespace wavepath {
namespace {

template <typename Vector>
bool all_finite(const Vector& v) {
  for (int i = 0; i < Vector::length(); ++i)
    if (!std::isfinite(v[i])) return false;
  return true;
}

glm::dvec3 unit_or_zero(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 0.0 && std::isfinite(length) ? v / length : glm::dvec3(0.0);
}

// `normals` and `tangents`: of `count` vertices each, or empty.
void pack_normals(const std::vector<glm::vec3>& normals, const std::vector<glm::vec4>& tangents, std::size_t count,
                  const glm::dmat3& linear, std::uint32_t first, std::vector<glm::vec4>& out) {
  const glm::dmat3 normal_matrix = glm::transpose(glm::inverse(linear));
  // cross(M a, M b) = det(M) M^-T cross(a, b): where M mirrors, the bitangent cross(n, t) * w is kept only if w changes
  // sign.
  const float handedness = glm::determinant(linear) < 0.0 ? -1.0f : 1.0f;
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t v) {
    const glm::vec3 normal =
        normals.empty() ? glm::vec3(0.0f) : glm::vec3(unit_or_zero(normal_matrix * glm::dvec3(normals[v])));
    float tangent = 0.0f;
    if (!tangents.empty()) {
      const glm::dvec3 t = unit_or_zero(linear * glm::dvec3(glm::vec3(tangents[v])));
      tangent = pack_tangent({glm::vec3(t), tangents[v].w * handedness});
    }
    out[first + v] = {normal, tangent};
  });
}

// Into the components of `out` from `component` on, the mesh's tangents of coat and grain; where it has none, those of
// its normal map stand there.
void pack_layer_tangents(const std::vector<glm::vec4>* layers, const std::vector<glm::vec4>& tangents,
                         std::size_t count, const glm::dmat3& linear, int component, glm::vec4* out) {
  const float handedness = glm::determinant(linear) < 0.0 ? -1.0f : 1.0f;
  for (int layer = 0; layer < 2; ++layer)
    for (std::size_t v = 0; v < count; ++v) {
      const bool own = !layers[layer].empty() && layers[layer][v].w != 0.0f;
      if (!own && tangents.empty()) continue;
      const glm::vec4& tangent = own ? layers[layer][v] : tangents[v];
      const glm::dvec3 t = unit_or_zero(linear * glm::dvec3(glm::vec3(tangent)));
      out[v][component + layer] = pack_tangent({glm::vec3(t), tangent.w * handedness});
    }
}

// Returns how many coordinates were not finite.
std::size_t pack_uvs(const Mesh& mesh, std::uint32_t first, std::vector<glm::vec4>& out) {
  std::size_t repaired = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    glm::vec4& uvs = out[first + v];
    for (int set = 0; set < 2; ++set) {
      if (mesh.uvs[set].empty()) continue;
      const glm::vec2 uv = mesh.uvs[set][v];
      if (!all_finite(uv)) {
        ++repaired;
        continue;
      }
      uvs[2 * set] = uv.x;
      uvs[2 * set + 1] = uv.y;
    }
  }
  return repaired;
}

} // namespace

float pack_tangent(const glm::vec4& tangent) {
  const float norm = std::abs(tangent.x) + std::abs(tangent.y) + std::abs(tangent.z);
  if (!(norm > 0.0f) || !std::isfinite(norm)) return 0.0f;
  glm::vec2 p = glm::vec2(tangent) / norm;
  if (tangent.z < 0.0f) {
    const glm::vec2 sign{p.x < 0.0f ? -1.0f : 1.0f, p.y < 0.0f ? -1.0f : 1.0f};
    p = (1.0f - glm::abs(glm::vec2(p.y, p.x))) * sign;
  }
  const auto x = static_cast<std::uint32_t>(std::lround((p.x * 0.5f + 0.5f) * 65535.0f));
  const auto y = static_cast<std::uint32_t>(std::lround((p.y * 0.5f + 0.5f) * 32767.0f));
  const std::uint32_t bits = x << 16 | y << 1 | (tangent.w < 0.0f ? 1u : 0u);
  return std::bit_cast<float>(bits == 0 ? 2u : bits); // the next y, a turn of 1e-4 at most: 0 says "no tangent"
}

Streams needed_streams(const Scene& scene, const Usage& usage) {
  Streams streams;
  streams.normals = usage.smooth;
  streams.colors = usage.colored;
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    if (!usage.material_used[m]) continue;
    streams.normals = streams.normals || needs_tangents(scene.materials[m]);
    streams.layer_tangents = streams.layer_tangents || has_layer_tangents(scene.materials[m]);
    visit_textures(scene.materials[m], [&](const MaterialTexture&, const TextureSlot&) { streams.uvs = true; });
  }
  return streams;
}

void pack_vertices(Scene& scene, const Usage& usage, const Streams& streams, PackedScene& packed) {
  std::vector<glm::dmat3> linear(scene.meshes.size(), glm::dmat3(1.0));
  for (const Instance& instance : scene.instances)
    if (usage.mesh_instances[instance.mesh] == 1) linear[instance.mesh] = glm::dmat3(instance.world_from_object);

  if (packed.moves()) packed.end_normals = static_cast<std::uint32_t>(usage.vertex_count);
  if (streams.layer_tangents)
    packed.layer_tangents = static_cast<std::uint32_t>(usage.vertex_count) + packed.end_normals;
  const std::size_t normals = usage.vertex_count + packed.end_normals;
  if (streams.normals)
    packed.vertex_normals.assign(normals + (streams.layer_tangents ? usage.vertex_count : 0), glm::vec4(0.0f));
  if (streams.uvs) packed.vertex_uvs.assign(usage.vertex_count, glm::vec4(0.0f));
  if (streams.colors) packed.vertex_colors.assign(usage.vertex_count, glm::vec4(1.0f));
  std::size_t repaired = 0;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    if (usage.mesh_instances[m] == 0) continue;
    const Mesh& mesh = scene.meshes[m];
    const std::uint32_t first = usage.first_vertex[m];
    const std::size_t count = mesh.positions.size();
    if (streams.normals) pack_normals(mesh.normals, mesh.tangents, count, linear[m], first, packed.vertex_normals);
    if (streams.normals && packed.moves()) {
      const auto& normals = mesh.moves() ? mesh.end_normals : mesh.normals;
      const auto& tangents = mesh.moves() ? mesh.end_tangents : mesh.tangents;
      pack_normals(normals, tangents, count, linear[m], first + packed.end_normals, packed.vertex_normals);
    }
    if (streams.layer_tangents) {
      glm::vec4* out = packed.vertex_normals.data() + first + packed.layer_tangents;
      pack_layer_tangents(mesh.layer_tangents, mesh.tangents, count, linear[m], 0, out);
      const bool moves = mesh.moves();
      if (packed.moves())
        pack_layer_tangents(moves ? mesh.end_layer_tangents : mesh.layer_tangents,
                            moves ? mesh.end_tangents : mesh.tangents, count, linear[m], 2, out);
    }
    if (streams.uvs) repaired += pack_uvs(mesh, first, packed.vertex_uvs);
    if (streams.colors) std::copy(mesh.colors.begin(), mesh.colors.end(), packed.vertex_colors.begin() + first);
  }
  if (repaired > 0) scene.warnings.add("texture coordinates that are not finite were set to zero", repaired);
}

} // namespace wavepath
