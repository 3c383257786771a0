#include "host/scene/staging/catcher.h"

#include <charconv>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "host/base/error.h"

namespace wavepath {
namespace {

bool is_node(const Scene& scene, std::uint32_t node, const std::string& wanted, bool by_name) {
  if (by_name) return scene.node_names[node] == wanted;
  std::uint32_t index = 0;
  const auto [end, error] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), index);
  return error == std::errc() && end == wanted.data() + wanted.size() && index == node;
}

std::uint32_t parent_of(const Scene& scene, std::uint32_t node) {
  return node < scene.node_parents.size() ? scene.node_parents[node] : kNoIndex;
}

// Instances of the node and of those below it.
std::vector<std::size_t> instances_of(const Scene& scene, const std::string& wanted, bool by_name) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    std::uint32_t node = scene.instances[i].node;
    while (node != kNoIndex && !is_node(scene, node, wanted, by_name)) node = parent_of(scene, node);
    if (node != kNoIndex) found.push_back(i);
  }
  return found;
}

// A few nodes that show something, for the message.
std::string examples(const Scene& scene) {
  std::string text;
  std::vector<std::string> told;
  for (const Instance& instance : scene.instances) {
    if (instance.node == kNoIndex || told.size() == 5) continue;
    const std::string& name = scene.node_names[instance.node];
    std::string shown = name.empty() ? fmt::format("{}", instance.node) : name;
    bool known = false;
    for (const std::string& other : told) known |= other == shown;
    if (!known) told.push_back(std::move(shown));
  }
  for (const std::string& name : told) text += ", " + name;
  return text;
}

} // namespace

void add_catcher(Scene& scene, const std::string& node) {
  if (node == "ground") return;
  std::vector<std::size_t> instances = instances_of(scene, node, true);
  if (instances.empty()) instances = instances_of(scene, node, false);
  if (instances.empty())
    throw UsageError("--catcher", fmt::format("no node {} shows triangles in this scene", node),
                     "name one of: ground" + examples(scene));
  scene.first_catcher = static_cast<std::uint32_t>(scene.materials.size());
  std::vector<std::uint32_t> own(scene.materials.size(), kNoIndex); // by material of the file
  std::vector<std::pair<std::uint32_t, std::uint32_t>> copies;      // of meshes
  for (const std::size_t i : instances) {
    std::uint32_t& mesh = scene.instances[i].mesh;
    for (const auto& [of, copy] : copies)
      if (of == mesh) mesh = copy;
    if (!copies.empty() && mesh >= copies.front().second) continue;
    copies.emplace_back(mesh, static_cast<std::uint32_t>(scene.meshes.size()));
    Mesh caught = scene.meshes[mesh];
    caught.content = 0;
    for (Primitive& primitive : caught.primitives) {
      std::uint32_t& material = own[primitive.material];
      if (material == kNoIndex) {
        material = static_cast<std::uint32_t>(scene.materials.size());
        scene.materials.push_back(Material(scene.materials[primitive.material]));
      }
      primitive.material = material;
    }
    mesh = copies.back().second;
    scene.meshes.push_back(std::move(caught));
  }
  scene.end_catcher = static_cast<std::uint32_t>(scene.materials.size());
}

void catch_ground(Scene& scene) {
  scene.end_catcher = static_cast<std::uint32_t>(scene.materials.size());
  scene.first_catcher = scene.end_catcher - 1;
}

void warn_of_unlit_catcher(Scene& scene) {
  if (!scene.lights.empty() || scene.environment.present()) return;
  scene.warnings.add(
      "--catcher: no lamp and no environment lights this scene, so nothing casts a shadow on the "
      "catcher; light of surfaces that glow counts as light of objects (--sun or --env gives light)");
}

} // namespace wavepath
