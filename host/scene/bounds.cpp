// Boxes of meshes and scenes in double precision; see bounds.h.
#include "host/scene/bounds.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include "host/scene/usage.h"

namespace wavepath {

namespace {

Bounds join(Bounds a, const Bounds& b) {
  a.add(b);
  return a;
}

} // namespace

Bounds mesh_bounds(const Mesh& mesh, const glm::dmat4& transform) {
  Bounds total;
  for (const Primitive& primitive : mesh.primitives) {
    const std::uint32_t* indices = mesh.indices.data() + primitive.first_index;
    const auto add_range = [&](const tbb::blocked_range<std::uint32_t>& range, Bounds bounds) {
      for (std::uint32_t t = range.begin(); t < range.end(); ++t) {
        glm::dvec3 p[3];
        for (int k = 0; k < 3; ++k) p[k] = transform_point(transform, mesh.positions[indices[3 * t + k]]);
        if (!finite_point(p[0]) || !finite_point(p[1]) || !finite_point(p[2])) continue;
        for (const glm::dvec3& point : p) bounds.add(point);
        if (!mesh.moves()) continue;
        for (int k = 0; k < 3; ++k) p[k] = transform_point(transform, mesh.end_positions[indices[3 * t + k]]);
        if (finite_point(p[0]) && finite_point(p[1]) && finite_point(p[2]))
          for (const glm::dvec3& point : p) bounds.add(point);
      }
      return bounds;
    };
    total.add(tbb::parallel_reduce(tbb::blocked_range<std::uint32_t>(0, primitive.index_count / 3, 4096), Bounds{},
                                   add_range, join));
  }
  return total;
}

Bounds transform_bounds(const Bounds& box, const glm::dmat4& transform) {
  Bounds out;
  if (box.empty()) return out;
  for (int corner = 0; corner < 8; ++corner)
    out.add(transform_point(transform, {corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y,
                                        corner & 4 ? box.hi.z : box.lo.z}));
  return out;
}

Bounds index_bounds(const VoxelGrid& grid) {
  Bounds box;
  if (grid.bricks.empty()) return box;
  const glm::dvec3 lo = glm::dvec3(grid.first) - 0.5;
  box.add(lo);
  box.add(lo + double{kBrickSide} * glm::dvec3(grid.brick_counts));
  return box;
}

Bounds volume_bounds(const Volume& volume) {
  const VoxelGrid& density = volume.grids->density;
  return transform_bounds(index_bounds(density), volume.world_from_grid * density.grid_from_index);
}

Bounds world_bounds(const Scene& scene) {
  const Usage usage = find_usage(scene);
  std::vector<Bounds> shared(scene.meshes.size());
  for (std::size_t m = 0; m < scene.meshes.size(); ++m)
    if (usage.mesh_instances[m] > 1) shared[m] = mesh_bounds(scene.meshes[m], glm::dmat4(1.0));

  const auto add_range = [&](const tbb::blocked_range<std::size_t>& range, Bounds world) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const Instance& instance = scene.instances[i];
      const std::uint32_t uses = usage.mesh_instances[instance.mesh];
      if (uses == 0) continue;
      const Bounds box = uses == 1 ? mesh_bounds(scene.meshes[instance.mesh], instance.world_from_object)
                                   : transform_bounds(shared[instance.mesh], instance.world_from_object);
      if (!box.empty() && finite_point(box.lo) && finite_point(box.hi)) world.add(box);
    }
    return world;
  };
  Bounds world =
      tbb::parallel_reduce(tbb::blocked_range<std::size_t>(0, scene.instances.size()), Bounds{}, add_range, join);
  if (scene.volume) world.add(volume_bounds(*scene.volume));
  return world;
}

} // namespace wavepath
