// Decompresses with Draco and checks the result against the accessors.
#include "host/scene/gltf/draco.h"

#include <cstring>
#include <memory>

#include <draco/compression/decode.h>

#include "host/scene/gltf/uri.h"
#include "host/scene/gltf/views.h"

namespace wavepath::gltf {
namespace {

std::vector<std::uint8_t> packed_indices(const Document& document, const draco::Mesh& mesh,
                                         const tinygltf::Accessor& accessor) {
  const std::size_t size =
      static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType)));
  if (accessor.count != std::size_t{mesh.num_faces()} * 3) {
    document.fail("an index accessor has " + std::to_string(accessor.count) + " elements, but its Draco data has " +
                  std::to_string(mesh.num_faces()) + " triangles");
  }
  std::vector<std::uint8_t> bytes(accessor.count * size);
  for (std::size_t i = 0; i < accessor.count; ++i) {
    const std::uint32_t index = mesh.face(draco::FaceIndex(static_cast<std::uint32_t>(i / 3)))[i % 3].value();
    if (size < 4 && index >> (8 * size)) document.fail("a Draco index does not fit the component type of its accessor");
    std::memcpy(&bytes[i * size], &index, size); // little-endian, as glTF is
  }
  return bytes;
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

std::vector<std::uint8_t> packed_attribute(const Document& document, const draco::Mesh& mesh, int id,
                                           const tinygltf::Accessor& accessor, const std::string& name) {
  const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(static_cast<std::uint32_t>(id));
  const int components = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
  const int size = tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType));
  if (!attribute || accessor.count != mesh.num_points() || components > 4 || size > 4) {
    document.fail("the accessor of " + shown(name) + " does not fit its Draco data");
  }
  std::vector<std::uint8_t> bytes(accessor.count * static_cast<std::size_t>(components * size));
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
  return bytes;
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

std::map<int, std::vector<std::uint8_t>> decode_draco(Document& document, const tinygltf::Primitive& primitive) {
  std::map<int, std::vector<std::uint8_t>> decoded;
  const auto extension = primitive.extensions.find("KHR_draco_mesh_compression");
  if (extension == primitive.extensions.end()) return decoded;
  if (primitive.mode != TINYGLTF_MODE_TRIANGLES) document.fail("a Draco primitive is not a list of triangles");
  const auto view = static_cast<std::size_t>(extension->second.Get("bufferView").GetNumberAsInt());
  const auto mesh = read_draco_mesh(document, view_bytes(document, view));
  if (const auto indices = primitive.attributes.find(kIndices); indices != primitive.attributes.end()) {
    decoded[indices->second] =
        packed_indices(document, *mesh, document.model.accessors[static_cast<std::size_t>(indices->second)]);
  }
  const tinygltf::Value& ids = extension->second.Get("attributes");
  for (const std::string& name : ids.Keys()) {
    const auto attribute = primitive.attributes.find(name);
    if (attribute == primitive.attributes.end()) document.fail("Draco attribute " + shown(name) + " has no accessor");
    const auto& accessor = document.model.accessors[static_cast<std::size_t>(attribute->second)];
    decoded[attribute->second] = packed_attribute(document, *mesh, ids.Get(name).GetNumberAsInt(), accessor, name);
  }
  return decoded;
}

} // namespace wavepath::gltf
