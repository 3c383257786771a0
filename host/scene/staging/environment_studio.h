// The built-in studio: soft boxes before a neutral backdrop, as a product photographer sets them up.
#pragma once

#include "host/scene/scene.h"

namespace wavepath {

// Makes the studio, for a subject that looks along +Z. It has a key light from the front left, a weak fill from the
// right, a box overhead, two strips behind that draw the edges, and a light backdrop that glows behind the subject. It
// is dark where the camera stands. A white matte floor has radiance 1.
Environment studio_environment();

} // namespace wavepath
