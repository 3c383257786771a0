// EXT_lights_ies: lamps of nodes with the measured intensities of a luminaire.
#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "host/scene/gltf/document.h"
#include "host/scene/scene.h"

namespace wavepath::gltf {

// Profiles read so far.
struct ProfileMap {
  struct Read {
    std::uint32_t index = kNoIndex; // in Scene::profiles; kNoIndex: the luminaire cannot be shown
    double candela = 0.0;
  };
  std::map<std::size_t, Read> read; // by profile of the file
};

// What the extension of a node says, as a point light without a place; nothing if the node has none, or one that cannot
// be shown, which a warning tells. Throws Error.
std::optional<PunctualLight> read_profile_light(Document& document, Scene& scene, ProfileMap& map,
                                                const tinygltf::Node& node);

} // namespace wavepath::gltf
