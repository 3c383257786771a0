// Typed, bounds-checked reading of glTF accessors (glTF 2.0 specification, 3.6.2).
#include "host/scene/gltf/accessor.h"

#include <algorithm>

#include "host/base/memory.h"
#include "host/scene/gltf/views.h"

namespace wavepath::gltf {
namespace {

// Accessors without data are filled with zeros (specification); this limits the memory that a short file can request.
constexpr std::size_t kMaxZeros = std::size_t{1} << 24;

std::size_t element_size(const tinygltf::Accessor& accessor, int components) {
  const int size = tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType));
  return static_cast<std::size_t>(size * components);
}

bool is_known_type(int type) {
  return type == TINYGLTF_COMPONENT_TYPE_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
         type == TINYGLTF_COMPONENT_TYPE_SHORT || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
         type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT || type == TINYGLTF_COMPONENT_TYPE_FLOAT;
}

// True if `count` elements of `size` bytes, `stride` apart and beginning at `offset`, lie within `available` bytes. No
// operation here can overflow.
bool fits(std::uint64_t available, std::uint64_t offset, std::uint64_t stride, std::uint64_t size,
          std::uint64_t count) {
  if (count == 0) return true;
  if (offset > available || size > available - offset) return false;
  return count - 1 <= (available - offset - size) / stride;
}

// The bytes of `count` tightly packed elements in a view, for the two halves of a sparse accessor.
const std::uint8_t* sparse_bytes(Document& document, const std::string& what, int view, int offset, std::size_t size,
                                 std::size_t count) {
  const Bytes bytes = view_bytes(document, static_cast<std::size_t>(view));
  if (!fits(bytes.size(), static_cast<std::uint64_t>(offset), size, size, count)) {
    document.fail(what + " has sparse data beyond the end of buffer view " + std::to_string(view));
  }
  return bytes.data() + offset;
}

std::shared_ptr<const std::vector<std::uint8_t>> with_substitutes(Document& document, const std::string& what,
                                                                  const tinygltf::Accessor& accessor,
                                                                  const Elements& base) {
  const auto& sparse = accessor.sparse;
  const auto size = element_size(accessor, base.components);
  require_memory(document.file, what, std::uint64_t{base.count} * size, "use a machine with more memory");
  auto filled = std::make_shared<std::vector<std::uint8_t>>(base.count * size);
  for (std::size_t i = 0; base.bytes && i < base.count; ++i) {
    std::memcpy(filled->data() + i * size, base.bytes + i * base.stride, size);
  }
  Elements indices;
  indices.component_type = sparse.indices.componentType;
  indices.count = static_cast<std::size_t>(sparse.count);
  if (indices.component_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
      indices.component_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
      indices.component_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) {
    document.fail(what + " has sparse indices that are not unsigned integers");
  }
  indices.stride =
      static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(indices.component_type)));
  indices.bytes =
      sparse_bytes(document, what, sparse.indices.bufferView, sparse.indices.byteOffset, indices.stride, indices.count);
  const std::uint8_t* values =
      sparse_bytes(document, what, sparse.values.bufferView, sparse.values.byteOffset, size, indices.count);
  for (std::size_t i = 0; i < indices.count; ++i) {
    const std::uint32_t target = index_at(indices, i);
    if (target >= base.count) document.fail(what + " has sparse index " + std::to_string(target) + " beyond its end");
    std::memcpy(filled->data() + target * size, values + i * size, size);
  }
  return filled;
}

template <typename T>
T load(const std::uint8_t* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

} // namespace

Elements open_accessor(Document& document, int index, const std::string& what, const Decoded& decoded) {
  const tinygltf::Accessor& accessor = document.model.accessors[static_cast<std::size_t>(index)];
  const std::string name = what + " (accessor " + std::to_string(index) + ")";
  if (!is_known_type(accessor.componentType)) document.fail(name + " has an unknown component type");
  Elements elements;
  elements.count = accessor.count;
  elements.component_type = accessor.componentType;
  elements.components = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
  elements.normalized = accessor.normalized;
  const std::size_t size = element_size(accessor, elements.components);
  elements.stride = size;

  if (const auto found = decoded.find(index); found != decoded.end()) {
    elements.bytes = found->second.bytes.data();
    elements.count = found->second.count;
    elements.components = found->second.components;
    elements.stride = element_size(accessor, elements.components);
    return elements;
  }
  if (accessor.bufferView >= 0) {
    const auto& view = document.model.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
    if (view.byteStride) elements.stride = view.byteStride;
    if (elements.stride < size) document.fail(name + " has elements larger than the stride of its buffer view");
    const Bytes bytes = view_bytes(document, static_cast<std::size_t>(accessor.bufferView));
    if (!fits(bytes.size(), accessor.byteOffset, elements.stride, size, accessor.count)) {
      document.fail(name + " reaches beyond the end of buffer view " + std::to_string(accessor.bufferView));
    }
    elements.bytes = bytes.data() + accessor.byteOffset;
  } else if (accessor.count > kMaxZeros) {
    document.fail(name + " has " + std::to_string(accessor.count) + " elements, but no data");
  }
  if (accessor.sparse.isSparse) {
    elements.owner = with_substitutes(document, name, accessor, elements);
  } else if (!elements.bytes) {
    elements.owner = std::make_shared<std::vector<std::uint8_t>>(accessor.count * size);
  }
  if (elements.owner) {
    elements.bytes = elements.owner->data();
    elements.stride = size;
  }
  return elements;
}

Elements open_indices(Document& document, int index) {
  const Elements indices = open_accessor(document, index, "indices");
  const bool unsigned_integer = indices.component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                                indices.component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                                indices.component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
  if (indices.components != 1 || !unsigned_integer) {
    document.fail("accessor " + std::to_string(index) + " holds indices that are not unsigned integers");
  }
  return indices;
}

double component(const Elements& elements, std::size_t element, int index) {
  const std::uint8_t* bytes = elements.bytes + element * elements.stride;
  const auto i = static_cast<std::size_t>(index);
  const bool n = elements.normalized;
  switch (elements.component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: {
      const double value = load<std::int8_t>(bytes + i);
      return n ? std::max(value / 127.0, -1.0) : value;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return bytes[i] / (n ? 255.0 : 1.0);
    case TINYGLTF_COMPONENT_TYPE_SHORT: {
      const double value = load<std::int16_t>(bytes + 2 * i);
      return n ? std::max(value / 32767.0, -1.0) : value;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return load<std::uint16_t>(bytes + 2 * i) / (n ? 65535.0 : 1.0);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return load<std::uint32_t>(bytes + 4 * i) / (n ? 4294967295.0 : 1.0);
    default:
      return load<float>(bytes + 4 * i);
  }
}

std::uint32_t index_at(const Elements& indices, std::size_t element) {
  const std::uint8_t* bytes = indices.bytes + element * indices.stride;
  switch (indices.component_type) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return *bytes;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return load<std::uint16_t>(bytes);
    default:
      return load<std::uint32_t>(bytes);
  }
}

std::vector<double> all_components(const Elements& elements) {
  std::vector<double> values;
  values.reserve(elements.count * static_cast<std::size_t>(elements.components));
  for (std::size_t i = 0; i < elements.count; ++i) {
    for (int c = 0; c < elements.components; ++c) values.push_back(component(elements, i, c));
  }
  return values;
}

} // namespace wavepath::gltf
