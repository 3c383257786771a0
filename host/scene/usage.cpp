// Counts instances, vertices and triangles of a scene; see usage.h.
#include "host/scene/usage.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "host/base/error.h"

namespace wavepath {
namespace {

// Triangles that only reach into what shines count as well; as many as lie within this part of the image around a disk.
constexpr double kLitBorder = 0.1;

double lit_fraction(const Image& image) {
  if (image.bytes.empty() && image.floats.empty()) return 1.0; // not decoded yet
  const std::size_t texels = std::size_t{image.width} * image.height;
  std::size_t lit = 0;
  for (std::size_t i = 0; i < 4 * texels; i += 4)
    lit += image.floats.empty() ? (image.bytes[i] | image.bytes[i + 1] | image.bytes[i + 2]) != 0
                                : image.floats[i] > 0.0f || image.floats[i + 1] > 0.0f || image.floats[i + 2] > 0.0f;
  return static_cast<double>(lit) / static_cast<double>(std::max<std::size_t>(texels, 1));
}

} // namespace

std::uint64_t new_content() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

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
  std::vector<double> fractions(scene.images.size(), -1.0); // by image, of its texels; negative: not counted yet
  std::uint64_t emitters = 0;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m)
    for (const Primitive& primitive : scene.meshes[m].primitives) {
      const Material& material = scene.materials[primitive.material];
      const bool shines = !material.unlit && glm::any(glm::greaterThan(material.emission, glm::vec3(0.0f)));
      if (!shines) continue;
      double fraction = 1.0;
      if (material.emission_texture.image < fractions.size()) { // before images are read there is none
        double& counted = fractions[material.emission_texture.image];
        if (counted < 0.0) counted = lit_fraction(scene.images[material.emission_texture.image]);
        fraction = std::min(1.0, counted + 2.0 * std::sqrt(counted) * kLitBorder);
      }
      const double triangles =
          static_cast<double>(primitive.index_count / 3) * static_cast<double>(usage.mesh_instances[m]);
      emitters += static_cast<std::uint64_t>(std::ceil(fraction * triangles));
    }
  return emitters;
}

} // namespace wavepath
