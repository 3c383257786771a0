// A camera as stats and `wavepath info` tell it.
#pragma once

#include <cstdint>

#include <nlohmann/json.hpp>

#include "host/scene/scene.h"
#include "host/scene/staging/view.h"

namespace wavepath {

// As kernels/base/camera_model.glsl has it: world space; `right` and `up` are half the picture at unit distance, in
// metres (orthographic) or in radians (panoramas). With angles of view and the matrix K for a picture of this size.
nlohmann::ordered_json camera_json(const View& view, std::uint32_t width, std::uint32_t height);

// What the file has: angles in degrees, distances in metres, the matrix from the camera's axes to the world's by rows.
nlohmann::ordered_json camera_json(const Camera& camera);

} // namespace wavepath
