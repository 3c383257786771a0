// The rule that lights a scene where the user does not say how.
#pragma once

#include <string_view>

#include "host/scene/scene.h"

namespace wavepath {

enum class DefaultLight { authored, studio, sky };

// authored: the file has punctual lights that shine, or a camera and lamps, so that somebody has lit it. Else it is an
// asset, which gets a studio, or a sky if it is an interior. A lamp is a surface that shines all over, or more than 1
// unit where it has a texture: a texture of 1 unit at most draws displays and glow on an asset. Reads no images.
DefaultLight choose_light(const Scene& scene, bool interior);

// As load_environment() takes it.
std::string_view environment_name(DefaultLight light);

// Why, in a line.
std::string_view reason(DefaultLight light);

} // namespace wavepath
