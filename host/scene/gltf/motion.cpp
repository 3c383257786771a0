#include "host/scene/gltf/motion.h"

#include <algorithm>

#include "host/base/error.h"

namespace wavepath::gltf {
namespace {

[[noreturn]] void refuse(const Scene& scene) {
  throw Error(scene.path, "shows other meshes when the shutter closes than when it opens",
              "choose another --shutter, or leave it out");
}

// Objects that the file lacks, such as a floor, come last, have no node and stay where they are.
std::size_t instances_of_file(const Scene& scene) {
  std::size_t count = scene.instances.size();
  while (count > 0 && scene.instances[count - 1].node == kNoIndex) --count;
  return count;
}

bool moves(const Mesh& mesh, const glm::dmat4& transform, const Mesh& end, const glm::dmat4& end_transform) {
  return transform != end_transform || mesh.positions != end.positions || mesh.normals != end.normals;
}

// Kernels interpolate positions, normals and tangents alone.
bool is_repainted(const Mesh& mesh, const Mesh& end) {
  return mesh.uvs[0] != end.uvs[0] || mesh.uvs[1] != end.uvs[1] || mesh.colors != end.colors;
}

// `object_from_end`: from the object at the end to the object at the beginning, which is the space of the mesh.
void set_motion(Mesh& mesh, const Mesh& end, const glm::dmat4& object_from_end) {
  const glm::dmat3 linear(object_from_end), normal_matrix = glm::transpose(glm::inverse(linear));
  const auto unit = [](const glm::dvec3& v) { return glm::vec3(v / std::max(glm::length(v), 1e-300)); };
  for (const glm::vec3& p : end.positions) mesh.end_positions.emplace_back(object_from_end * glm::dvec4(p, 1.0));
  if (end.normals.size() == mesh.normals.size())
    for (const glm::vec3& n : end.normals) mesh.end_normals.push_back(unit(normal_matrix * glm::dvec3(n)));
  else
    mesh.end_normals = mesh.normals; // one of the two is flat, and has those of its faces
  const auto turn = [&](const std::vector<glm::vec4>& tangents, std::vector<glm::vec4>& turned) {
    for (const glm::vec4& t : tangents) turned.emplace_back(unit(linear * glm::dvec3(glm::vec3(t))), t.w);
  };
  turn(end.tangents, mesh.end_tangents);
  for (std::size_t layer = 0; layer < 2; ++layer) turn(end.layer_tangents[layer], mesh.end_layer_tangents[layer]);
}

} // namespace

void add_motion(Scene& scene, const Scene& end) {
  const std::size_t count = instances_of_file(scene);
  if (count != end.instances.size()) refuse(scene);
  std::vector<std::uint32_t> uses(scene.meshes.size());
  for (const Instance& instance : scene.instances) ++uses[instance.mesh];
  for (std::size_t i = 0; i < count; ++i) {
    Instance& instance = scene.instances[i];
    const glm::dmat4& end_transform = end.instances[i].world_from_object;
    const Mesh& end_mesh = end.meshes[end.instances[i].mesh];
    if (scene.meshes[instance.mesh].positions.size() != end_mesh.positions.size()) refuse(scene);
    if (is_repainted(scene.meshes[instance.mesh], end_mesh))
      scene.warnings.add("texture coordinates or colours that change while the shutter is open stay as it opens");
    if (!moves(scene.meshes[instance.mesh], instance.world_from_object, end_mesh, end_transform)) continue;
    if (--uses[instance.mesh] > 0) {
      Mesh copy = scene.meshes[instance.mesh];
      instance.mesh = static_cast<std::uint32_t>(scene.meshes.size());
      scene.meshes.push_back(std::move(copy));
    }
    set_motion(scene.meshes[instance.mesh], end_mesh, glm::inverse(instance.world_from_object) * end_transform);
  }
}

} // namespace wavepath::gltf
