// EXT_mesh_gpu_instancing: TRANSLATION, ROTATION and SCALE by instance, composed in double.
#include "host/scene/gltf/instancing.h"

#include <map>
#include <string>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include "host/base/memory.h"
#include "host/scene/gltf/accessor.h"
#include "host/scene/gltf/uri.h"

namespace wavepath::gltf {

namespace {

// Attributes by name; all have the same count.
std::map<std::string, Elements> open_instance_attributes(Document& document, const tinygltf::Value& list) {
  std::map<std::string, Elements> attributes;
  std::string first;
  for (const std::string& name : list.Keys()) {
    const std::string what = "instance attribute " + shown(name);
    const Elements elements = open_accessor(document, list.Get(name).GetNumberAsInt(), what);
    const int expected = name == "ROTATION" ? 4 : name == "TRANSLATION" || name == "SCALE" ? 3 : elements.components;
    if (elements.components != expected)
      document.fail(what + " has " + std::to_string(elements.components) + " components instead of " +
                    std::to_string(expected));
    if (!attributes.empty() && elements.count != attributes[first].count)
      document.fail(what + " has " + std::to_string(elements.count) + " elements, but " + shown(first) + " has " +
                    std::to_string(attributes[first].count));
    if (attributes.empty()) first = name;
    attributes[name] = elements;
  }
  return attributes;
}

} // namespace

std::vector<glm::dmat4> instance_matrices(Document& document, Warnings& warnings, const tinygltf::Node& node,
                                          const glm::dmat4& world, Scales scales) {
  const auto extension = node.extensions.find("EXT_mesh_gpu_instancing");
  if (extension == node.extensions.end()) return {world};
  auto attributes = open_instance_attributes(document, extension->second.Get("attributes"));
  if (attributes.empty()) {
    warnings.add("EXT_mesh_gpu_instancing without attributes ignored");
    return {world};
  }
  const std::size_t count = attributes.begin()->second.count;
  if (count == 0) warnings.add("node with zero instances left out");
  require_memory(document.file, "the instances of a node", std::uint64_t{count} * sizeof(glm::dmat4),
                 "use a machine with more memory");
  const Elements translation = attributes["TRANSLATION"], rotation = attributes["ROTATION"],
                 scale = attributes["SCALE"];
  const auto vector = [](const Elements& elements, std::size_t i) {
    return glm::dvec3(component(elements, i, 0), component(elements, i, 1), component(elements, i, 2));
  };
  std::vector<glm::dmat4> transforms(count, world);
  for (std::size_t i = 0; i < count; ++i) {
    if (translation.present()) transforms[i] = glm::translate(transforms[i], vector(translation, i));
    if (rotation.present()) {
      const glm::dvec3 xyz = vector(rotation, i);
      const glm::dquat q(component(rotation, i, 3), xyz.x, xyz.y, xyz.z);
      if (glm::length(q) != 0.0) transforms[i] *= glm::mat4_cast(glm::normalize(q));
    }
    if (scale.present()) transforms[i] = glm::scale(transforms[i], take_scale(vector(scale, i), scales));
  }
  return transforms;
}

} // namespace wavepath::gltf
