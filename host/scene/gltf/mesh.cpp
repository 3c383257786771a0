// Builds meshes: each primitive becomes a small mesh of the vertices that it uses, and these are joined.
#include "host/scene/gltf/mesh.h"

#include <algorithm>
#include <cmath>

#include "host/base/error.h"
#include "host/base/memory.h"
#include "host/scene/gltf/accessor.h"
#include "host/scene/gltf/draco.h"
#include "host/scene/gltf/normals.h"
#include "host/scene/gltf/skin.h"
#include "host/scene/gltf/tangents.h"

namespace wavepath::gltf {
namespace {

constexpr const char* kColors = "COLOR_0";

struct Target {
  double weight;
  Elements position, normal, tangent, uvs[2], color; // displacements
};

// The open accessors of a primitive, all with the same count.
struct Attributes {
  Elements position, normal, tangent, uvs[2], color;
  std::vector<Target> targets; // of weight other than 0
  Skin skin;
};

Elements open_attribute(Document& document, const std::map<std::string, int>& attributes, const std::string& name,
                        int components, std::size_t count, const Decoded& decoded) {
  const auto found = attributes.find(name);
  if (found == attributes.end()) return {};
  const Elements elements = open_accessor(document, found->second, name, decoded);
  const bool color = name == kColors && elements.components == 3; // RGB or RGBA
  if (elements.components != components && !color) {
    document.fail(name + " (accessor " + std::to_string(found->second) + ") does not have " +
                  std::to_string(components) + " components");
  }
  if (elements.count != count) {
    document.fail(name + " (accessor " + std::to_string(found->second) + ") has " + std::to_string(elements.count) +
                  " elements, but POSITION has " + std::to_string(count));
  }
  return elements;
}

bool uses_uv_set(const Material& material, std::uint32_t set) {
  bool used = needs_tangents(material) && tangent_slot(material).uv_set == set;
  visit_textures(material, [&](const MaterialTexture&, const TextureSlot& slot) { used |= slot.uv_set == set; });
  return used;
}

Attributes open_attributes(Document& document, Scene& scene, const tinygltf::Primitive& primitive, const MeshUse& use,
                           const Material& material, const UvSets& uv_sets, const Decoded& decoded) {
  Attributes result;
  const int position = primitive.attributes.at("POSITION");
  const auto compressed = decoded.find(position);
  const std::size_t count = compressed != decoded.end()
                                ? compressed->second.count
                                : document.model.accessors[static_cast<std::size_t>(position)].count;
  const auto open = [&](const std::string& name, int components) {
    return open_attribute(document, primitive.attributes, name, components, count, decoded);
  };
  result.position = open("POSITION", 3);
  std::string uv_names[2];
  for (std::uint32_t set = 0; set < 2; ++set)
    if (uses_uv_set(material, set)) uv_names[set] = "TEXCOORD_" + std::to_string(uv_sets[set]);
  result.normal = open("NORMAL", 3);
  // Tangents without normals must be ignored; they would not be orthogonal to the flat ones.
  if (needs_tangents(material) && result.normal.present()) result.tangent = open("TANGENT", 4);
  for (int set = 0; set < 2; ++set) {
    if (uv_names[set].empty()) continue;
    result.uvs[set] = open(uv_names[set], 2);
    if (!result.uvs[set].present()) scene.warnings.add(kNoUvSet);
  }
  result.color = open(kColors, 4);
  for (std::size_t i = 0; i < primitive.targets.size() && i < use.weights.size(); ++i) {
    if (use.weights[i] == 0.0) continue;
    const auto displacement = [&](const std::string& name, int components) {
      return open_attribute(document, primitive.targets[i], name, components, count, {});
    };
    result.targets.push_back({use.weights[i],
                              displacement("POSITION", 3),
                              displacement("NORMAL", 3),
                              displacement("TANGENT", 3),
                              {displacement(uv_names[0], 2), displacement(uv_names[1], 2)},
                              displacement(kColors, 4)});
  }
  return result;
}

void require_vertex(const Document& document, std::uint32_t index, std::size_t vertex_count) {
  if (index >= vertex_count)
    document.fail("index " + std::to_string(index) + " is out of range: there are " + std::to_string(vertex_count) +
                  " vertices");
}

// Corners of the triangles that a primitive draws, from vertices in the order of its mode.
std::vector<std::uint32_t> triangulate(const Document& document, int mode, const Elements& indices,
                                       std::size_t vertex_count) {
  const std::size_t count = indices.present() ? indices.count : vertex_count;
  const bool list = mode == TINYGLTF_MODE_TRIANGLES;
  if (list && count % 3) document.fail("a list of triangles has " + std::to_string(count) + " corners");
  const std::size_t triangle_count = list ? count / 3 : count < 3 ? 0 : count - 2;
  require_memory(document.file, "a primitive", std::uint64_t{triangle_count} * 48, "use a machine with more memory");
  const auto corner = [&](std::size_t i) {
    const std::uint32_t index = indices.present() ? index_at(indices, i) : static_cast<std::uint32_t>(i);
    require_vertex(document, index, vertex_count);
    return index;
  };
  std::vector<std::uint32_t> corners;
  corners.reserve(triangle_count * 3);
  for (std::size_t i = 0; i < triangle_count; ++i) {
    const std::size_t odd = i & 1;
    if (list) {
      corners.insert(corners.end(), {corner(3 * i), corner(3 * i + 1), corner(3 * i + 2)});
    } else if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
      corners.insert(corners.end(), {corner(i), corner(i + 1 + odd), corner(i + 2 - odd)});
    } else {
      corners.insert(corners.end(), {corner(i + 1), corner(i + 2), corner(0)});
    }
  }
  return corners;
}

// Renumbers corners so that only used vertices remain; returns these in the order of the file.
std::vector<std::uint32_t> keep_used(std::vector<std::uint32_t>& corners, std::size_t vertex_count) {
  std::vector<std::uint32_t> number(vertex_count, kNoIndex);
  for (const std::uint32_t corner : corners) number[corner] = 0;
  std::vector<std::uint32_t> used;
  for (std::size_t i = 0; i < vertex_count; ++i) {
    if (number[i] == kNoIndex) continue;
    number[i] = static_cast<std::uint32_t>(used.size());
    used.push_back(static_cast<std::uint32_t>(i));
  }
  for (std::uint32_t& corner : corners) corner = number[corner];
  return used;
}

template <int N>
void gather(const Elements& elements, const std::vector<std::uint32_t>& used, std::vector<glm::vec<N, float>>& out,
            float fill = 0.0f) {
  if (!elements.present()) return;
  out.resize(used.size());
  for (std::size_t i = 0; i < used.size(); ++i) out[i] = vector_at<N>(elements, used[i], fill);
}

// Numbers that are not finite become `value`. Returns how many vectors held one.
template <int N>
std::size_t mend(std::vector<glm::vec<N, float>>& vectors, float value) {
  std::size_t count = 0;
  for (auto& vector : vectors) {
    bool bad = false;
    for (int c = 0; c < N; ++c) {
      if (std::isfinite(vector[c])) continue;
      vector[c] = value;
      bad = true;
    }
    count += bad;
  }
  return count;
}

// Returns how many displacements were left out because they are not finite.
template <int N>
std::size_t displace(const Elements& elements, double weight, const std::vector<std::uint32_t>& used,
                     std::vector<glm::vec<N, float>>& out) {
  if (!elements.present() || out.empty()) return 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < used.size(); ++i) {
    const glm::vec<N, float> by = static_cast<float>(weight) * vector_at<N>(elements, used[i]);
    bool finite = true;
    for (int c = 0; c < N; ++c) finite = finite && std::isfinite(by[c]);
    if (finite)
      out[i] += by;
    else
      ++count;
  }
  return count;
}

// Invalid positions, normals and tangents are repaired later: by the packer, and by repair_normals().
void gather_vertices(const Attributes& attributes, const std::vector<std::uint32_t>& used, Warnings& warnings,
                     Mesh& part) {
  const auto tell = [&](const char* what, std::size_t count) {
    if (count) warnings.add(what, count);
  };
  gather(attributes.position, used, part.positions);
  gather(attributes.normal, used, part.normals);
  gather(attributes.tangent, used, part.tangents);
  for (int set = 0; set < 2; ++set) {
    gather(attributes.uvs[set], used, part.uvs[set]);
    tell("texture coordinates that are not finite were set to zero", mend(part.uvs[set], 0.0f));
  }
  gather(attributes.color, used, part.colors, 1.0f);
  tell("vertex colours that are not finite were set to one", mend(part.colors, 1.0f));
  for (const Target& target : attributes.targets) {
    std::size_t left_out = displace(target.position, target.weight, used, part.positions);
    left_out += displace(target.normal, target.weight, used, part.normals);
    left_out += displace(target.tangent, target.weight, used, part.tangents);
    for (int set = 0; set < 2; ++set) left_out += displace(target.uvs[set], target.weight, used, part.uvs[set]);
    left_out += displace(target.color, target.weight, used, part.colors);
    tell("displacements of morph targets that are not finite were left out", left_out);
  }
  for (glm::vec4& color : part.colors) color = glm::clamp(color, 0.0f, 1.0f); // as the specification asks
}

void apply_skin(const Document& document, const Skin& skin, const std::vector<std::uint32_t>& used, Warnings& warnings,
                Mesh& part) {
  std::size_t not_finite = 0;
  for (std::size_t i = 0; i < used.size(); ++i) {
    const glm::dmat4 matrix = blend(document, skin, used[i], not_finite);
    part.positions[i] = glm::vec3(matrix * glm::dvec4(part.positions[i], 1.0));
    const glm::dmat3 linear(matrix);
    if (!part.normals.empty()) {
      // The cofactor matrix is the inverse transpose up to a factor, and exists for singular matrices too.
      const glm::dmat3 cofactor(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                                glm::cross(linear[0], linear[1]));
      const double sign = glm::determinant(linear) < 0.0 ? -1.0 : 1.0;
      const glm::dvec3 normal = sign * (cofactor * glm::dvec3(part.normals[i]));
      part.normals[i] = glm::vec3(normal / std::max(glm::length(normal), 1e-300));
    }
    if (!part.tangents.empty()) {
      const glm::dvec3 tangent = linear * glm::dvec3(part.tangents[i]);
      part.tangents[i] = glm::vec4(glm::vec3(tangent / std::max(glm::length(tangent), 1e-300)), part.tangents[i].w);
    }
  }
  if (not_finite) warnings.add("weights of joints that are not finite were set to zero", not_finite);
}

// The triangles of one primitive as a mesh of their own; empty for points and lines.
Mesh read_primitive(Document& document, Scene& scene, MaterialMap& map, const tinygltf::Primitive& primitive,
                    const MeshUse& use, const std::vector<glm::dmat4>& world) {
  Mesh part;
  if (primitive.mode < TINYGLTF_MODE_POINTS || primitive.mode > TINYGLTF_MODE_TRIANGLE_FAN) {
    document.fail("a primitive has unknown mode " + std::to_string(primitive.mode));
  }
  if (primitive.mode < TINYGLTF_MODE_TRIANGLES) {
    scene.warnings.add("primitive of points or lines left out");
    return part;
  }
  const auto position = primitive.attributes.find("POSITION");
  if (position == primitive.attributes.end()) {
    scene.warnings.add("primitive without positions left out");
    return part;
  }
  std::optional<DracoMesh> compressed = decode_draco(document, scene.warnings, primitive);
  const Decoded decoded = compressed ? std::move(compressed->attributes) : Decoded{};
  const auto indices = primitive.attributes.find(kIndices);
  Elements opened_indices;
  if (indices != primitive.attributes.end() && !compressed) opened_indices = open_indices(document, indices->second);
  const std::uint32_t material_index = use_material(document, scene, map, primitive, decoded);
  const Material& material = scene.materials[material_index];
  Attributes attributes =
      open_attributes(document, scene, primitive, use, material, map.uv_sets[material_index], decoded);
  const std::size_t vertex_count = attributes.position.count;
  attributes.skin = open_skin(document, scene.warnings, primitive, use.skin, world, vertex_count, decoded);

  part.indices =
      compressed ? std::move(compressed->corners) : triangulate(document, primitive.mode, opened_indices, vertex_count);
  if (part.indices.empty()) return part;
  if (compressed)
    for (const std::uint32_t index : part.indices) require_vertex(document, index, vertex_count);
  const auto used = keep_used(part.indices, vertex_count);
  gather_vertices(attributes, used, scene.warnings, part);
  if (attributes.skin.present()) apply_skin(document, attributes.skin, used, scene.warnings, part);
  const bool has_normals = !part.normals.empty();
  if (has_normals) {
    if (const auto count = repair_normals(part))
      scene.warnings.add("vertex normal without a direction replaced by that of its faces", count);
  }
  if (needs_tangents(material)) {
    const std::size_t count = part.tangents.empty() ? 0 : repair_tangents(part);
    if (count) scene.warnings.add("vertex tangent without a direction replaced by an arbitrary one", count);
    if (part.tangents.empty()) add_tangents(part, material);
  }
  part.primitives = {{0, static_cast<std::uint32_t>(part.indices.size()), material_index, has_normals}};
  return part;
}

// Appends one vertex array to another; where either lacks what the other has, `missing` stands.
template <typename T>
void append(std::vector<T>& to, const std::vector<T>& from, std::size_t to_count, std::size_t from_count,
            const T& missing) {
  if (to.empty() && from.empty()) return;
  to.resize(to_count, missing);
  to.insert(to.end(), from.begin(), from.end());
  to.resize(to_count + from_count, missing);
}

void append(const Document& document, Mesh& mesh, const Mesh& part) {
  const std::size_t first_vertex = mesh.positions.size(), count = part.positions.size();
  const std::size_t first_index = mesh.indices.size();
  if (first_vertex + count >= kNoIndex || first_index + part.indices.size() >= kNoIndex) {
    document.fail("a mesh has more than 4294967294 vertices or corners", "split it into several meshes");
  }
  append(mesh.positions, part.positions, first_vertex, count, glm::vec3(0.0f));
  append(mesh.normals, part.normals, first_vertex, count, glm::vec3(0.0f));
  append(mesh.tangents, part.tangents, first_vertex, count, glm::vec4(0.0f));
  for (std::size_t layer = 0; layer < 2; ++layer)
    append(mesh.layer_tangents[layer], part.layer_tangents[layer], first_vertex, count, glm::vec4(0.0f));
  for (int set = 0; set < 2; ++set) append(mesh.uvs[set], part.uvs[set], first_vertex, count, glm::vec2(0.0f));
  append(mesh.colors, part.colors, first_vertex, count, glm::vec4(1.0f));
  mesh.indices.reserve(first_index + part.indices.size());
  for (const std::uint32_t index : part.indices)
    mesh.indices.push_back(static_cast<std::uint32_t>(first_vertex) + index);
  for (Primitive primitive : part.primitives) {
    primitive.first_index += static_cast<std::uint32_t>(first_index);
    mesh.primitives.push_back(primitive);
  }
}

} // namespace

bool has_triangles(const tinygltf::Primitive& primitive) {
  return primitive.mode >= TINYGLTF_MODE_TRIANGLES && primitive.mode <= TINYGLTF_MODE_TRIANGLE_FAN &&
         primitive.attributes.contains("POSITION");
}

Mesh read_mesh(Document& document, Scene& scene, MaterialMap& map, const MeshUse& use,
               const std::vector<glm::dmat4>& world) {
  const tinygltf::Mesh& source = document.model.meshes[static_cast<std::size_t>(use.mesh)];
  Mesh mesh;
  for (const tinygltf::Primitive& primitive : source.primitives) {
    Mesh part = read_primitive(document, scene, map, primitive, use, world);
    if (mesh.positions.empty()) {
      mesh = std::move(part); // most meshes have one primitive: no copy
    } else if (!part.indices.empty()) {
      append(document, mesh, part);
    }
  }
  mesh.name = source.name;
  return mesh;
}

} // namespace wavepath::gltf
