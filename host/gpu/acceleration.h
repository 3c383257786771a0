// Structures that a driver builds of triangles for ray queries (VK_KHR_acceleration_structure): one for every object,
// and one over the instances of objects.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "host/gpu/buffer.h"

namespace wavepath {

// Triangles of an object, in its own space, three corners each. Ray queries name a triangle by its geometry, 0 or 1,
// and its number there.
struct QueryTriangles {
  std::span<const glm::vec3> opaque; // geometry 0: ends rays without asking
  std::span<const glm::vec3> asked;  // geometry 1: kernels decide, once for every ray that meets one
};

// An object with a transform. Its index, counted from 0, is what ray queries report as the custom index.
struct QueryInstance {
  std::uint32_t object = 0;       // number that add() returned
  glm::vec4 world_from_object[3]; // rows
};

// An address as kernels take it: low, high.
inline glm::uvec2 words_of_address(std::uint64_t address) {
  return {static_cast<std::uint32_t>(address), static_cast<std::uint32_t>(address >> 32)};
}

class QueryStructures {
public:
  // Needs DeviceInfo::has_ray_queries.
  explicit QueryStructures(Device& device) : device_(&device) {}
  ~QueryStructures();
  QueryStructures(QueryStructures&& other) noexcept;
  QueryStructures& operator=(QueryStructures&&) = delete;

  // Builds the structure of an object; returns its number. Throws Error if the device has no memory for it, or if it
  // has more triangles than the device allows; so does place().
  std::uint32_t add(const QueryTriangles& triangles);
  // Builds what rays are traced through, once, after all objects.
  void place(std::span<const QueryInstance> all_placed);

  std::uint64_t address() const { return top_address_; } // for kernels; after place()
  std::uint64_t bytes() const;

private:
  struct Built {
    Buffer buffer;
    VkAccelerationStructureKHR handle = VK_NULL_HANDLE;
    std::uint64_t address = 0;
  };
  Built build(VkAccelerationStructureTypeKHR type, std::span<const VkAccelerationStructureGeometryKHR> geometries,
              std::span<const std::uint32_t> counts);

  Device* device_;
  std::vector<Built> objects_;
  std::vector<Built> top_; // one, after place()
  std::uint64_t top_address_ = 0;
};

} // namespace wavepath
