// Boxes and orders placed objects; see instances.h.
#include "host/scene/pack/instances.h"

#include <algorithm>
#include <cmath>

#include "bvh/build.h"
#include "host/base/error.h"
#include "host/scene/bounds.h"

namespace wavepath {
namespace {

bvh::Vec3 round_down(const glm::dvec3& p) {
  const auto down = [](double x) {
    const float f = static_cast<float>(x);
    return std::nextafter(f, -std::numeric_limits<float>::infinity());
  };
  return {down(p.x), down(p.y), down(p.z)};
}

bvh::Vec3 round_up(const glm::dvec3& p) {
  const bvh::Vec3 down = round_down(-p);
  return {-down.x, -down.y, -down.z};
}

// The kernels transform rays to object space with matrices rounded to float, which moves the object by up to about
// 2^-22 of the terms in the transform; the box is widened by as much.
bvh::Box device_box(const Object& object, const glm::dmat4& transform) {
  const Bounds box = transform_bounds({object.lo, object.hi}, transform);
  const glm::dvec3 reach = glm::max(glm::abs(glm::dvec3(object.lo)), glm::abs(glm::dvec3(object.hi)));
  glm::dvec3 terms = glm::abs(glm::dvec3(transform[3]));
  for (int column = 0; column < 3; ++column) terms += glm::abs(glm::dvec3(transform[column])) * reach[column];
  if (!finite_point(terms)) return {};
  const glm::dvec3 pad = terms * 0x1p-22;
  return {round_down(box.lo - pad), round_up(box.hi + pad)};
}

// False if a row does not fit into floats.
bool store_rows(const glm::dmat4& matrix, glm::vec4 (&rows)[3]) {
  bool fits = true;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) {
      rows[row][column] = static_cast<float>(matrix[column][row]);
      fits = fits && std::isfinite(rows[row][column]);
    }
  return fits;
}

} // namespace

std::vector<std::uint32_t> pack_instances(std::span<const Object> objects, std::span<const Placement> placements,
                                          PackedScene& packed, std::size_t& skipped) {
  std::vector<gpu::Instance> instances;
  std::vector<std::uint32_t> object_of;
  std::vector<bvh::Box> boxes;
  std::uint32_t deepest = 0;
  for (const Placement& placement : placements) {
    const Object& object = objects[placement.object];
    if (object.triangle_count == 0) continue;
    gpu::Instance instance{};
    const bvh::Box box = device_box(object, placement.device_from_object);
    if (!bvh::is_valid(box) || !store_rows(placement.device_from_object, instance.world_from_object) ||
        !store_rows(glm::inverse(placement.device_from_object), instance.object_from_world)) {
      ++skipped;
      continue;
    }
    instance.root = object.root;
    instance.flipped = glm::determinant(glm::dmat3(placement.device_from_object)) < 0.0 ? 1u : 0u;
    instance.id = static_cast<std::uint32_t>(instances.size());
    instances.push_back(instance);
    packed.instance_nodes.push_back(placement.node);
    packed.instance_sources.push_back(placement.source);
    if (placement.object == 0) packed.once_instance = instance.id;
    object_of.push_back(placement.object);
    boxes.push_back(box);
    deepest = std::max(deepest, object.depth);
  }

  // One instance a leaf: entering an instance is expensive, and the kernels hold the state of one at a time.
  const bvh::WideTree top = bvh::build(boxes, {.max_leaf_size = 1});
  packed.root = append_tree(top, 0, packed.nodes);
  packed.root_is_top = true;
  // While an object is traversed, the stack also holds the pending node and up to seven pending instances of the top
  // level, and the mark that separates the levels.
  packed.stack_size = top.depth + 1 + 7 + 1 + deepest;
  packed.instances.reserve(instances.size());
  std::vector<std::uint32_t> ordered_objects;
  ordered_objects.reserve(instances.size());
  for (const std::uint32_t i : top.order) {
    packed.instances.push_back(instances[i]);
    ordered_objects.push_back(object_of[i]);
  }
  return ordered_objects;
}

} // namespace wavepath
