#include "host/gpu/acceleration.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/gpu/barrier.h"
#include "host/gpu/commands.h"

namespace wavepath {
namespace {

// The loader exports no functions of extensions.
template <class Function>
Function find(Device& device, const char* name) {
  return reinterpret_cast<Function>(vkGetDeviceProcAddr(device.handle(), name));
}

constexpr MemoryAccess kBuilt{VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR,
                              VK_ACCESS_2_ACCELERATION_STRUCTURE_WRITE_BIT_KHR};
// By later builds, and by kernels.
constexpr MemoryAccess kUsedOnceBuilt{
    VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR | VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
    VK_ACCESS_2_ACCELERATION_STRUCTURE_READ_BIT_KHR};

std::uint64_t scratch_alignment(const Device& device) {
  VkPhysicalDeviceAccelerationStructurePropertiesKHR limits{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_PROPERTIES_KHR};
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &limits};
  vkGetPhysicalDeviceProperties2(device.physical(), &properties);
  return std::max<std::uint64_t>(limits.minAccelerationStructureScratchOffsetAlignment, 1);
}

template <class T>
Buffer upload_addressed(Device& device, std::span<const T> values) {
  Buffer buffer(device, values.size_bytes(), BufferHome::addressed);
  if (!values.empty()) buffer.write(values.data(), values.size_bytes());
  return buffer;
}

VkAccelerationStructureGeometryKHR triangles_at(std::uint64_t address, std::size_t corners, bool opaque) {
  VkAccelerationStructureGeometryKHR geometry{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR};
  geometry.geometryType = VK_GEOMETRY_TYPE_TRIANGLES_KHR;
  geometry.flags = opaque ? VK_GEOMETRY_OPAQUE_BIT_KHR : VK_GEOMETRY_NO_DUPLICATE_ANY_HIT_INVOCATION_BIT_KHR;
  VkAccelerationStructureGeometryTrianglesDataKHR& triangles = geometry.geometry.triangles;
  triangles = {VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_TRIANGLES_DATA_KHR};
  triangles.vertexFormat = VK_FORMAT_R32G32B32_SFLOAT;
  triangles.vertexData.deviceAddress = address;
  triangles.vertexStride = sizeof(glm::vec3);
  triangles.maxVertex = static_cast<std::uint32_t>(std::max<std::size_t>(corners, 1)) - 1;
  triangles.indexType = VK_INDEX_TYPE_NONE_KHR;
  return geometry;
}

void require(const Device& device, const char* what, std::uint64_t count, std::uint64_t most) {
  if (count > most)
    throw Error(device.info().name, fmt::format("its ray queries know at most {} {}, not {}", most, what, count),
                "use --traversal compute");
}

} // namespace

QueryStructures::QueryStructures(QueryStructures&& other) noexcept
    : device_(other.device_),
      objects_(std::exchange(other.objects_, {})),
      top_(std::exchange(other.top_, {})),
      top_address_(std::exchange(other.top_address_, 0)) {}

QueryStructures::~QueryStructures() {
  if (objects_.empty() && top_.empty()) return;
  const auto destroy = find<PFN_vkDestroyAccelerationStructureKHR>(*device_, "vkDestroyAccelerationStructureKHR");
  for (const std::vector<Built>* list : {&top_, &objects_})
    for (const Built& built : *list) destroy(device_->handle(), built.handle, nullptr);
}

std::uint32_t QueryStructures::add(const QueryTriangles& triangles) {
  require(*device_, "triangles", (triangles.opaque.size() + triangles.asked.size()) / 3,
          device_->info().max_query_triangles);
  std::vector<Buffer> corners;
  std::vector<VkAccelerationStructureGeometryKHR> geometries;
  std::vector<std::uint32_t> counts;
  for (const std::span<const glm::vec3> list : {triangles.opaque, triangles.asked}) {
    const bool opaque = geometries.empty();
    if (!opaque && list.empty()) continue;
    corners.push_back(upload_addressed(*device_, list));
    geometries.push_back(triangles_at(corners.back().address(), list.size(), opaque));
    counts.push_back(static_cast<std::uint32_t>(list.size() / 3));
  }
  objects_.push_back(build(VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR, geometries, counts));
  return static_cast<std::uint32_t>(objects_.size() - 1);
}

void QueryStructures::place(std::span<const QueryInstance> all_placed) {
  constexpr std::uint64_t kMostNumbers = 1u << 24; // of custom indices
  require(*device_, "instances", all_placed.size(), std::min(kMostNumbers, device_->info().max_query_instances));
  std::vector<VkAccelerationStructureInstanceKHR> instances;
  instances.reserve(all_placed.size());
  for (const QueryInstance& placed : all_placed) {
    VkAccelerationStructureInstanceKHR& instance = instances.emplace_back();
    static_assert(sizeof(instance.transform) == sizeof(placed.world_from_object));
    std::memcpy(&instance.transform, placed.world_from_object, sizeof(instance.transform));
    instance.instanceCustomIndex = static_cast<std::uint32_t>(instances.size() - 1) & (kMostNumbers - 1);
    instance.mask = 0xff;
    instance.accelerationStructureReference = objects_[placed.object].address;
  }
  const Buffer list = upload_addressed(*device_, std::span<const VkAccelerationStructureInstanceKHR>(instances));
  VkAccelerationStructureGeometryKHR geometry{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR};
  geometry.geometryType = VK_GEOMETRY_TYPE_INSTANCES_KHR;
  geometry.geometry.instances = {VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_INSTANCES_DATA_KHR};
  geometry.geometry.instances.data.deviceAddress = list.address();
  const auto count = static_cast<std::uint32_t>(instances.size());
  top_.push_back(build(VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR, std::span(&geometry, 1), std::span(&count, 1)));
  top_address_ = top_.back().address;
}

std::uint64_t QueryStructures::bytes() const {
  std::uint64_t sum = 0;
  for (const std::vector<Built>* list : {&top_, &objects_})
    for (const Built& built : *list) sum += built.buffer.bytes();
  return sum;
}

// Waits for it. `counts`: of the primitives of each geometry.
QueryStructures::Built QueryStructures::build(VkAccelerationStructureTypeKHR type,
                                              std::span<const VkAccelerationStructureGeometryKHR> geometries,
                                              std::span<const std::uint32_t> counts) {
  VkAccelerationStructureBuildGeometryInfoKHR info{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR};
  info.type = type;
  info.flags = VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_TRACE_BIT_KHR;
  info.mode = VK_BUILD_ACCELERATION_STRUCTURE_MODE_BUILD_KHR;
  info.geometryCount = static_cast<std::uint32_t>(geometries.size());
  info.pGeometries = geometries.data();
  VkAccelerationStructureBuildSizesInfoKHR sizes{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_SIZES_INFO_KHR};
  find<PFN_vkGetAccelerationStructureBuildSizesKHR>(*device_, "vkGetAccelerationStructureBuildSizesKHR")(
      device_->handle(), VK_ACCELERATION_STRUCTURE_BUILD_TYPE_DEVICE_KHR, &info, counts.data(), &sizes);

  Built built;
  built.buffer = Buffer(*device_, sizes.accelerationStructureSize, BufferHome::addressed);
  const std::uint64_t alignment = scratch_alignment(*device_);
  const Buffer scratch(*device_, sizes.buildScratchSize + alignment, BufferHome::addressed);
  VkAccelerationStructureCreateInfoKHR create{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_CREATE_INFO_KHR};
  create.buffer = built.buffer.handle();
  create.size = sizes.accelerationStructureSize;
  create.type = type;
  check(find<PFN_vkCreateAccelerationStructureKHR>(*device_, "vkCreateAccelerationStructureKHR")(
            device_->handle(), &create, nullptr, &built.handle),
        "creating a structure for ray queries");

  info.dstAccelerationStructure = built.handle;
  info.scratchData.deviceAddress = (scratch.address() + alignment - 1) / alignment * alignment;
  std::vector<VkAccelerationStructureBuildRangeInfoKHR> ranges;
  for (const std::uint32_t count : counts) ranges.push_back({count, 0, 0, 0});
  const VkAccelerationStructureBuildRangeInfoKHR* first_range = ranges.data();
  const auto destroy = find<PFN_vkDestroyAccelerationStructureKHR>(*device_, "vkDestroyAccelerationStructureKHR");
  try {
    Commands commands(*device_);
    find<PFN_vkCmdBuildAccelerationStructuresKHR>(*device_, "vkCmdBuildAccelerationStructuresKHR")(commands.handle(), 1,
                                                                                                   &info, &first_range);
    record_barrier(commands.handle(), kBuilt, kUsedOnceBuilt);
    commands.submit_and_wait();
  } catch (...) {
    destroy(device_->handle(), built.handle, nullptr);
    throw;
  }
  VkAccelerationStructureDeviceAddressInfoKHR address{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_DEVICE_ADDRESS_INFO_KHR};
  address.accelerationStructure = built.handle;
  built.address = find<PFN_vkGetAccelerationStructureDeviceAddressKHR>(
      *device_, "vkGetAccelerationStructureDeviceAddressKHR")(device_->handle(), &address);
  return built;
}

} // namespace wavepath
