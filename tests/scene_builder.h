// Small scenes built in code, for tests of everything downstream of the loader.
#pragma once

#include <glm/glm.hpp>

#include "host/scene/scene.h"

namespace wavepath {

// Appends a mesh of separate triangles (three positions each) with one material; returns its index.
inline std::uint32_t add_mesh(Scene& scene, const std::vector<glm::vec3>& positions, std::uint32_t material = 0) {
  Mesh mesh;
  mesh.positions = positions;
  for (std::uint32_t i = 0; i < positions.size(); ++i) mesh.indices.push_back(i);
  mesh.primitives.push_back({0, static_cast<std::uint32_t>(positions.size()), material, false});
  scene.meshes.push_back(mesh);
  return static_cast<std::uint32_t>(scene.meshes.size() - 1);
}

inline void add_instance(Scene& scene, std::uint32_t mesh, const glm::dmat4& world_from_object = glm::dmat4(1.0)) {
  scene.instances.push_back({mesh, world_from_object});
}

// The unit right triangle in the xy plane, counter-clockwise seen from +Z: area 1/2.
inline const std::vector<glm::vec3> kUnitTriangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

// A double-sided grey Lambert material: asks for as little as a material can.
inline Material plain_material() {
  Material material;
  material.base_color = {0.5f, 0.5f, 0.5f, 1.0f};
  material.metallic = 0.0f;
  material.specular = 0.0f;
  material.double_sided = true;
  return material;
}

// One unit triangle, shown once.
inline Scene triangle_scene() {
  Scene scene;
  scene.path = "test";
  scene.materials.push_back(plain_material());
  add_instance(scene, add_mesh(scene, kUnitTriangle));
  return scene;
}

} // namespace wavepath
