// The rule that lights a scene where the user does not say how.
#pragma once

#include <string_view>

#include "host/scene/scene.h"
#include "host/scene/staging/framing.h"

namespace wavepath {

enum class DefaultLight { authored, studio, sky, lamp, studio_besides, sky_besides };

// True if somebody has lit the scene: by punctual lights that shine, or by a camera and lamps. A lamp is a surface that
// emits all over, or more than 1 unit through a texture; a texture of 1 unit at most draws displays and glow on an
// asset. Reads no images.
bool is_lit(const Scene& scene);

// authored: the file is lit and has a camera, so that somebody has made a picture of it. Else it is an asset, which
// gets a studio, or a sky if it is an interior; a closed interior, which no sky reaches, gets a lamp under its ceiling.
// Light that the rules choose for the scene. Its punctual lights shine besides (studio_besides, sky_besides); a closed
// interior that has some is lit.
DefaultLight choose_light(const Scene& scene, const std::optional<Standpoint>& inside);

// The lamp of a closed interior: of pi times its height squared candela, so that a white floor under it has radiance 1.
PunctualLight room_lamp(const Standpoint& inside);

// As load_environment() takes it.
std::string_view environment_name(DefaultLight light);

// Why, in a line.
std::string_view reason(DefaultLight light);

} // namespace wavepath
