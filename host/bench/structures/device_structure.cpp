#include "host/bench/structures/device_structure.h"

#include <algorithm>
#include <array>

#include "host/base/clock.h"
#include "host/gpu/commands.h"
#include "host/gpu/warm_up.h"

namespace wavepath {
namespace {

constexpr std::uint32_t kGroupSize = 64; // of kernels/bench/structure.glsl
constexpr std::size_t kRaysOfDispatch = 1u
                                        << 18; // the slowest structure takes far less than a second for them on a GPU

std::vector<glm::vec4> list_corners(const Structure& structure, std::span<const bvh::Triangle> triangles) {
  std::vector<glm::vec4> corners;
  const std::size_t count = structure.items_in_place ? structure.items.size() : triangles.size();
  corners.reserve(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    const bvh::Triangle& triangle = triangles[structure.items_in_place ? structure.items[i] : i];
    for (const bvh::Vec3& corner : {triangle.v0, triangle.v1, triangle.v2})
      corners.emplace_back(corner.x, corner.y, corner.z, 0.0f);
  }
  return corners;
}

BindingKind node_kind(const Structure& structure) {
  return structure.words_per_node == 4   ? BindingKind::texels_rgba32ui
         : structure.words_per_node == 2 ? BindingKind::texels_rg32ui
                                         : BindingKind::texels_r32ui;
}

} // namespace

DeviceStructure::DeviceStructure(Device& device, std::span<const std::uint32_t> spirv, const Structure& structure,
                                 std::span<const bvh::Triangle> triangles)
    : device_(device),
      spirv_(spirv),
      parameters_{structure.lo, 0, structure.size, 0, structure.resolution, structure.depth},
      node_kind_(node_kind(structure)),
      stack_in_registers_(device.info().type == "cpu"),
      corners_(upload(device, list_corners(structure, triangles))),
      nodes_(upload(device, structure.nodes)),
      items_(upload(device, structure.items_in_place ? std::vector<std::uint32_t>(1) : structure.items)),
      item_depths_(upload(device, structure.item_depths.empty() ? std::vector<float>(1) : structure.item_depths)) {}

void DeviceStructure::send(std::span<const StructureRay> rays) {
  if (sent_ == rays.data() && ray_count_ == rays.size()) return;
  kernels_.clear();
  rays_ = upload(device_, std::vector<StructureRay>(rays.begin(), rays.end()));
  distances_ = Buffer(device_, rays.size() * sizeof(float));
  work_ = Buffer(device_, rays.size() * sizeof(glm::uvec2));
  const std::vector<Binding> all = {{0, BindingKind::texels_rgba32f, &rays_},
                                    {1, BindingKind::texels_rgba32f, &corners_},
                                    {2, node_kind_, &nodes_},
                                    {3, BindingKind::texels_r32ui, &items_},
                                    {4, BindingKind::storage, &distances_},
                                    {5, BindingKind::storage, &work_},
                                    {6, BindingKind::texels_r32f, &item_depths_}};
  bindings_ = std::make_unique<BindingSet>(device_, all, sizeof(Parameters));
  for (const bool any_hit : {false, true}) kernels_.push_back(compile(any_hit, false));
  sent_ = rays.data();
  ray_count_ = rays.size();
}

Kernel DeviceStructure::compile(bool any_hit, bool counts) const {
  return Kernel(device_, "structure", spirv_, *bindings_,
                std::array{std::uint32_t{any_hit}, std::uint32_t{stack_in_registers_}, std::uint32_t{counts}});
}

double DeviceStructure::trace(std::span<const StructureRay> rays, bool any_hit) {
  if (rays.empty()) return 0.0;
  send(rays);
  return run(kernels_[any_hit ? 1 : 0]);
}

double DeviceStructure::run(const Kernel& kernel) const {
  Commands commands(device_, 1);
  return seconds_when_warm(device_.info(), [&] {
    double seconds = 0.0;
    for (std::size_t first = 0; first < ray_count_; first += kRaysOfDispatch) {
      const std::size_t count = std::min(kRaysOfDispatch, ray_count_ - first);
      Parameters parameters = parameters_;
      parameters.first_ray = static_cast<std::uint32_t>(first);
      parameters.ray_end = static_cast<std::uint32_t>(first + count);
      commands.restart(1);
      commands.bind(*bindings_);
      commands.dispatch(kernel, static_cast<std::uint32_t>((count + kGroupSize - 1) / kGroupSize), &parameters);
      const Clock::time_point start = Clock::now();
      commands.submit_and_wait();
      const double wall = seconds_since(start);
      const double timed = commands.times().empty() ? 0.0 : commands.times().front().seconds;
      seconds += timed > 0.0 ? timed : wall;
    }
    return seconds;
  });
}

std::vector<float> DeviceStructure::distances() const { return download<float>(distances_, ray_count_); }

bvh::Counters DeviceStructure::count(std::span<const StructureRay> rays, bool any_hit) {
  bvh::Counters counters;
  if (rays.empty()) return counters;
  send(rays);
  run(compile(any_hit, true));
  for (const glm::uvec2& of_ray : download<glm::uvec2>(work_, ray_count_)) {
    counters.visits += of_ray.x;
    counters.tests += of_ray.y;
  }
  return counters;
}

} // namespace wavepath
