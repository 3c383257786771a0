#include "host/convert/write_gltf.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include <nlohmann/json.hpp>

#include "host/base/error.h"
#include "host/convert/textures.h"

namespace wavepath::convert {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kMostBinary =
    (std::uint64_t{1} << 32) - (std::uint64_t{1} << 28); // room for the JSON in a .glb
constexpr int kFloat = 5126, kUnsigned = 5125, kVertices = 34962, kIndexBuffer = 34963;

struct Writer {
  Description& scene;
  const std::string& file;
  Json root = Json::object();
  std::vector<std::uint8_t> binary{};
  std::map<std::uint32_t, Json> primitives{}; // attributes and indices of meshes
  std::map<std::uint32_t, std::size_t> materials{}, images{};
  std::set<std::string> extensions{};
};

Json array_of(const glm::dvec3& v) { return Json::array({v.x, v.y, v.z}); }

Json array_of(const glm::dmat4& matrix) {
  Json array = Json::array();
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r) array.push_back(matrix[c][r]);
  return array;
}

std::size_t add(Writer& writer, const char* list, Json entry) {
  Json& entries = writer.root[list];
  entries.push_back(std::move(entry));
  return entries.size() - 1;
}

std::size_t add_view(Writer& writer, std::span<const std::uint8_t> bytes, int target) {
  writer.binary.resize((writer.binary.size() + 3) / 4 * 4);
  if (writer.binary.size() + bytes.size() > kMostBinary)
    throw Error(writer.file, "would become larger than glTF allows, 4 GiB", "convert a part of the scene");
  Json view = {{"buffer", 0}, {"byteOffset", writer.binary.size()}, {"byteLength", bytes.size()}};
  if (target) view["target"] = target;
  writer.binary.insert(writer.binary.end(), bytes.begin(), bytes.end());
  return add(writer, "bufferViews", std::move(view));
}

template <class T>
std::span<const std::uint8_t> bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const std::uint8_t*>(values.data()), values.size() * sizeof(T)};
}

template <class Vector>
std::size_t add_vectors(Writer& writer, const std::vector<Vector>& vectors, const char* type) {
  return add(writer, "accessors",
             {{"bufferView", add_view(writer, bytes_of(vectors), kVertices)},
              {"componentType", kFloat},
              {"count", vectors.size()},
              {"type", type}});
}

// Attributes and indices of a primitive.
Json add_mesh(Writer& writer, const Mesh& mesh) {
  Json attributes;
  glm::vec3 lo(std::numeric_limits<float>::max()), hi(-std::numeric_limits<float>::max());
  std::vector<glm::vec3> positions = mesh.positions;
  for (glm::vec3& p : positions) {
    for (int i = 0; i < 3; ++i)
      if (!std::isfinite(p[i])) p[i] = 0.0f; // no triangle uses it
    lo = glm::min(lo, p), hi = glm::max(hi, p);
  }
  attributes["POSITION"] = add_vectors(writer, positions, "VEC3");
  writer.root["accessors"].back()["min"] = array_of(glm::dvec3(lo));
  writer.root["accessors"].back()["max"] = array_of(glm::dvec3(hi));
  if (!mesh.normals.empty()) {
    std::vector<glm::vec3> normals = mesh.normals;
    for (glm::vec3& n : normals) {
      const float length = glm::length(n);
      n = length > 0.0f && std::isfinite(length) ? n / length : glm::vec3(0.0f, 0.0f, 1.0f);
    }
    attributes["NORMAL"] = add_vectors(writer, normals, "VEC3");
  }
  if (!mesh.uvs.empty()) attributes["TEXCOORD_0"] = add_vectors(writer, mesh.uvs, "VEC2");
  const std::size_t indices = add(writer, "accessors",
                                  {{"bufferView", add_view(writer, bytes_of(mesh.indices), kIndexBuffer)},
                                   {"componentType", kUnsigned},
                                   {"count", mesh.indices.size()},
                                   {"type", "SCALAR"}});
  return {{"attributes", std::move(attributes)}, {"indices", indices}};
}

std::size_t add_image(Writer& writer, std::uint32_t image) {
  const auto found = writer.images.find(image);
  if (found != writer.images.end()) return found->second;
  const Image& source = writer.scene.images.all()[image];
  const std::size_t index =
      add(writer, "images",
          {{"name", source.name}, {"mimeType", source.mime}, {"bufferView", add_view(writer, source.bytes, 0)}});
  return writer.images[image] = index;
}

// A reference to a texture.
Json texture_info(Writer& writer, const Texture& texture) {
  constexpr int kRepeat = 10497, kClamp = 33071, kNearest = 9728, kLinear = 9729;
  const int wrap = texture.clamps ? kClamp : kRepeat, filter = texture.nearest ? kNearest : kLinear;
  const Json sampler = {{"magFilter", filter}, {"minFilter", filter}, {"wrapS", wrap}, {"wrapT", wrap}};
  Json& samplers = writer.root["samplers"];
  auto at = static_cast<std::size_t>(std::find(samplers.begin(), samplers.end(), sampler) - samplers.begin());
  if (at == samplers.size()) at = add(writer, "samplers", sampler);
  const Json entry = {{"sampler", at}, {"source", add_image(writer, texture.image)}};
  Json& textures = writer.root["textures"];
  auto index = static_cast<std::size_t>(std::find(textures.begin(), textures.end(), entry) - textures.begin());
  if (index == textures.size()) index = add(writer, "textures", entry);
  Json info = {{"index", index}};
  if (texture.uv_scale != glm::dvec2(1.0) || texture.uv_offset != glm::dvec2(0.0)) {
    writer.extensions.insert("KHR_texture_transform");
    info["extensions"]["KHR_texture_transform"] = {{"offset", {texture.uv_offset.x, texture.uv_offset.y}},
                                                   {"scale", {texture.uv_scale.x, texture.uv_scale.y}}};
  }
  return info;
}

double scale_of(const Writer& writer, const Texture& texture) {
  return texture.is_constant() ? 1.0 : writer.scene.images.all()[texture.image].scale;
}

void write_base(Writer& writer, const Material& material, Json& pbr, Json& out) {
  Texture base = bounded(writer.scene, material.base, Holds::colors);
  double alpha = 1.0;
  if (material.alpha.is_constant()) {
    alpha = std::clamp(material.alpha.factor.x, 0.0, 1.0);
  } else {
    base = with_alpha(writer.scene, base, material.alpha);
  }
  if (alpha < 1.0 || !material.alpha.is_constant()) out["alphaMode"] = "BLEND";
  const glm::dvec3 factor = glm::clamp(base.factor * scale_of(writer, base), 0.0, 1.0);
  pbr["baseColorFactor"] = {factor.x, factor.y, factor.z, alpha};
  if (!base.is_constant()) pbr["baseColorTexture"] = texture_info(writer, base);
}

void write_microfacets(Writer& writer, const Material& material, Json& pbr) {
  if (material.roughness.is_constant() && material.metallic.is_constant()) {
    pbr["metallicFactor"] = std::clamp(material.metallic.factor.x, 0.0, 1.0);
    pbr["roughnessFactor"] = std::clamp(material.roughness.factor.x, 0.0, 1.0);
    return;
  }
  const Texture both = packed(writer.scene, material.roughness, material.metallic);
  pbr["metallicFactor"] = pbr["roughnessFactor"] = 1.0;
  pbr["metallicRoughnessTexture"] = texture_info(writer, both);
}

void write_emission(Writer& writer, const Material& material, Json& out) {
  const glm::dvec3 emission = material.emission.factor * scale_of(writer, material.emission);
  const double largest = std::max({emission.x, emission.y, emission.z});
  if (!(largest > 0.0)) return;
  out["emissiveFactor"] = array_of(emission / std::max(largest, 1.0));
  if (largest > 1.0) out["extensions"]["KHR_materials_emissive_strength"] = {{"emissiveStrength", largest}};
  if (!material.emission.is_constant()) out["emissiveTexture"] = texture_info(writer, material.emission);
}

// KHR_materials_volume_scatter has the colour of a deep body; of the albedo of an event by Kulla and Conty Estevez
// 2017.
glm::dvec3 multiscatter_color(const Material& material, double g) {
  glm::dvec3 color(0.0);
  for (int c = 0; c < 3; ++c) {
    const double extinction = material.absorption[c] + material.scattering[c];
    const double albedo = extinction > 0.0 ? material.scattering[c] / extinction : 0.0;
    const double s = std::sqrt(std::max(0.0, 1.0 - albedo) / std::max(1e-9, 1.0 - albedo * g));
    color[c] = std::clamp((1.0 - s) * (1.0 - 0.139 * s) / (1.0 + 1.17 * s), 0.0, 1.0);
  }
  return color;
}

void write_volume(const Material& material, Json& extensions) {
  Json volume = {{"thicknessFactor", 1.0}};
  const glm::dvec3 extinction = material.absorption + material.scattering;
  const double strongest = std::max({extinction.x, extinction.y, extinction.z});
  if (strongest > 0.0) {
    const double distance = std::clamp(1.0 / strongest, 1e-6, 1e6);
    volume["attenuationDistance"] = distance;
    volume["attenuationColor"] = array_of(glm::exp(-extinction * distance));
  }
  extensions["KHR_materials_volume"] = std::move(volume);
  if (material.scattering == glm::dvec3(0.0)) return;
  const double g = std::clamp(material.anisotropy_of_scattering, -0.99, 0.99);
  extensions["KHR_materials_volume_scatter"] = {{"multiscatterColor", array_of(multiscatter_color(material, g))},
                                                {"scatterAnisotropy", g}};
}

void write_layers(const Material& material, Json& extensions) {
  if (material.ior != 1.5) extensions["KHR_materials_ior"] = {{"ior", material.ior}};
  if (material.specular != 1.0 || material.specular_color != glm::dvec3(1.0)) {
    extensions["KHR_materials_specular"] = {{"specularFactor", std::clamp(material.specular, 0.0, 1.0)}};
    if (material.specular_color != glm::dvec3(1.0))
      extensions["KHR_materials_specular"]["specularColorFactor"] = array_of(glm::max(material.specular_color, 0.0));
  }
  if (material.transmission > 0.0) {
    extensions["KHR_materials_transmission"] = {{"transmissionFactor", std::min(material.transmission, 1.0)}};
    if (material.volume) write_volume(material, extensions);
  }
  if (material.coat > 0.0)
    extensions["KHR_materials_clearcoat"] = {
        {"clearcoatFactor", std::min(material.coat, 1.0)},
        {"clearcoatRoughnessFactor", std::clamp(material.coat_roughness, 0.0, 1.0)}};
  if (material.sheen != glm::dvec3(0.0))
    extensions["KHR_materials_sheen"] = {{"sheenColorFactor", array_of(glm::clamp(material.sheen, 0.0, 1.0))},
                                         {"sheenRoughnessFactor", std::clamp(material.sheen_roughness, 0.0, 1.0)}};
  if (material.anisotropy > 0.0)
    extensions["KHR_materials_anisotropy"] = {{"anisotropyStrength", std::min(material.anisotropy, 1.0)},
                                              {"anisotropyRotation", material.anisotropy_rotation}};
  if (material.diffuse_transmission > 0.0)
    extensions["KHR_materials_diffuse_transmission"] = {
        {"diffuseTransmissionFactor", std::min(material.diffuse_transmission, 1.0)},
        {"diffuseTransmissionColorFactor", array_of(glm::clamp(material.diffuse_transmission_color, 0.0, 1.0))}};
}

std::size_t add_material(Writer& writer, std::uint32_t index) {
  if (const auto found = writer.materials.find(index); found != writer.materials.end()) return found->second;
  const Material material = writer.scene.materials[index];
  Json out = Json::object();
  if (!material.name.empty()) out["name"] = material.name;
  Json pbr = Json::object(), extensions = Json::object();
  write_base(writer, material, pbr, out);
  write_microfacets(writer, material, pbr);
  out["pbrMetallicRoughness"] = std::move(pbr);
  write_layers(material, extensions);
  if (!extensions.empty()) out["extensions"] = std::move(extensions);
  write_emission(writer, material, out);
  if (!material.normal.is_constant()) out["normalTexture"] = texture_info(writer, material.normal);
  if (material.double_sided) out["doubleSided"] = true;
  if (out.contains("extensions"))
    for (const auto& [name, value] : out["extensions"].items()) writer.extensions.insert(name);
  return writer.materials[index] = add(writer, "materials", std::move(out));
}

Json primitive_of(Writer& writer, const Shape& shape) {
  auto found = writer.primitives.find(shape.mesh);
  if (found == writer.primitives.end())
    found = writer.primitives.emplace(shape.mesh, add_mesh(writer, writer.scene.meshes[shape.mesh])).first;
  Json primitive = found->second;
  primitive["material"] = add_material(writer, shape.material);
  return primitive;
}

// The shape where its matrix takes it.
Mesh moved_mesh(const Mesh& mesh, const glm::dmat4& matrix) {
  Mesh moved = mesh;
  for (glm::vec3& p : moved.positions) p = glm::vec3(matrix * glm::dvec4(p, 1.0));
  const glm::dmat3 linear(matrix);
  const double determinant = glm::determinant(linear);
  if (!moved.normals.empty() && determinant != 0.0) {
    const glm::dmat3 of_normals = glm::transpose(glm::inverse(linear));
    for (glm::vec3& n : moved.normals) n = glm::vec3(of_normals * glm::dvec3(n));
  }
  if (determinant < 0.0)
    for (std::size_t t = 0; t + 2 < moved.indices.size(); t += 3) std::swap(moved.indices[t + 1], moved.indices[t + 2]);
  return moved;
}

std::size_t add_node(Writer& writer, Json node, const glm::dmat4& matrix) {
  if (matrix != glm::dmat4(1.0)) node["matrix"] = array_of(matrix);
  return add(writer, "nodes", std::move(node));
}

bool is_flat_or_wild(const glm::dmat4& matrix) {
  const double determinant = glm::determinant(glm::dmat3(matrix));
  bool finite = std::isfinite(determinant);
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r) finite &= std::isfinite(matrix[c][r]);
  return !finite || determinant == 0.0;
}

// The node of a shape; nothing where it has no triangles or a matrix that squashes it.
std::optional<std::size_t> add_shape(Writer& writer, const Shape& shape) {
  if (writer.scene.meshes[shape.mesh].indices.empty()) return std::nullopt;
  if (is_flat_or_wild(shape.matrix)) {
    writer.scene.losses.add("shape with a transform that is flat or not finite left out");
    return std::nullopt;
  }
  Json mesh = {{"primitives", Json::array({primitive_of(writer, shape)})}};
  Json node = {{"mesh", add(writer, "meshes", std::move(mesh))}};
  if (!shape.name.empty()) node["name"] = shape.name;
  return add_node(writer, std::move(node), shape.matrix);
}

// A group as one mesh, for all its uses.
std::optional<std::size_t> add_group(Writer& writer, const std::vector<Shape>& shapes) {
  Json primitives = Json::array();
  for (const Shape& shape : shapes) {
    const Mesh& mesh = writer.scene.meshes[shape.mesh];
    if (mesh.indices.empty() || is_flat_or_wild(shape.matrix)) continue;
    if (shape.matrix == glm::dmat4(1.0)) {
      primitives.push_back(primitive_of(writer, shape));
      continue;
    }
    Json primitive = add_mesh(writer, moved_mesh(mesh, shape.matrix));
    primitive["material"] = add_material(writer, shape.material);
    primitives.push_back(std::move(primitive));
  }
  if (primitives.empty()) return std::nullopt;
  return add(writer, "meshes", {{"primitives", std::move(primitives)}});
}

std::optional<std::size_t> add_volume(Writer& writer, const Volume& volume) {
  if (is_flat_or_wild(volume.matrix)) {
    writer.scene.losses.add("medium of voxels with a transform that is flat or not finite left out");
    return std::nullopt;
  }
  Json extras = {{"file", volume.uri},
                 {"scattering", array_of(volume.scattering)},
                 {"absorption", array_of(volume.absorption)},
                 {"anisotropy", volume.anisotropy},
                 {"emission", volume.emission},
                 {"temperature_scale", volume.temperature_scale},
                 {"temperature_offset", volume.temperature_offset}};
  return add_node(writer, {{"name", "volume"}, {"extras", {{"volume", std::move(extras)}}}}, volume.matrix);
}

std::optional<std::size_t> add_light(Writer& writer, const Light& light) {
  const double largest = std::max({light.intensity.x, light.intensity.y, light.intensity.z});
  if (!(largest > 0.0)) return std::nullopt;
  Json entry = {{"color", array_of(light.intensity / largest)}, {"intensity", largest}};
  constexpr const char* kTypes[] = {"point", "spot", "directional"};
  entry["type"] = kTypes[static_cast<std::size_t>(light.kind)];
  if (light.kind == LightKind::spot)
    entry["spot"] = {{"innerConeAngle", std::min(light.inner, light.outer * (1.0 - 1e-6))},
                     {"outerConeAngle", light.outer}};
  writer.extensions.insert("KHR_lights_punctual");
  Json& lights = writer.root["extensions"]["KHR_lights_punctual"]["lights"];
  lights.push_back(std::move(entry));
  const double length = glm::length(light.direction);
  glm::dmat4 matrix(1.0);
  if (light.kind != LightKind::point && length > 0.0) { // shines along -Z
    const glm::dvec3 z = -light.direction / length;
    const glm::dvec3 other = std::abs(z.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 x = glm::normalize(glm::cross(other, z));
    matrix[0] = glm::dvec4(x, 0.0), matrix[1] = glm::dvec4(glm::cross(z, x), 0.0), matrix[2] = glm::dvec4(z, 0.0);
  }
  matrix[3] = glm::dvec4(light.position, 1.0);
  return add_node(writer, {{"extensions", {{"KHR_lights_punctual", {{"light", lights.size() - 1}}}}}}, matrix);
}

std::size_t add_camera(Writer& writer, const Camera& camera) {
  Json entry;
  if (camera.orthographic) {
    entry = {{"type", "orthographic"},
             {"orthographic", {{"xmag", camera.xmag}, {"ymag", camera.ymag}, {"znear", 0.0}, {"zfar", 1e6}}}};
  } else {
    entry = {{"type", "perspective"}, {"perspective", {{"yfov", camera.yfov}, {"znear", 1e-3}}}};
    if (writer.scene.width > 0)
      entry["perspective"]["aspectRatio"] = static_cast<double>(writer.scene.width) / writer.scene.height;
  }
  return add_node(writer, {{"name", "camera"}, {"camera", add(writer, "cameras", std::move(entry))}},
                  camera.world_from_camera);
}

void place_all(Writer& writer) {
  Json inside = Json::array(), outside = Json::array();
  const auto take = [&](std::optional<std::size_t> node) {
    if (node) inside.push_back(*node);
  };
  for (const Shape& shape : writer.scene.shapes) take(add_shape(writer, shape));
  std::map<std::uint32_t, std::optional<std::size_t>> groups;
  for (const Use& use : writer.scene.uses) {
    const auto [found, is_new] = groups.try_emplace(use.group);
    if (is_new) found->second = add_group(writer, writer.scene.groups[use.group]);
    if (!found->second) continue;
    if (is_flat_or_wild(use.matrix))
      writer.scene.losses.add("shape with a transform that is flat or not finite left out");
    else
      take(add_node(writer, {{"mesh", *found->second}}, use.matrix));
  }
  for (const Light& light : writer.scene.lights) take(add_light(writer, light));
  if (writer.scene.volume) take(add_volume(writer, *writer.scene.volume));
  if (writer.scene.root != glm::dmat4(1.0) && !inside.empty()) {
    Json root = {{"name", "world"}, {"children", std::move(inside)}};
    inside = Json::array({add_node(writer, std::move(root), writer.scene.root)});
  }
  if (writer.scene.camera) outside.push_back(add_camera(writer, *writer.scene.camera));
  for (const Json& node : inside) outside.push_back(node);
  if (outside.empty())
    throw Error(writer.file, "has neither shapes nor lights nor a camera", "give the scene's main file");
  writer.root["scene"] = 0;
  writer.root["scenes"] = Json::array({{{"nodes", std::move(outside)}}});
}

} // namespace

GltfText to_gltf(Description& scene, const std::string& file, const std::string& binary_uri) {
  Writer writer{scene, file};
  writer.root["asset"] = {{"version", "2.0"}, {"generator", "wavepath convert, of " + scene.format}};
  for (const char* list : {"samplers", "textures"}) writer.root[list] = Json::array();
  place_all(writer);
  for (const char* list : {"samplers", "textures"})
    if (writer.root[list].empty()) writer.root.erase(list);
  if (!writer.extensions.empty()) writer.root["extensionsUsed"] = writer.extensions;
  if (!writer.binary.empty()) {
    writer.binary.resize((writer.binary.size() + 3) / 4 * 4);
    Json buffer = {{"byteLength", writer.binary.size()}};
    if (!binary_uri.empty()) buffer["uri"] = binary_uri;
    writer.root["buffers"] = Json::array({std::move(buffer)});
  }
  return {writer.root.dump(binary_uri.empty() ? -1 : 1, ' ', false, Json::error_handler_t::replace),
          std::move(writer.binary)};
}

std::vector<std::uint8_t> to_glb(const GltfText& text) {
  std::string json = text.json;
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::vector<std::uint8_t> out;
  const auto put = [&](std::uint32_t value) {
    std::uint8_t bytes[4];
    std::memcpy(bytes, &value, 4);
    out.insert(out.end(), bytes, bytes + 4);
  };
  const std::size_t total = 12 + 8 + json.size() + (text.binary.empty() ? 0 : 8 + text.binary.size());
  out.reserve(total);
  put(0x46546c67), put(2), put(static_cast<std::uint32_t>(total));
  put(static_cast<std::uint32_t>(json.size())), put(0x4e4f534a);
  out.insert(out.end(), json.begin(), json.end());
  if (!text.binary.empty()) {
    put(static_cast<std::uint32_t>(text.binary.size())), put(0x004e4942);
    out.insert(out.end(), text.binary.begin(), text.binary.end());
  }
  return out;
}

} // namespace wavepath::convert
