// Groups of lights (--light-groups): which lights, surfaces and environment belong to each.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "host/scene/pack/packed_scene.h"
#include "host/scene/scene.h"

namespace wavepath {

// Values of --light-groups that are no name of a light.
inline constexpr const char* kEachLight = "each";
inline constexpr const char* kEnvironmentGroup = "environment";
inline constexpr const char* kVolumeGroup = "volume";
inline constexpr const char* kOtherLights = "rest";

// By index of the scene's own arrays; kNoIndex = the group of the others.
struct LightGroups {
  std::vector<std::string> names; // in the order of their layers
  std::vector<std::uint32_t> of_lamps, of_nodes, of_materials;
  std::uint32_t of_environment = kNoIndex, of_volume = kNoIndex;
};

// Groups of the scene's lights. `asked`: names of nodes, lights and materials, or kEnvironmentGroup, each of which
// makes a group; or kEachLight alone: every node with a lamp, every material that shines, the environment and a volume
// that shines makes one, up to gpu::kMostLightGroups. A light belongs to the first group that names it. What none names
// belongs to a last group kOtherLights, which is there if it has a light. Throws UsageError if a name has no light.
LightGroups find_light_groups(const Scene& scene, const std::vector<std::string>& asked);

// Names by which each light of the scene makes a group of its own, as kEachLight names them.
std::vector<std::string> light_names(const Scene& scene);

// By group, in the order of groups.names: its lamps by node, its surfaces as "MATERIAL on NODE", its environment, its
// volume.
std::vector<std::vector<std::string>> lights_of(const Scene& scene, const LightGroups& groups);

// The first of the names in one line, and how many more there are.
std::string in_short(const std::vector<std::string>& names);

// Their names alone; none if none is asked for.
std::vector<std::string> find_group_names(const Scene& scene, const std::vector<std::string>& asked);

// Sets packed.light_groups, by which kernels know the groups. `packed_index`: index of each material of the scene among
// those packed.
void pack_light_groups(const LightGroups& groups, std::span<const std::uint32_t> packed_index, PackedScene& packed);

} // namespace wavepath
