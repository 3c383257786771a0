// A structure on the device, and its kernel.
#pragma once

#include <deque>
#include <memory>
#include <span>
#include <vector>

#include "bvh/traverse.h"
#include "host/bench/structures/structure.h"
#include "host/gpu/buffer.h"
#include "host/gpu/kernel.h"

namespace wavepath {

class DeviceStructure {
public:
  // `spirv`: the structure's kernel. `triangles`: those that it was built over. Throws Error if the device cannot hold
  // them.
  DeviceStructure(Device& device, std::span<const std::uint32_t> spirv, const Structure& structure,
                  std::span<const bvh::Triangle> triangles);

  // Chooses where kernels that can do either keep the top of their stack: in registers, or in an array. The default is
  // registers on CPUs and an array on GPUs. To be called before the first rays.
  void put_stack_in_registers(bool in_registers) { stack_in_registers_ = in_registers; }

  // Seconds that the device takes for all rays; with `any_hit` it stops at the first that it finds. In dispatches that
  // no watchdog ends.
  double trace(std::span<const StructureRay> rays, bool any_hit);
  // Distances to the hits of the last trace; infinite for a miss.
  std::vector<float> distances() const;
  // Inner nodes or cells visited and triangles tested, for all rays; traces them anew.
  bvh::Counters count(std::span<const StructureRay> rays, bool any_hit);
  std::uint64_t bytes() const { return corners_.bytes() + nodes_.bytes() + items_.bytes() + item_depths_.bytes(); }

private:
  void send(std::span<const StructureRay> rays);
  Kernel compile(bool any_hit, bool counts) const; // for the latest rays
  double run(const Kernel& kernel) const;

  struct Parameters {
    glm::vec3 lo;
    std::uint32_t first_ray;
    glm::vec3 size;
    std::uint32_t ray_end;
    glm::uvec3 resolution;
    std::uint32_t depth;
  };

  Device& device_;
  std::span<const std::uint32_t> spirv_;
  Parameters parameters_;
  BindingKind node_kind_;
  bool stack_in_registers_;
  Buffer corners_, nodes_, items_, item_depths_, rays_, distances_, work_;
  std::unique_ptr<BindingSet> bindings_; // bindings of the latest rays
  std::deque<Kernel> kernels_;           // closest hit, any hit
  const StructureRay* sent_ = nullptr;
  std::size_t ray_count_ = 0;
};

} // namespace wavepath
