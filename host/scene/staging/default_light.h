// The rule that lights a scene if the user does not say how.
#pragma once

#include <string_view>

#include "host/scene/scene.h"
#include "host/scene/staging/framing.h"

namespace wavepath {

enum class DefaultLight { authored, studio, sky, lamp, studio_besides, sky_besides };

// True if the author has lit the scene: by punctual lights, or by lamps and a camera. A lamp is a surface that emits
// all over, or more than 1 unit through a texture; textures of at most 1 unit draw displays and glow on an asset. Reads
// no images.
bool is_lit(const Scene& scene);

// Chooses the light. authored: the file is lit and has a camera, so it was made for a picture. Otherwise it is an
// asset, which gets a studio, or a sky if it is an interior. A closed interior, which no sky reaches, gets a lamp under
// its ceiling.
// Punctual lights of the file are kept (studio_besides, sky_besides); a closed interior with some of them counts as
// lit.
DefaultLight choose_light(const Scene& scene, const std::optional<Standpoint>& inside);

// The lamp of a closed interior. Its intensity is pi times its height squared candela, so that a white floor below it
// has radiance 1.
PunctualLight room_lamp(const Standpoint& inside);

// The argument for load_environment().
std::string_view environment_name(DefaultLight light);

// The reason, in one line.
std::string_view reason(DefaultLight light);

} // namespace wavepath
