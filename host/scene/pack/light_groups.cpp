#include "host/scene/pack/light_groups.h"

#include <algorithm>
#include <unordered_set>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/scene/pack/hit_surface.h"

namespace wavepath {
namespace {

constexpr std::size_t kMostNamesTold = 12;

// Something that shines, and the names by which it can be asked for; an empty one is no name.
struct LightSource {
  std::string first, second;
  std::string told; // as info lists it
  bool is_called(const std::string& name) const { return !name.empty() && (name == first || name == second); }
};

bool shines(const Material& m) { return m.unlit || glm::any(glm::greaterThan(m.emission, glm::vec3(0.0f))); }
bool shines(const PunctualLight& light) { return glm::any(glm::greaterThan(light.intensity, glm::vec3(0.0f))); }

std::string name_of_node(const Scene& scene, std::uint32_t node) {
  return node < scene.node_names.size() ? scene.node_names[node] : std::string();
}

// A lamp is told by its node, as one light of a file may hang on several.
std::string name_of_lamp(const Scene& scene, std::size_t lamp) {
  const PunctualLight& light = scene.lights[lamp];
  const std::string node = name_of_node(scene, light.node);
  if (!node.empty()) return node;
  return light.name.empty() ? fmt::format("light {}", lamp) : light.name;
}

std::string name_of_material(const Scene& scene, std::size_t material) {
  const std::string& name = scene.materials[material].name;
  return name.empty() ? fmt::format("material {}", material) : name;
}

// Calls body(instance, material) for every placed surface that shines.
template <class Body>
void for_each_shining(const Scene& scene, Body body) {
  for (const Instance& instance : scene.instances)
    for (const Primitive& primitive : scene.meshes[instance.mesh].primitives)
      if (primitive.index_count >= 3 && shines(scene.materials[primitive.material])) body(instance, primitive.material);
}

std::vector<LightSource> list_sources(const Scene& scene) {
  std::vector<LightSource> sources;
  for (std::size_t i = 0; i < scene.lights.size(); ++i)
    if (shines(scene.lights[i])) {
      const std::string name = name_of_lamp(scene, i);
      sources.push_back({name, scene.lights[i].name, name});
    }
  for_each_shining(scene, [&](const Instance& instance, std::uint32_t material) {
    const std::string name = name_of_material(scene, material), node = name_of_node(scene, instance.node);
    sources.push_back({name, node, node.empty() ? name : fmt::format("{} on {}", name, node)});
  });
  if (scene.environment.present()) sources.push_back({kEnvironmentGroup, "", kEnvironmentGroup});
  if (scene.volume && scene.volume->shines()) sources.push_back({kVolumeGroup, "", kVolumeGroup});
  return sources;
}

// By their first names, each once.
std::vector<std::string> names_of(const std::vector<LightSource>& sources) {
  std::vector<std::string> names;
  std::unordered_set<std::string> known;
  for (const LightSource& source : sources)
    if (known.insert(source.first).second) names.push_back(source.first);
  return names;
}

[[noreturn]] void refuse_name(const std::string& name, const std::vector<LightSource>& sources) {
  const std::vector<std::string> known = names_of(sources);
  throw UsageError("--light-groups", fmt::format("no light of the scene is called '{}'", name),
                   known.empty() ? "the scene has no light" : fmt::format("name some of: {}", in_short(known)));
}

// The first of the groups that is called so.
std::uint32_t group_called(const std::vector<std::string>& groups, const LightSource& source) {
  const auto found = std::ranges::find_if(groups, [&](const std::string& name) { return source.is_called(name); });
  return found == groups.end() ? kNoIndex : static_cast<std::uint32_t>(found - groups.begin());
}

} // namespace

LightGroups find_light_groups(const Scene& scene, const std::vector<std::string>& asked) {
  const std::vector<LightSource> sources = list_sources(scene);
  LightGroups groups;
  if (asked == std::vector<std::string>{kEachLight}) {
    groups.names = names_of(sources);
    if (groups.names.empty()) refuse_name(kEachLight, sources);
    if (groups.names.size() > gpu::kMostLightGroups) groups.names.resize(gpu::kMostLightGroups - 1);
  } else {
    groups.names = asked;
    for (const std::string& name : asked)
      if (std::ranges::none_of(sources, [&](const LightSource& source) { return source.is_called(name); }))
        refuse_name(name, sources);
  }
  const auto group_of = [&](const std::string& first, const std::string& second) {
    return group_called(groups.names, {first, second, {}});
  };
  for (std::size_t i = 0; i < scene.lights.size(); ++i)
    groups.of_lamps.push_back(group_of(name_of_lamp(scene, i), scene.lights[i].name));
  for (std::size_t i = 0; i < scene.materials.size(); ++i)
    groups.of_materials.push_back(shines(scene.materials[i]) ? group_of(name_of_material(scene, i), "") : kNoIndex);
  groups.of_nodes.resize(scene.node_names.size(), kNoIndex);
  for_each_shining(scene, [&](const Instance& instance, std::uint32_t) {
    if (instance.node < groups.of_nodes.size() && !scene.node_names[instance.node].empty())
      groups.of_nodes[instance.node] = group_of(scene.node_names[instance.node], "");
  });
  groups.of_environment = group_of(kEnvironmentGroup, "");
  groups.of_volume = group_of(kVolumeGroup, "");

  const bool has_others = std::ranges::any_of(
      sources, [&](const LightSource& source) { return group_of(source.first, source.second) == kNoIndex; });
  if (has_others && std::ranges::count(groups.names, kOtherLights) == 0) groups.names.emplace_back(kOtherLights);
  if (groups.names.size() > gpu::kMostLightGroups)
    throw UsageError("--light-groups",
                     fmt::format("makes {} groups with that of all other lights", groups.names.size()),
                     fmt::format("name at most {}", gpu::kMostLightGroups - 1));
  return groups;
}

std::vector<std::string> light_names(const Scene& scene) { return names_of(list_sources(scene)); }

std::vector<std::vector<std::string>> lights_of(const Scene& scene, const LightGroups& groups) {
  std::vector<std::vector<std::string>> lights(groups.names.size());
  std::vector<std::unordered_set<std::string>> known(groups.names.size());
  for (const LightSource& source : list_sources(scene)) {
    const std::uint32_t called = group_called(groups.names, source);
    const std::size_t group = called == kNoIndex ? groups.names.size() - 1 : called;
    if (known[group].insert(source.told).second) lights[group].push_back(source.told);
  }
  return lights;
}

std::string in_short(const std::vector<std::string>& names) {
  const std::size_t told = std::min(names.size(), kMostNamesTold);
  return fmt::format("{}{}", fmt::join(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(told), ", "),
                     told < names.size() ? fmt::format(", and {} more", names.size() - told) : "");
}

std::vector<std::string> find_group_names(const Scene& scene, const std::vector<std::string>& asked) {
  return asked.empty() ? std::vector<std::string>() : find_light_groups(scene, asked).names;
}

void pack_light_groups(const LightGroups& groups, std::span<const std::uint32_t> packed_index, PackedScene& packed) {
  const auto others = static_cast<std::uint32_t>(groups.names.size() - 1);
  const auto or_others = [&](std::uint32_t group) { return group == kNoIndex ? others : group; };
  std::vector<std::uint32_t> words(gpu::kGroupLights);
  words[gpu::kGroupCount] = static_cast<std::uint32_t>(groups.names.size());
  words[gpu::kGroupEnvironment] = or_others(groups.of_environment);
  words[gpu::kGroupVolume] = or_others(groups.of_volume);
  const auto of_node = [&](std::uint32_t node) {
    return or_others(node < groups.of_nodes.size() ? groups.of_nodes[node] : kNoIndex);
  };
  std::vector<std::uint32_t> of_materials(packed.materials.size(), others);
  for (std::size_t m = 0; m < packed_index.size(); ++m)
    if (packed_index[m] != kNoIndex)
      of_materials[packed_index[m]] = std::min(of_materials[packed_index[m]], or_others(groups.of_materials[m]));

  const std::size_t lamps = packed.lamp_sources.size();
  std::size_t lamp = 0;
  for (const gpu::Light& light : packed.lights) {
    if (light.kind == gpu::kLightEnvironment)
      words.push_back(words[gpu::kGroupEnvironment]);
    else if (light.kind == gpu::kLightTriangle)
      words.push_back(std::min(of_node(node_of(packed, {light.triangle, light.instance, 0.0f, 0.0f})),
                               of_materials[material_of(packed, {light.triangle, light.instance, 0.0f, 0.0f})]));
    else
      words.push_back(lamp < lamps ? or_others(groups.of_lamps[packed.lamp_sources[lamp++]]) : others);
  }
  words[gpu::kGroupMaterials] = static_cast<std::uint32_t>(words.size());
  words.insert(words.end(), of_materials.begin(), of_materials.end());
  const bool by_node = std::ranges::any_of(groups.of_nodes, [](std::uint32_t group) { return group != kNoIndex; });
  if (by_node && packed.root_is_top) {
    words[gpu::kGroupInstances] = static_cast<std::uint32_t>(words.size());
    for (const gpu::Instance& instance : packed.instances)
      words.push_back(instance.id == packed.once_instance ? gpu::kNone : of_node(packed.instance_nodes[instance.id]));
  }
  if (by_node) {
    words[gpu::kGroupTriangles] = static_cast<std::uint32_t>(words.size());
    // Of meshes that are shown more than once it is that of no node, and nobody reads it.
    for (std::uint32_t item = 0; item < packed.triangles.size(); ++item)
      words.push_back(of_node(node_of_once(packed, item)));
  }
  packed.light_groups = std::move(words);
}

} // namespace wavepath
