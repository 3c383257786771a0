// MikkTSpace in short: the tangents of the faces around a vertex, each projected into the vertex plane and made unit
// length, are averaged by the angle of the face there, over all triangles that share position, normal, uv and
// handedness.
#include "host/scene/gltf/tangents.h"

#include <array>
#include <cmath>
#include <cstring>
#include <unordered_map>

#include "host/base/hash.h"
#include "host/scene/gltf/normals.h"

namespace wavepath {
namespace {

using Key = std::array<std::uint32_t, 9>; // bits of position, normal, uv; handedness

struct KeyHash {
  std::size_t operator()(const Key& key) const {
    Hash hash;
    hash.add(key);
    return hash.value();
  }
};

Key make_key(const glm::vec3& position, const glm::vec3& normal, const glm::vec2& uv, bool positive) {
  // Adding zero makes -0 and +0 the same bits.
  const float values[8] = {position.x + 0.0f, position.y + 0.0f, position.z + 0.0f, normal.x + 0.0f,
                           normal.y + 0.0f,   normal.z + 0.0f,   uv.x + 0.0f,       uv.y + 0.0f};
  Key key;
  std::memcpy(key.data(), values, sizeof(values));
  key[8] = positive;
  return key;
}

glm::dvec3 unit(const glm::dvec3& vector) {
  const double length = glm::length(vector);
  return length > 0.0 && std::isfinite(length) ? vector / length : glm::dvec3(0.0);
}

struct Face {
  glm::dvec3 normal{0.0}, tangent{0.0}; // unit; no tangent = degenerate
  bool positive = true;                 // handedness w = +1
};

Face make_face(const Mesh& mesh, const std::vector<glm::vec2>& uvs, const std::uint32_t* corner) {
  const glm::dvec3 p(mesh.positions[corner[0]]);
  const glm::dvec3 e1 = glm::dvec3(mesh.positions[corner[1]]) - p, e2 = glm::dvec3(mesh.positions[corner[2]]) - p;
  Face face;
  face.normal = unit(glm::cross(e1, e2));
  if (uvs.empty() || face.normal == glm::dvec3(0.0)) return face;
  // MikkTSpace takes v upwards, glTF has it downwards.
  const glm::dvec2 t(uvs[corner[0]]);
  const glm::dvec2 d1 = (glm::dvec2(uvs[corner[1]]) - t) * glm::dvec2(1.0, -1.0);
  const glm::dvec2 d2 = (glm::dvec2(uvs[corner[2]]) - t) * glm::dvec2(1.0, -1.0);
  const double area = d1.x * d2.y - d1.y * d2.x;
  if (area == 0.0 || !std::isfinite(area)) return face;
  face.positive = area > 0.0;
  face.tangent = unit((e1 * d2.y - e2 * d1.y) * (face.positive ? 1.0 : -1.0));
  return face;
}

glm::vec3 corner_normal(const Mesh& mesh, const Face& face, std::uint32_t vertex) {
  return mesh.normals.empty() ? glm::vec3(face.normal) : mesh.normals[vertex];
}

// The angle of the triangle at corner k, measured between its edges in the vertex plane.
double corner_angle(const Mesh& mesh, const std::uint32_t* corner, int k, const glm::dvec3& normal) {
  const glm::dvec3 p(mesh.positions[corner[k]]);
  const auto edge = [&](int to) {
    const glm::dvec3 e = glm::dvec3(mesh.positions[corner[to % 3]]) - p;
    return unit(e - normal * glm::dot(normal, e));
  };
  const glm::dvec3 a = edge(k + 1), b = edge(k + 2);
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

using Sums = std::unordered_map<Key, glm::dvec3, KeyHash>;

Sums sum_tangents(const Mesh& mesh, const std::vector<glm::vec2>& uvs) {
  Sums sums;
  sums.reserve(mesh.positions.size());
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const std::uint32_t* corner = &mesh.indices[i];
    const Face face = make_face(mesh, uvs, corner);
    if (face.tangent == glm::dvec3(0.0)) continue;
    for (int k = 0; k < 3; ++k) {
      const glm::vec3 normal = corner_normal(mesh, face, corner[k]);
      const glm::dvec3 n(normal);
      const glm::dvec3 projected = unit(face.tangent - n * glm::dot(n, face.tangent));
      sums[make_key(mesh.positions[corner[k]], normal, uvs[corner[k]], face.positive)] +=
          corner_angle(mesh, corner, k, n) * projected;
    }
  }
  return sums;
}

glm::vec4 corner_tangent(const Mesh& mesh, const std::vector<glm::vec2>& uvs, const Sums& sums, const Face& face,
                         std::uint32_t vertex) {
  const glm::vec3 normal = corner_normal(mesh, face, vertex);
  // A degenerate triangle takes the tangent of a neighbour, of either handedness.
  for (const bool positive : {face.positive, !face.positive}) {
    if (uvs.empty() || (face.tangent != glm::dvec3(0.0) && positive != face.positive)) continue;
    const auto found = sums.find(make_key(mesh.positions[vertex], normal, uvs[vertex], positive));
    if (found == sums.end()) continue;
    const glm::dvec3 tangent = unit(found->second);
    if (tangent != glm::dvec3(0.0)) return glm::vec4(glm::vec3(tangent), positive ? 1.0f : -1.0f);
  }
  return glm::vec4(any_tangent(normal), 1.0f);
}

template <typename T>
void repeat(std::vector<T>& values, std::uint32_t vertex) {
  if (!values.empty()) values.push_back(T(values[vertex]));
}

std::uint32_t split_vertex(Mesh& mesh, std::uint32_t vertex) {
  repeat(mesh.positions, vertex);
  repeat(mesh.normals, vertex);
  repeat(mesh.tangents, vertex);
  for (std::vector<glm::vec4>& layer : mesh.layer_tangents) repeat(layer, vertex);
  repeat(mesh.uvs[0], vertex);
  repeat(mesh.uvs[1], vertex);
  repeat(mesh.colors, vertex);
  return static_cast<std::uint32_t>(mesh.positions.size() - 1);
}

// Rotation of coordinates by a texture transform. A scale of 0, which smears the texture along an axis, counts like any
// other; without any scale the rotation is unknown.
glm::dmat2 turn_of(const TextureSlot& slot) {
  glm::dmat2 m(slot.uv_matrix);
  const bool first = m[0] != glm::dvec2(0.0), second = m[1] != glm::dvec2(0.0);
  if (!first && !second) return glm::dmat2(1.0);
  if (!first) m[0] = {m[1].y, -m[1].x};
  if (!second) m[1] = {-m[0].y, m[0].x};
  return m;
}

// The coordinates that a slot is read with, but for its offset, which turns nothing.
std::vector<glm::vec2> turned_uvs(const Mesh& mesh, const TextureSlot& slot) {
  std::vector<glm::vec2> uvs = mesh.uvs[slot.uv_set];
  if (slot.uv_matrix == glm::mat2(1.0f)) return uvs;
  const glm::dmat2 turn = turn_of(slot);
  for (glm::vec2& uv : uvs) uv = glm::vec2(turn * glm::dvec2(uv));
  return uvs;
}

} // namespace

void add_tangents(Mesh& mesh, const Material& material) {
  generate_tangents(mesh, turned_uvs(mesh, tangent_slot(material)), mesh.tangents);
  for (std::size_t layer = 0; layer < 2; ++layer)
    if (has_layer_tangents(material, layer))
      generate_tangents(mesh, turned_uvs(mesh, layer_tangent_slot(material, layer)), mesh.layer_tangents[layer]);
}

void generate_tangents(Mesh& mesh, const std::vector<glm::vec2>& uvs, std::vector<glm::vec4>& into) {
  const Sums sums = sum_tangents(mesh, uvs);
  std::vector<glm::vec4> corners(mesh.indices.size());
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const Face face = make_face(mesh, uvs, &mesh.indices[i]);
    for (std::size_t k = 0; k < 3; ++k) corners[i + k] = corner_tangent(mesh, uvs, sums, face, mesh.indices[i + k]);
  }
  // From here on `uvs` may grow with the mesh. A tangent of w = 0 marks a vertex that no corner has claimed yet.
  std::vector<glm::vec4> tangents(mesh.positions.size(), glm::vec4(0.0f));
  std::vector<std::uint32_t> next(mesh.positions.size(), kNoIndex); // the chain of splits of a vertex
  for (std::size_t i = 0; i < corners.size(); ++i) {
    std::uint32_t vertex = mesh.indices[i];
    while (tangents[vertex].w != 0.0f && tangents[vertex] != corners[i]) {
      if (next[vertex] == kNoIndex) {
        const std::uint32_t copy = split_vertex(mesh, vertex);
        next[vertex] = copy;
        next.push_back(kNoIndex);
        tangents.push_back(glm::vec4(0.0f));
      }
      vertex = next[vertex];
    }
    tangents[vertex] = corners[i];
    mesh.indices[i] = vertex;
  }
  into = std::move(tangents);
}

} // namespace wavepath
