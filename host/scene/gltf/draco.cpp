// Decompresses with Draco and checks the result against the accessors.
#include "host/scene/gltf/draco.h"

#include <algorithm>
#include <cstring>
#include <memory>

#include <draco/compression/decode.h>

#include "host/scene/gltf/uri.h"
#include "host/scene/gltf/views.h"

namespace wavepath::gltf {
namespace {

constexpr const char* kOtherCount = "accessor whose count is not that of its Draco data, which were taken as they are";

std::vector<std::uint32_t> corners_of(const draco::Mesh& mesh) {
  std::vector<std::uint32_t> corners;
  corners.reserve(std::size_t{mesh.num_faces()} * 3);
  for (std::uint32_t i = 0; i < mesh.num_faces(); ++i)
    for (const draco::PointIndex& corner : mesh.face(draco::FaceIndex(i))) corners.push_back(corner.value());
  return corners;
}

template <typename T>
bool pack(const draco::Mesh& mesh, const draco::PointAttribute& attribute, int components, std::uint8_t* out) {
  T values[4] = {};
  for (std::uint32_t i = 0; i < mesh.num_points(); ++i) {
    const auto index = attribute.mapped_index(draco::PointIndex(i));
    if (index.value() >= attribute.size()) return false;
    if (!attribute.ConvertValue<T>(index, static_cast<std::int8_t>(components), values)) return false;
    std::memcpy(out, values, sizeof(T) * static_cast<std::size_t>(components));
    out += sizeof(T) * static_cast<std::size_t>(components);
  }
  return true;
}

DecodedAccessor packed_attribute(const Document& document, Warnings& warnings, const draco::Mesh& mesh, int id,
                                 const tinygltf::Accessor& accessor, const std::string& name) {
  const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(id));
  if (!attribute)
    document.fail("its Draco data hold no attribute " + std::to_string(id) + ", which should be " + shown(name));
  const int size = tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType));
  // Draco may hold three components of a colour where the accessor declares four.
  const int components = std::min(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type)),
                                  static_cast<int>(attribute->num_components()));
  if (components < 1 || components > 4 || size > 4)
    document.fail("the accessor of " + shown(name) + " does not fit its Draco data");
  if (accessor.count != mesh.num_points()) warnings.add(kOtherCount);
  const std::size_t count = mesh.num_points();
  std::vector<std::uint8_t> bytes(count * static_cast<std::size_t>(components * size));
  bool done = false;
  switch (accessor.componentType) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      done = pack<std::int8_t>(mesh, *attribute, components, bytes.data());
      break;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      done = pack<std::uint8_t>(mesh, *attribute, components, bytes.data());
      break;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      done = pack<std::int16_t>(mesh, *attribute, components, bytes.data());
      break;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      done = pack<std::uint16_t>(mesh, *attribute, components, bytes.data());
      break;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      done = pack<std::uint32_t>(mesh, *attribute, components, bytes.data());
      break;
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      done = pack<float>(mesh, *attribute, components, bytes.data());
      break;
    default:
      break;
  }
  if (!done) document.fail("the Draco data of " + shown(name) + " cannot be converted");
  return {std::move(bytes), count, components};
}

std::unique_ptr<draco::Mesh> read_draco_mesh(const Document& document, Bytes bytes) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::string problem = "it asks for too much memory";
  try {
    draco::Decoder decoder;
    auto result = decoder.DecodeMeshFromBuffer(&buffer);
    if (result.ok()) return std::move(result).value();
    problem = result.status().error_msg_string();
  } catch (const std::exception&) { // bad_alloc or length_error: the data contain impossible counts
  }
  document.fail("its Draco data cannot be decoded: " + shown(problem));
}

} // namespace

std::optional<DracoMesh> decode_draco(Document& document, Warnings& warnings, const tinygltf::Primitive& primitive) {
  const auto extension = primitive.extensions.find("KHR_draco_mesh_compression");
  if (extension == primitive.extensions.end()) return {};
  const auto accessor_of = [&](int index) -> const tinygltf::Accessor& {
    return document.model.accessors[static_cast<std::size_t>(index)];
  };
  const auto view = static_cast<std::size_t>(extension->second.Get("bufferView").GetNumberAsInt());
  const auto mesh = read_draco_mesh(document, view_bytes(document, view));
  DracoMesh decoded;
  decoded.corners = corners_of(*mesh);
  const auto indices = primitive.attributes.find(kIndices);
  const bool is_list = primitive.mode == TINYGLTF_MODE_TRIANGLES;
  if (is_list && indices != primitive.attributes.end() && accessor_of(indices->second).count != decoded.corners.size())
    warnings.add(kOtherCount);
  const tinygltf::Value& ids = extension->second.Get("attributes");
  for (const std::string& name : ids.Keys()) {
    const auto attribute = primitive.attributes.find(name);
    if (attribute == primitive.attributes.end()) document.fail("Draco attribute " + shown(name) + " has no accessor");
    decoded.attributes[attribute->second] = packed_attribute(document, warnings, *mesh, ids.Get(name).GetNumberAsInt(),
                                                             accessor_of(attribute->second), name);
  }
  for (const auto& [name, index] : primitive.attributes) {
    const bool elsewhere = accessor_of(index).bufferView >= 0 || accessor_of(index).sparse.isSparse;
    if (name == kIndices || elsewhere || decoded.attributes.contains(index)) continue;
    if (name == "POSITION") document.fail("its Draco data hold no positions");
    warnings.add("attribute that is missing in Draco data set to 0");
  }
  return decoded;
}

} // namespace wavepath::gltf
