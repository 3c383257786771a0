// Linear blend skinning (glTF 2.0 specification, 3.7.3).
#include "host/scene/gltf/skin.h"

#include <algorithm>
#include <cmath>

#include <glm/gtc/type_ptr.hpp>

namespace wavepath::gltf {
namespace {

std::vector<glm::dmat4> joint_matrices(Document& document, Warnings& warnings, int index,
                                       const std::vector<glm::dmat4>& world) {
  const tinygltf::Skin& skin = document.model.skins[static_cast<std::size_t>(index)];
  const std::string what = "skin " + std::to_string(index);
  if (skin.joints.empty()) document.fail(what + " has no joints");
  std::vector<double> inverse_bind;
  if (skin.inverseBindMatrices >= 0) {
    const Elements elements = open_accessor(document, skin.inverseBindMatrices, "inverse bind matrices of " + what);
    const bool float_matrices = elements.components == 16 && elements.component_type == TINYGLTF_COMPONENT_TYPE_FLOAT;
    if (!float_matrices || elements.count < skin.joints.size()) {
      document.fail(what + " lacks an inverse bind matrix of floats for each joint");
    }
    inverse_bind = all_components(elements);
  }
  std::vector<glm::dmat4> joints;
  for (std::size_t i = 0; i < skin.joints.size(); ++i) {
    glm::dmat4 inverse = inverse_bind.empty() ? glm::dmat4(1.0) : glm::make_mat4(&inverse_bind[i * 16]);
    if (!std::all_of(&inverse[0][0], &inverse[0][0] + 16, [](double x) { return std::isfinite(x); })) {
      warnings.add("inverse bind matrix that is not finite replaced by the identity");
      inverse = glm::dmat4(1.0);
    }
    joints.push_back(world[static_cast<std::size_t>(skin.joints[i])] * inverse);
  }
  return joints;
}

} // namespace

Skin open_skin(Document& document, Warnings& warnings, const tinygltf::Primitive& primitive, int index,
               const std::vector<glm::dmat4>& world, std::size_t vertex_count, const Decoded& decoded) {
  Skin skin;
  if (index < 0) return skin;
  skin.joints = joint_matrices(document, warnings, index, world);
  for (int set = 0;; ++set) {
    const auto joints = primitive.attributes.find("JOINTS_" + std::to_string(set));
    const auto weights = primitive.attributes.find("WEIGHTS_" + std::to_string(set));
    if (joints == primitive.attributes.end() || weights == primitive.attributes.end()) break;
    skin.indices.push_back(open_accessor(document, joints->second, joints->first, decoded));
    skin.weights.push_back(open_accessor(document, weights->second, weights->first, decoded));
    for (const Elements* elements : {&skin.indices.back(), &skin.weights.back()}) {
      if (elements->components != 4 || elements->count != vertex_count) {
        document.fail("JOINTS_ or WEIGHTS_" + std::to_string(set) + " does not hold 4 numbers for each vertex");
      }
    }
  }
  if (skin.indices.empty()) document.fail("a mesh with a skin has no JOINTS_0 and WEIGHTS_0");
  return skin;
}

glm::dmat4 blend(const Document& document, const Skin& skin, std::size_t vertex, std::size_t& not_finite) {
  glm::dmat4 sum(0.0);
  double total = 0.0;
  for (std::size_t set = 0; set < skin.indices.size(); ++set) {
    for (int i = 0; i < 4; ++i) {
      const double weight = component(skin.weights[set], vertex, i);
      if (!std::isfinite(weight)) ++not_finite;
      if (!(weight > 0.0) || std::isinf(weight)) continue;
      const double joint = component(skin.indices[set], vertex, i);
      if (!(joint >= 0.0 && joint < static_cast<double>(skin.joints.size()))) {
        document.fail("vertex " + std::to_string(vertex) +
                      " of a mesh with a skin uses a joint that the skin does not have");
      }
      sum += weight * skin.joints[static_cast<std::size_t>(joint)];
      total += weight;
    }
  }
  return total > 0.0 ? sum / total : skin.joints[0];
}

} // namespace wavepath::gltf
