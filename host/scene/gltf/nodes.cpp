// Walks the node hierarchy without recursion, so that its depth does not matter.
#include "host/scene/gltf/nodes.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <glm/gtc/matrix_access.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>

#include "host/scene/gltf/uri.h"
#include "host/scene/material.h"

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

// Exporters invert and multiply in floats, which leaves rounding in the last row.
void round_to_affine(glm::dmat4& matrix) {
  const glm::dvec4 off = glm::row(matrix, 3) - glm::dvec4(0.0, 0.0, 0.0, 1.0);
  if (glm::all(glm::lessThanEqual(glm::abs(off), glm::dvec4(kAffineRounding))))
    matrix = glm::row(matrix, 3, glm::dvec4(0.0, 0.0, 0.0, 1.0));
}

// Columns of unit length; those that have none become vectors that stand on the others.
void take_length(glm::dmat4& matrix) {
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 column(matrix[i]);
    const double size = std::max({std::abs(column.x), std::abs(column.y), std::abs(column.z)});
    if (size > 0.0) matrix[i] = glm::dvec4(glm::normalize(column / size), 0.0);
  }
  for (int i = 0; i < 3; ++i) {
    if (glm::dvec3(matrix[i]) != glm::dvec3(0.0)) continue;
    const glm::dvec3 next(matrix[(i + 1) % 3]), last(matrix[(i + 2) % 3]);
    glm::dvec3 column = glm::cross(next, last);
    if (column == glm::dvec3(0.0)) { // of two or three such columns the first stands on the one that there may be
      const glm::dvec3 only = next + last;
      column[i] = 1.0;
      column -= only * glm::dot(only, column);
      if (column == glm::dvec3(0.0)) column[(i + 1) % 3] = 1.0; // that one lies along the axis
    }
    matrix[i] = glm::dvec4(glm::normalize(column), 0.0);
  }
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

std::optional<std::size_t> scene_index(const Document& document, const std::string& request) {
  const auto& scenes = document.model.scenes;
  if (request.empty() && scenes.empty()) return {};
  if (request.empty()) return document.model.defaultScene >= 0 ? at(document.model.defaultScene) : 0;
  std::vector<std::string> names;
  for (const auto& scene : scenes) names.push_back(scene.name);
  return choose(document, "scene", names, request);
}

std::vector<int> scene_nodes(const Document& document, const std::string& request) {
  const auto parent_of = parents(document);
  const std::optional<std::size_t> index = scene_index(document, request);
  if (!index) return with_descendants(document, roots(parent_of));
  const std::size_t chosen = *index;
  std::vector<int> nodes = document.model.scenes[chosen].nodes;
  std::vector<bool> seen(parent_of.size());
  for (const int node : nodes) {
    const std::string where = "scene " + std::to_string(chosen) + " lists node " + std::to_string(node);
    if (parent_of[at(node)] >= 0) document.fail(where + ", which is the child of another node");
    if (seen[at(node)]) document.fail(where + " twice");
    seen[at(node)] = true;
  }
  return with_descendants(document, std::move(nodes));
}

glm::dvec3 take_scale(const glm::dvec3& scale, Scales scales) {
  if (scales == Scales::authored) return scale;
  return glm::mix(glm::dvec3(1.0), glm::dvec3(-1.0), glm::lessThan(scale, glm::dvec3(0.0)));
}

std::vector<std::uint32_t> node_parents(const Document& document) {
  std::vector<std::uint32_t> result;
  for (const int parent : parents(document))
    result.push_back(parent < 0 ? kNoIndex : static_cast<std::uint32_t>(parent));
  return result;
}

glm::dmat4 local_matrix(const tinygltf::Node& node, Scales scales) {
  if (!node.matrix.empty()) {
    glm::dmat4 matrix = glm::make_mat4(node.matrix.data());
    round_to_affine(matrix);
    if (scales == Scales::signs) take_length(matrix);
    return matrix;
  }
  glm::dmat4 matrix(1.0);
  if (!node.translation.empty()) matrix = glm::translate(matrix, glm::make_vec3(node.translation.data()));
  if (!node.rotation.empty()) {
    const auto& q = node.rotation;
    const glm::dquat rotation(q[3], q[0], q[1], q[2]);
    const double length = glm::length(rotation);
    if (length > 0.0) matrix *= glm::mat4_cast(rotation / length);
  }
  if (!node.scale.empty()) matrix = glm::scale(matrix, take_scale(glm::make_vec3(node.scale.data()), scales));
  return matrix;
}

bool is_hidden(const tinygltf::Node& node) {
  const auto extension = node.extensions.find(kNodeVisibility);
  if (extension == node.extensions.end() || !extension->second.Has("visible")) return false;
  return !extension->second.Get("visible").Get<bool>();
}

void set_hidden(tinygltf::Node& node, bool hides) {
  tinygltf::Value::Object visibility;
  visibility["visible"] = tinygltf::Value(!hides);
  node.extensions[kNodeVisibility] = tinygltf::Value(std::move(visibility));
}

std::vector<glm::dmat4> world_matrices(const Document& document, Scales scales) {
  const auto parent_of = parents(document);
  const auto order = with_descendants(document, roots(parent_of));
  // Every node has at most one parent, so what no root reaches is a ring.
  if (order.size() < parent_of.size()) document.fail("its nodes contain a cycle");
  std::vector<glm::dmat4> world(parent_of.size());
  for (const int node : order) {
    const glm::dmat4 local = local_matrix(document.model.nodes[at(node)], scales);
    world[at(node)] = parent_of[at(node)] < 0 ? local : world[at(parent_of[at(node)])] * local;
  }
  return world;
}

std::vector<bool> hidden_nodes(const Document& document) {
  const auto parent_of = parents(document);
  std::vector<bool> hidden(parent_of.size());
  for (const int node : with_descendants(document, roots(parent_of))) {
    const int parent = parent_of[at(node)];
    hidden[at(node)] = is_hidden(document.model.nodes[at(node)]) || (parent >= 0 && hidden[at(parent)]);
  }
  return hidden;
}

} // namespace wavepath::gltf
