// Poses a document at one moment of an animation.
#pragma once

#include <optional>
#include <string>

#include "host/base/warnings.h"
#include "host/scene/gltf/document.h"

namespace wavepath::gltf {

// Shutter of a pose. `close`: when it closes, at the pose of when it opens. `is_closing`: the pose is that of its end,
// where only nodes have moved.
struct Shutter {
  std::optional<double> close{};
  bool is_closing = false;
};

// Overwrites what `animation` (name or index) moves by its values at `seconds`, held before the first and after the
// last key frame: translation, rotation, scale and weights of nodes, and by JSON pointers also visibility, materials,
// lights and cameras. Throws Error.
void pose(Document& document, Warnings& warnings, const std::string& animation, double seconds, Shutter shutter = {});

// Whether the animation (empty: none) moves materials. Throws Error.
bool animates_materials(const Document& document, const std::string& animation);

} // namespace wavepath::gltf
