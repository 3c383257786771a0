#include "host/bench/builtin_scene.h"

#include <cmath>

#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>

namespace wavepath {
namespace {

constexpr float kSide = 3.0f; // metres; the box stands on y = 0, open towards +z

std::uint32_t add_material(Scene& scene, const char* name, glm::vec3 color, float specular = 0.0f) {
  Material material;
  material.name = name;
  material.base_color = glm::vec4(color, 1.0f);
  material.metallic = 0.0f;
  material.roughness = 0.3f;
  material.specular = specular;
  material.double_sided = true;
  scene.materials.push_back(material);
  return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

void add_mesh(Scene& scene, Mesh mesh, std::uint32_t material) {
  mesh.primitives.push_back({0, static_cast<std::uint32_t>(mesh.indices.size()), material, !mesh.normals.empty()});
  scene.instances.push_back({static_cast<std::uint32_t>(scene.meshes.size())});
  scene.meshes.push_back(std::move(mesh));
}

// The parallelogram corner + [0,1] * a + [0,1] * b.
void add_wall(Scene& scene, glm::vec3 corner, glm::vec3 a, glm::vec3 b, std::uint32_t material) {
  Mesh mesh;
  mesh.positions = {corner, corner + a, corner + a + b, corner + b};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  add_mesh(scene, std::move(mesh), material);
}

// A ball of rows x 2 rows quadrilaterals whose radius swings by `ripple` of itself. Without ripple it gets vertex
// normals.
void add_ball(Scene& scene, glm::vec3 centre, float radius, float ripple, std::uint32_t rows, std::uint32_t material) {
  Mesh mesh;
  const std::uint32_t columns = 2 * rows;
  for (std::uint32_t row = 0; row <= rows; ++row)
    for (std::uint32_t column = 0; column <= columns; ++column) {
      const float polar = glm::pi<float>() * static_cast<float>(row) / static_cast<float>(rows);
      const float around = glm::two_pi<float>() * static_cast<float>(column % columns) / static_cast<float>(columns);
      const glm::vec3 out(std::sin(polar) * std::cos(around), std::cos(polar), std::sin(polar) * std::sin(around));
      mesh.positions.push_back(centre +
                               radius * (1.0f + ripple * std::sin(20.0f * polar) * std::sin(20.0f * around)) * out);
      if (ripple == 0.0f) mesh.normals.push_back(out);
    }
  for (std::uint32_t row = 0; row < rows; ++row)
    for (std::uint32_t column = 0; column < columns; ++column) {
      const std::uint32_t first = row * (columns + 1) + column, below = first + columns + 1;
      if (row > 0) mesh.indices.insert(mesh.indices.end(), {first, first + 1, below + 1});
      if (row + 1 < rows) mesh.indices.insert(mesh.indices.end(), {first, below + 1, below});
    }
  add_mesh(scene, std::move(mesh), material);
}

} // namespace

Scene builtin_scene() {
  Scene scene;
  scene.path = "built-in";
  const std::uint32_t white = add_material(scene, "white", {0.73f, 0.73f, 0.73f});
  const std::uint32_t red = add_material(scene, "red", {0.65f, 0.05f, 0.05f});
  const std::uint32_t green = add_material(scene, "green", {0.12f, 0.45f, 0.15f});
  const std::uint32_t glossy = add_material(scene, "glossy", {0.2f, 0.3f, 0.6f}, 1.0f);
  const std::uint32_t lamp = add_material(scene, "lamp", glm::vec3(0.0f));
  scene.materials[lamp].emission = glm::vec3(15.0f);

  const float h = 0.5f * kSide;
  const glm::vec3 x(kSide, 0, 0), y(0, kSide, 0), z(0, 0, kSide);
  add_wall(scene, {-h, 0, -h}, z, x, white);     // floor
  add_wall(scene, {-h, kSide, -h}, x, z, white); // ceiling
  add_wall(scene, {-h, 0, -h}, x, y, white);     // back
  add_wall(scene, {-h, 0, -h}, y, z, red);
  add_wall(scene, {h, 0, -h}, z, y, green);
  add_wall(scene, {-0.15f * kSide, 0.995f * kSide, -0.15f * kSide}, 0.3f * x, 0.3f * z, lamp);
  add_ball(scene, {-0.7f, 0.7f, -0.4f}, 0.65f, 0.03f, 112, white);
  add_ball(scene, {0.7f, 0.6f, 0.4f}, 0.6f, 0.0f, 56, glossy);

  Camera camera;
  camera.name = "front";
  camera.yfov = glm::radians(40.0f);
  camera.world_from_camera = glm::translate(glm::dmat4(1.0), glm::dvec3(0.0, h, 5.6));
  scene.cameras.push_back(camera);
  return scene;
}

} // namespace wavepath
