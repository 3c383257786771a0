// Poses a document at one moment of an animation.
#pragma once

#include <string>

#include "host/base/warnings.h"
#include "host/scene/gltf/document.h"

namespace wavepath::gltf {

// Overwrites translation, rotation, scale and weights of the nodes that `animation` (name or index) moves with their
// values at `seconds`, held before the first and after the last key frame. Throws Error.
void pose(Document& document, Warnings& warnings, const std::string& animation, double seconds);

} // namespace wavepath::gltf
