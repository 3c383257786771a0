// Walks the node hierarchy without recursion, so that its depth does not matter.
#include "host/scene/gltf/nodes.h"

#include <algorithm>
#include <charconv>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>

#include "host/scene/gltf/uri.h"

namespace wavepath::gltf {
namespace {

std::size_t at(int index) { return static_cast<std::size_t>(index); }

std::vector<int> parents(const Document& document) {
  std::vector<int> result(document.model.nodes.size(), -1);
  for (std::size_t i = 0; i < result.size(); ++i) {
    for (const int child : document.model.nodes[i].children) {
      if (result[at(child)] >= 0) document.fail("node " + std::to_string(child) + " has two parents");
      result[at(child)] = static_cast<int>(i);
    }
  }
  return result;
}

// The given nodes and all below them, parents first. `nodes` must be roots, so that no cycle can be reached.
std::vector<int> with_descendants(const Document& document, std::vector<int> nodes) {
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (const int child : document.model.nodes[at(nodes[i])].children) nodes.push_back(child);
  }
  return nodes;
}

std::vector<int> roots(const std::vector<int>& parent_of) {
  std::vector<int> result;
  for (std::size_t i = 0; i < parent_of.size(); ++i) {
    if (parent_of[i] < 0) result.push_back(static_cast<int>(i));
  }
  return result;
}

glm::dmat4 local_matrix(const tinygltf::Node& node) {
  if (!node.matrix.empty()) return glm::make_mat4(node.matrix.data());
  glm::dmat4 matrix(1.0);
  if (!node.translation.empty()) matrix = glm::translate(matrix, glm::make_vec3(node.translation.data()));
  if (!node.rotation.empty()) {
    const auto& q = node.rotation;
    const glm::dquat rotation(q[3], q[0], q[1], q[2]);
    const double length = glm::length(rotation);
    if (length > 0.0) matrix *= glm::mat4_cast(rotation / length);
  }
  if (!node.scale.empty()) matrix = glm::scale(matrix, glm::make_vec3(node.scale.data()));
  return matrix;
}

} // namespace

std::size_t choose(const Document& document, const std::string& kind, const std::vector<std::string>& names,
                   const std::string& request) {
  const auto named = std::find(names.begin(), names.end(), request);
  if (named != names.end()) return static_cast<std::size_t>(named - names.begin());
  std::size_t index = 0;
  const auto parsed = std::from_chars(request.data(), request.data() + request.size(), index);
  const bool whole = parsed.ec == std::errc() && parsed.ptr == request.data() + request.size();
  if (whole && index < names.size()) return index;
  std::string list;
  for (std::size_t i = 0; i < names.size() && i < 20; ++i) {
    list += (i ? ", " : "") + std::to_string(i) + (names[i].empty() ? "" : " '" + shown(names[i]) + "'");
  }
  document.fail("has no " + kind + " '" + shown(request) + "'",
                list.empty() ? "leave that option out" : "choose one of " + list);
}

std::vector<int> scene_nodes(const Document& document, const std::string& request) {
  const auto parent_of = parents(document);
  const auto& scenes = document.model.scenes;
  if (request.empty() && scenes.empty()) return with_descendants(document, roots(parent_of));
  std::size_t chosen = document.model.defaultScene >= 0 ? at(document.model.defaultScene) : 0;
  if (!request.empty()) {
    std::vector<std::string> names;
    for (const auto& scene : scenes) names.push_back(scene.name);
    chosen = choose(document, "scene", names, request);
  }
  std::vector<int> nodes = scenes[chosen].nodes;
  std::vector<bool> seen(parent_of.size());
  for (const int node : nodes) {
    const std::string where = "scene " + std::to_string(chosen) + " lists node " + std::to_string(node);
    if (parent_of[at(node)] >= 0) document.fail(where + ", which is the child of another node");
    if (seen[at(node)]) document.fail(where + " twice");
    seen[at(node)] = true;
  }
  return with_descendants(document, std::move(nodes));
}

std::vector<glm::dmat4> world_matrices(const Document& document) {
  const auto parent_of = parents(document);
  const auto order = with_descendants(document, roots(parent_of));
  // Every node has at most one parent, so what no root reaches is a ring.
  if (order.size() < parent_of.size()) document.fail("its nodes contain a cycle");
  std::vector<glm::dmat4> world(parent_of.size());
  for (const int node : order) {
    const glm::dmat4 local = local_matrix(document.model.nodes[at(node)]);
    world[at(node)] = parent_of[at(node)] < 0 ? local : world[at(parent_of[at(node)])] * local;
  }
  return world;
}

} // namespace wavepath::gltf
