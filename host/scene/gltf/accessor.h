// Typed, bounds-checked reading of glTF accessors.
#pragma once

#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <vector>

#include <glm/glm.hpp>

#include "host/scene/gltf/document.h"

namespace wavepath::gltf {

// The elements of an accessor. All bytes addressed by count and stride exist. Copies share the bytes.
struct Elements {
  const std::uint8_t* bytes = nullptr;
  std::size_t count = 0, stride = 0;
  int component_type = 0; // TINYGLTF_COMPONENT_TYPE_*
  int components = 0;     // components of an element
  bool normalized = false;
  std::shared_ptr<const std::vector<std::uint8_t>> owner; // set if the bytes are not the document's

  bool present() const { return components > 0; }
};

// The contents of an accessor that was compressed, tightly packed.
struct DecodedAccessor {
  std::vector<std::uint8_t> bytes;
  std::size_t count = 0;
  int components = 0;
};
using Decoded = std::map<int, DecodedAccessor>; // key: index of the accessor

// Opens an accessor of any type; sparse ones are filled in. `what` names it in messages. `decoded` replaces the
// contents of the accessors that it holds, and must outlive the result. Throws Error if it is out of bounds or
// malformed.
Elements open_accessor(Document& document, int accessor, const std::string& what, const Decoded& decoded = {});

// The same for indices: SCALAR, unsigned integer.
Elements open_indices(Document& document, int accessor);

// One component as the specification converts it: normalized integers to -1..1 or 0..1, others by value.
double component(const Elements& elements, std::size_t element, int index);

std::uint32_t index_at(const Elements& indices, std::size_t element);

// Element as a vector; components that the accessor lacks are `fill`.
template <int N>
glm::vec<N, float> vector_at(const Elements& elements, std::size_t element, float fill = 0.0f) {
  glm::vec<N, float> result(fill);
  if (elements.component_type == TINYGLTF_COMPONENT_TYPE_FLOAT) {
    const auto count = static_cast<std::size_t>(elements.components < N ? elements.components : N);
    std::memcpy(&result[0], elements.bytes + element * elements.stride, count * sizeof(float));
  } else {
    for (int i = 0; i < N && i < elements.components; ++i)
      result[i] = static_cast<float>(component(elements, element, i));
  }
  return result;
}

// Every component of every element, in order.
std::vector<double> all_components(const Elements& elements);

} // namespace wavepath::gltf
