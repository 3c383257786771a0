// EXT_mesh_gpu_instancing: TRANSLATION, ROTATION and SCALE by instance, composed in double.
#include "host/scene/gltf/instancing.h"

#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include "host/scene/gltf/accessor.h"

namespace wavepath::gltf {

std::vector<glm::dmat4> instance_matrices(Document& document, const tinygltf::Node& node, const glm::dmat4& world) {
  const auto extension = node.extensions.find("EXT_mesh_gpu_instancing");
  if (extension == node.extensions.end()) return {world};
  const tinygltf::Value& attributes = extension->second.Get("attributes");
  std::size_t count = 0;
  bool is_first = true;
  const auto open = [&](const char* name, int components) {
    if (!attributes.Has(name)) return Elements{};
    const Elements elements = open_accessor(document, attributes.Get(name).GetNumberAsInt(), name);
    if (elements.components != components || (!is_first && elements.count != count)) {
      document.fail(std::string("instance attribute ") + name +
                    " has the wrong type, or another count than its fellows");
    }
    count = elements.count;
    is_first = false;
    return elements;
  };
  const Elements translation = open("TRANSLATION", 3), rotation = open("ROTATION", 4), scale = open("SCALE", 3);
  const auto vector = [](const Elements& elements, std::size_t i) {
    return glm::dvec3(component(elements, i, 0), component(elements, i, 1), component(elements, i, 2));
  };
  std::vector<glm::dmat4> places(count, world);
  for (std::size_t i = 0; i < count; ++i) {
    if (translation.present()) places[i] = glm::translate(places[i], vector(translation, i));
    if (rotation.present()) {
      const glm::dvec3 xyz = vector(rotation, i);
      const glm::dquat q(component(rotation, i, 3), xyz.x, xyz.y, xyz.z);
      if (glm::length(q) > 0.0) places[i] *= glm::mat4_cast(glm::normalize(q));
    }
    if (scale.present()) places[i] = glm::scale(places[i], vector(scale, i));
  }
  return places;
}

} // namespace wavepath::gltf
