#include "host/selftest/scenes.h"

#include <numeric>

#include <glm/gtc/matrix_transform.hpp>

#include "host/scene/staging/view.h"

namespace wavepath {

std::uint32_t add_lambert(Scene& scene, glm::vec3 albedo, glm::vec3 emission) {
  Material material;
  material.base_color = glm::vec4(albedo, 1.0f);
  material.metallic = 0.0f;
  material.specular = 0.0f;
  material.double_sided = true;
  material.emission = emission;
  scene.materials.push_back(material);
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

void add_triangles(Scene& scene, const std::vector<glm::vec3>& positions, std::uint32_t material,
                   const glm::dmat4& world_from_object) {
  Mesh mesh;
  mesh.positions = positions;
  mesh.indices.resize(positions.size());
  std::iota(mesh.indices.begin(), mesh.indices.end(), 0u);
  mesh.primitives.push_back({0, static_cast<std::uint32_t>(positions.size()), material, false});
  scene.instances.push_back({static_cast<std::uint32_t>(scene.meshes.size()), world_from_object});
  scene.meshes.push_back(std::move(mesh));
}

void add_quad(Scene& scene, glm::vec3 corner, glm::vec3 a, glm::vec3 b, std::uint32_t material) {
  add_triangles(scene, {corner, corner + a, corner + a + b, corner, corner + a + b, corner + b}, material);
}

void look_at(Scene& scene, glm::dvec3 eye, glm::dvec3 target, double yfov, glm::dvec3 up) {
  Camera camera;
  camera.yfov = yfov;
  camera.world_from_camera = glm::inverse(glm::lookAt(eye, target, up));
  scene.cameras.push_back(camera);
}

PackedScene pack_positions(const std::vector<glm::vec3>& positions, bvh::Quality quality) {
  Scene scene;
  add_triangles(scene, positions, add_lambert(scene, glm::vec3(0.5f)));
  return pack(scene, {.quality = quality});
}

RenderResult render_scene(Device& device, Scene scene, const RenderPlan& settings) {
  const View view = resolve_view(scene, {}, settings.width, settings.height);
  return render(device, pack(scene, {.direct = settings.direct, .eye = view.position, .near = {view.position}}), view,
                settings);
}

double mean_of(const Picture& picture, int channel) {
  const std::vector<float>& values = picture.channels[static_cast<std::size_t>(channel)].values;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

} // namespace wavepath
