// Fills the vertex streams; see vertices.h.
#include "host/scene/pack/vertices.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <tbb/parallel_for.h>

#include "host/base/error.h"

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

// Packed tangent of a vertex of a piece, in the space that `linear` leads to.
float cut_tangent(const Mesh& mesh, const std::vector<glm::vec4>& tangents, const CutVertex& vertex,
                  const glm::dmat3& linear) {
  if (tangents.empty()) return 0.0f;
  const float handedness = glm::determinant(linear) < 0.0 ? -1.0f : 1.0f;
  glm::dvec3 sum(0.0);
  for (std::uint32_t k = 0; k < 3; ++k)
    sum += vertex.weights[k] *
           unit_or_zero(linear * glm::dvec3(glm::vec3(tangents[mesh.indices[vertex.first_index + k]])));
  return pack_tangent({glm::vec3(unit_or_zero(sum)), tangents[mesh.indices[vertex.first_index]].w * handedness});
}

// A normal is not made a unit vector: blended again, kernels find the direction that the whole triangle has there.
void pack_cut_normals(const Scene& scene, const Usage& usage, std::span<const CutVertex> cut,
                      const std::vector<glm::dmat3>& linear, bool closed, std::size_t first, std::size_t first_normal,
                      std::vector<glm::vec4>& out) {
  tbb::parallel_for(std::size_t{0}, cut.size(), [&](std::size_t i) {
    const Mesh& mesh = scene.meshes[cut[i].mesh];
    glm::dvec3 normal(0.0);
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.indices[cut[i].first_index + k];
      normal += cut[i].weights[k] * glm::dvec3(out[first_normal + usage.first_vertex[cut[i].mesh] + v]);
    }
    const std::vector<glm::vec4>& tangents = closed && mesh.moves() ? mesh.end_tangents : mesh.tangents;
    out[first + i] = {normal, cut_tangent(mesh, tangents, cut[i], linear[cut[i].mesh])};
  });
}

// The same as pack_layer_tangents(), for vertices of pieces.
void pack_cut_layer_tangents(const Scene& scene, std::span<const CutVertex> cut, const std::vector<glm::dmat3>& linear,
                             bool closed, glm::vec4* out) {
  for (std::size_t i = 0; i < cut.size(); ++i) {
    const Mesh& mesh = scene.meshes[cut[i].mesh];
    const bool moved = closed && mesh.moves();
    const std::uint32_t v = mesh.indices[cut[i].first_index];
    for (int layer = 0; layer < 2; ++layer) {
      const std::vector<glm::vec4>& own = (moved ? mesh.end_layer_tangents : mesh.layer_tangents)[layer];
      const bool has_own = !own.empty() && own[v].w != 0.0f;
      out[i][layer + (closed ? 2 : 0)] = cut_tangent(mesh,
                                                     has_own ? own
                                                     : moved ? mesh.end_tangents
                                                             : mesh.tangents,
                                                     cut[i], linear[cut[i].mesh]);
    }
  }
}

glm::dvec4 blend(const Scene& scene, const Usage& usage, const CutVertex& vertex,
                 const std::vector<glm::vec4>& stream) {
  glm::dvec4 sum(0.0);
  for (std::uint32_t k = 0; k < 3; ++k)
    sum +=
        vertex.weights[k] *
        glm::dvec4(stream[usage.first_vertex[vertex.mesh] + scene.meshes[vertex.mesh].indices[vertex.first_index + k]]);
  return sum;
}

// True if every texture that the material reads with this set repeats, so that whole pairs of tiles can be subtracted
// from its coordinates.
bool repeats(const Material& material, std::uint32_t uv_set) {
  bool all = true;
  visit_textures(material, [&](const MaterialTexture&, const TextureSlot& slot) {
    if (slot.uv_set != uv_set) return;
    all = all && slot.wrap_u != Wrap::clamp && slot.wrap_v != Wrap::clamp && slot.uv_matrix == glm::mat2(1.0f);
  });
  return all;
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

void list_cut_vertices(const Scene& scene, std::span<const Part> parts, const Cut& cut, std::vector<CutVertex>& list) {
  // Far from zero, coordinates are no finer than a part of a tile.
  constexpr double kFarTiles = 16.0;
  for (const CutTriangle& whole : cut.triangles) {
    const Mesh& mesh = scene.meshes[parts[whole.part].mesh];
    const Material& material = scene.materials[mesh.primitives[parts[whole.part].primitive].material];
    const bool moved[2] = {!mesh.uvs[0].empty() && repeats(material, 0), !mesh.uvs[1].empty() && repeats(material, 1)};
    for (std::uint32_t p = 0; p < whole.piece_count; ++p) {
      const Piece& piece = cut.pieces[whole.first_piece + p];
      CutVertex vertex{parts[whole.part].mesh, whole.first_index};
      const glm::dvec3 middle = (piece.weights[0] + piece.weights[1] + piece.weights[2]) / 3.0;
      for (std::uint32_t set = 0; set < 2; ++set) {
        if (!moved[set]) continue;
        glm::dvec2 uv(0.0);
        for (std::uint32_t k = 0; k < 3; ++k)
          uv += middle[k] * glm::dvec2(mesh.uvs[set][mesh.indices[whole.first_index + k]]);
        for (int axis = 0; axis < 2; ++axis)
          if (std::abs(uv[axis]) > kFarTiles && std::abs(uv[axis]) < 0x1p23)
            vertex.uv_shift[set][axis] = static_cast<float>(2.0 * std::floor(0.5 * uv[axis]));
      }
      for (const glm::dvec3& weights : piece.weights) {
        vertex.weights = weights;
        list.push_back(vertex);
      }
    }
  }
}

void pack_moved_vertices(const Scene& scene, const Usage& usage, const Streams& streams, std::uint32_t index,
                         const glm::dmat4& world_from_object, PackedScene& packed) {
  if (!streams.normals) return;
  const Mesh& mesh = scene.meshes[index];
  const std::uint32_t first = usage.first_vertex[index];
  const std::size_t count = mesh.positions.size();
  const glm::dmat3 linear(world_from_object);
  pack_normals(mesh.normals, mesh.tangents, count, linear, first, packed.vertex_normals);
  if (streams.layer_tangents)
    pack_layer_tangents(mesh.layer_tangents, mesh.tangents, count, linear, 0,
                        packed.vertex_normals.data() + first + packed.layer_tangents);
}

std::size_t pack_vertices(const Scene& scene, const Usage& usage, const Streams& streams,
                          std::span<const CutVertex> cut, PackedScene& packed) {
  const std::size_t vertex_count = usage.vertex_count + cut.size();
  if (vertex_count > kNoIndex)
    throw Error(scene.path, "has more than 4294967295 vertices", "simplify or split the scene");
  std::vector<glm::dmat3> linear(scene.meshes.size(), glm::dmat3(1.0));
  for (const Instance& instance : scene.instances)
    if (usage.mesh_instances[instance.mesh] == 1) linear[instance.mesh] = glm::dmat3(instance.world_from_object);

  if (packed.moves()) packed.end_normals = static_cast<std::uint32_t>(vertex_count);
  if (streams.layer_tangents) packed.layer_tangents = static_cast<std::uint32_t>(vertex_count) + packed.end_normals;
  const std::size_t normal_count = vertex_count + packed.end_normals;
  if (streams.normals)
    packed.vertex_normals.assign(normal_count + (streams.layer_tangents ? vertex_count : 0), glm::vec4(0.0f));
  if (streams.uvs) packed.vertex_uvs.assign(vertex_count, glm::vec4(0.0f));
  if (streams.colors) packed.vertex_colors.assign(vertex_count, glm::vec4(1.0f));
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
  if (!cut.empty() && streams.normals) {
    pack_cut_normals(scene, usage, cut, linear, false, usage.vertex_count, 0, packed.vertex_normals);
    if (packed.moves())
      pack_cut_normals(scene, usage, cut, linear, true, packed.end_normals + usage.vertex_count, packed.end_normals,
                       packed.vertex_normals);
  }
  if (!cut.empty() && streams.layer_tangents) {
    glm::vec4* out = packed.vertex_normals.data() + packed.layer_tangents + usage.vertex_count;
    pack_cut_layer_tangents(scene, cut, linear, false, out);
    if (packed.moves()) pack_cut_layer_tangents(scene, cut, linear, true, out);
  }
  for (std::size_t i = 0; i < cut.size(); ++i) {
    const glm::dvec4 shift(glm::dvec2(cut[i].uv_shift[0]), glm::dvec2(cut[i].uv_shift[1]));
    if (streams.uvs)
      packed.vertex_uvs[usage.vertex_count + i] = glm::vec4(blend(scene, usage, cut[i], packed.vertex_uvs) - shift);
    if (streams.colors)
      packed.vertex_colors[usage.vertex_count + i] = glm::vec4(blend(scene, usage, cut[i], packed.vertex_colors));
  }
  return repaired;
}

} // namespace wavepath
