// Media of voxels of other formats, which become the volume of the scene.
#pragma once

#include <string>

#include "host/convert/described.h"

namespace wavepath::convert {

// Gives the scene this volume, whose boundary is a mesh. A scene has one: of others, and of voxels beyond the boundary,
// `losses` tells. `file` names the volume's file in messages. Throws Error if that is none.
void set_volume(Description& scene, Volume volume, const std::string& file, const Mesh& boundary,
                const glm::dmat4& matrix);

} // namespace wavepath::convert
