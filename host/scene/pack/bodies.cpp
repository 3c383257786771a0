#include "host/scene/pack/bodies.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

#include "host/scene/bounds.h"
#include "kernels/base/scene_types.h"

namespace wavepath {
namespace {

struct Body {
  std::uint32_t material = 0; // of the scene
  Bounds box;                 // world
};

std::vector<Body> list_bodies(const Scene& scene) {
  std::vector<Body> bodies;
  if (std::ranges::none_of(scene.materials, is_body)) return bodies;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    std::map<std::uint32_t, Bounds> boxes;
    for (const Primitive& primitive : mesh.primitives) {
      if (!is_body(scene.materials[primitive.material])) continue;
      for (std::uint32_t i = 0; i < primitive.index_count; ++i) {
        const glm::dvec3 p =
            transform_point(instance.world_from_object, mesh.positions[mesh.indices[primitive.first_index + i]]);
        if (finite_point(p)) boxes[primitive.material].add(p);
      }
    }
    for (const auto& [material, box] : boxes) bodies.push_back({material, box});
  }
  return bodies;
}

bool meet(const Bounds& a, const Bounds& b) {
  return glm::all(glm::lessThan(a.lo, b.hi)) && glm::all(glm::lessThan(b.lo, a.hi));
}

bool touch(const Bounds& a, const Bounds& b) {
  return glm::all(glm::lessThanEqual(a.lo, b.hi)) && glm::all(glm::lessThanEqual(b.lo, a.hi));
}

double volume(const Bounds& box) {
  const glm::dvec3 size = box.hi - box.lo;
  return size.x * size.y * size.z;
}

bool is_body(const gpu::Material& material) { return (material.flags >> gpu::kMaterialPriorityShift) != 0; }

glm::dmat4x3 world_from_object(const PackedScene& scene, std::uint32_t instance) {
  if (!scene.root_is_top) return glm::dmat4x3(1.0);
  glm::dmat4x3 matrix;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column)
      matrix[column][row] = scene.instances[instance].world_from_object[row][column];
  return matrix;
}

Bounds box_of(const gpu::Triangle& triangle, const glm::dmat4x3& world) {
  Bounds box;
  for (const glm::vec3& corner : {triangle.v0, triangle.v1, triangle.v2}) box.add(world * glm::dvec4(corner, 1.0));
  return box;
}

std::vector<Bounds> body_boxes(const PackedScene& scene) {
  std::vector<Bounds> boxes;
  for (const Draw& draw : scene.draws)
    for (std::uint32_t i = 0; i < (scene.root_is_top ? draw.instance_count : 1); ++i) {
      const glm::dmat4x3 world = world_from_object(scene, draw.first_instance + i);
      std::map<std::uint32_t, Bounds> by_material;
      for (std::uint32_t t = draw.first_triangle; t < draw.first_triangle + draw.triangle_count; ++t) {
        const std::uint32_t material = scene.triangles[t].surface & gpu::kTriangleMaterialMask;
        if (is_body(scene.materials[material])) by_material[material].add(box_of(scene.triangles[t], world));
      }
      for (const auto& [material, box] : by_material) boxes.push_back(box);
    }
  return boxes;
}

// Surfaces of bodies that a ray from `point` leaves by, less those that it enters by, by material.
std::map<std::uint32_t, int> count_exits(const PackedScene& scene, const glm::dvec3& point,
                                         const glm::dvec3& direction) {
  std::map<std::uint32_t, int> exits;
  const auto count = [&](const Draw& draw, const glm::dmat4x3& world, bool flipped) {
    std::set<std::uint32_t> counted; // trees with spatial splits hold copies
    for (std::uint32_t t = draw.first_triangle; t < draw.first_triangle + draw.triangle_count; ++t) {
      const gpu::Triangle& triangle = scene.triangles[t];
      const std::uint32_t material = triangle.surface & gpu::kTriangleMaterialMask;
      if (!is_body(scene.materials[material])) continue;
      const auto relative = [&](const glm::vec3& v) { return world * glm::dvec4(v, 1.0) - point; };
      const glm::dvec3 a = relative(triangle.v0), b = relative(triangle.v1), c = relative(triangle.v2);
      const double u = glm::dot(direction, glm::cross(b, c)), v = glm::dot(direction, glm::cross(c, a)),
                   w = glm::dot(direction, glm::cross(a, b));
      if (!((u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0))) continue;
      const glm::dvec3 normal = (flipped ? -1.0 : 1.0) * glm::cross(b - a, c - a);
      const double across = glm::dot(direction, normal);
      if (across == 0.0 || glm::dot(a, normal) / across <= 0.0 || !counted.insert(triangle.id).second) continue;
      exits[material] += across > 0.0 ? 1 : -1;
    }
  };
  for (const Draw& draw : scene.draws) {
    if (!scene.root_is_top) {
      count(draw, glm::dmat4x3(1.0), false);
      continue;
    }
    for (std::uint32_t i = draw.first_instance; i < draw.first_instance + draw.instance_count; ++i)
      count(draw, world_from_object(scene, i), scene.instances[i].flipped != 0);
  }
  return exits;
}

} // namespace

bool is_body(const Material& material) {
  return !material.unlit && material.volume && (material.transmission > 0.0f || material.diffuse_transmission > 0.0f);
}

bool bodies_overlap(const Scene& scene) {
  if (scene.materials.size() >= 0xffffu) return false; // lists of bodies hold 16 bits of each
  std::vector<Body> bodies = list_bodies(scene);
  std::ranges::sort(bodies, {}, [](const Body& body) { return body.box.lo.x; });
  for (std::size_t i = 0; i < bodies.size(); ++i)
    for (std::size_t k = i + 1; k < bodies.size() && bodies[k].box.lo.x < bodies[i].box.hi.x; ++k)
      if (meet(bodies[i].box, bodies[k].box)) return true;
  return false;
}

std::vector<std::uint32_t> body_priorities(const Scene& scene) {
  std::map<std::uint32_t, double> largest; // box of a material
  for (const Body& body : list_bodies(scene))
    largest[body.material] = std::max(largest[body.material], volume(body.box));
  std::vector<std::pair<double, std::uint32_t>> order;
  for (const auto& [material, size] : largest) order.emplace_back(-size, material);
  std::ranges::sort(order);
  std::vector<std::uint32_t> priorities(scene.materials.size(), 0);
  for (std::size_t i = 0; i < order.size(); ++i)
    priorities[order[i].second] = static_cast<std::uint32_t>(std::min<std::size_t>(i + 1, 65535));
  return priorities;
}

std::vector<std::uint32_t> bodies_at(const PackedScene& scene, const glm::dvec3& point) {
  const auto priority = [&](std::uint32_t material) {
    return scene.materials[material].flags >> gpu::kMaterialPriorityShift;
  };
  constexpr std::array<glm::dvec3, 3> kDirections{{{0.31, 0.83, 0.46}, {-0.71, 0.29, 0.64}, {0.57, -0.41, -0.71}}};
  std::map<std::uint32_t, int> votes;
  for (const glm::dvec3& direction : kDirections)
    for (const auto& [material, exits] : count_exits(scene, point, direction)) votes[material] += exits > 0;
  std::vector<std::uint32_t> bodies;
  for (const auto& [material, count] : votes)
    if (count >= 2) bodies.push_back(material);
  std::ranges::sort(bodies, [&](std::uint32_t a, std::uint32_t b) { return priority(a) > priority(b); });
  return bodies;
}

bool lamps_in_bodies(const PackedScene& scene) {
  if (!(scene.features & gpu::kFeatureVolume)) return false;
  const std::vector<Bounds> bodies = body_boxes(scene);
  return std::ranges::any_of(scene.lights, [&](const gpu::Light& light) {
    Bounds lamp;
    if (light.kind == gpu::kLightTriangle)
      lamp = box_of(scene.triangles[light.triangle], world_from_object(scene, light.instance));
    else if (light.kind == gpu::kLightPoint || light.kind == gpu::kLightSpot)
      for (const float radius : {-light.pdf_area, light.pdf_area}) lamp.add(glm::dvec3(light.position + radius));
    else
      return false;
    return std::ranges::any_of(bodies, [&](const Bounds& body) { return touch(body, lamp); });
  });
}

} // namespace wavepath
