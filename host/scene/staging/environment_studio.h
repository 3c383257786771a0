// The built-in studio: soft boxes before a neutral backdrop, as a product photographer sets them up.
#pragma once

#include "host/scene/scene.h"

namespace wavepath {

// For a subject that looks along +Z: a key light from the front left, a weak fill from the right, a box overhead, two
// strips behind that draw the edges; a light backdrop that glows behind the subject, and darkness where the camera
// stands. A white matte floor under it has radiance 1.
Environment studio_environment();

} // namespace wavepath
