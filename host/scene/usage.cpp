// Counts instances, vertices and triangles of a scene; see usage.h.
#include "host/scene/usage.h"

#include "host/base/error.h"

namespace wavepath {

Usage find_usage(const Scene& scene) {
  Usage usage;
  usage.mesh_instances.assign(scene.meshes.size(), 0);
  usage.first_vertex.assign(scene.meshes.size(), kNoIndex);
  usage.material_used.assign(scene.materials.size(), false);
  for (const Instance& instance : scene.instances) ++usage.mesh_instances[instance.mesh];

  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    std::uint64_t triangles = 0;
    if (usage.mesh_instances[m] > 0)
      for (const Primitive& primitive : mesh.primitives) triangles += primitive.index_count / 3;
    if (triangles == 0) {
      usage.mesh_instances[m] = 0;
      continue;
    }
    for (const Primitive& primitive : mesh.primitives) {
      if (primitive.index_count < 3) continue;
      usage.material_used[primitive.material] = true;
      usage.smooth = usage.smooth || (primitive.has_normals && !mesh.normals.empty());
    }
    if (usage.vertex_count + mesh.positions.size() > kNoIndex)
      throw Error(scene.path, "has more than 4294967295 vertices", "simplify or split the scene");
    usage.first_vertex[m] = static_cast<std::uint32_t>(usage.vertex_count);
    usage.vertex_count += mesh.positions.size();
    usage.triangles_stored += triangles;
    usage.triangles_seen += triangles * usage.mesh_instances[m];
    if (usage.mesh_instances[m] > 1) usage.shared_instances += usage.mesh_instances[m];
    usage.colored = usage.colored || !mesh.colors.empty();
  }
  return usage;
}

std::uint64_t count_emitters(const Scene& scene, const Usage& usage) {
  std::uint64_t emitters = 0;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m)
    for (const Primitive& primitive : scene.meshes[m].primitives) {
      const Material& material = scene.materials[primitive.material];
      const bool shines = !material.unlit && glm::any(glm::greaterThan(material.emission, glm::vec3(0.0f)));
      if (shines) emitters += std::uint64_t{primitive.index_count / 3} * usage.mesh_instances[m];
    }
  return emitters;
}

} // namespace wavepath
