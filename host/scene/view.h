// The camera of one picture: a glTF camera, one of the user's own, or a framing of the scene.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <glm/glm.hpp>

#include "host/scene/bounds.h"
#include "host/scene/scene.h"

namespace wavepath {

// World space, double precision. A camera ray through image position (x, y) in [-1,1], y upwards: perspective:
// direction forward + x*right + y*up from position; orthographic: direction forward from position + x*right + y*up.
struct View {
  bool orthographic = false;
  glm::dvec3 position{0.0};
  glm::dvec3 forward{0.0, 0.0, -1.0}; // unit length
  glm::dvec3 right{1.0, 0.0, 0.0};    // carries the half extent of the image at unit distance (or in metres)
  glm::dvec3 up{0.0, 1.0, 0.0};
};

// What --camera, --eye, --look-at, --up and --yfov say; what is left out comes from the chosen camera.
struct ViewRequest {
  std::string camera{}; // name or index; empty = the first
  std::optional<glm::dvec3> eye{}, look_at{}, up{};
  std::optional<double> yfov{}; // radians
};

// Throws Error if the camera named is not there or the request is degenerate. A perspective camera keeps its vertical
// angle, an orthographic one its height; the width follows from the image. A scene without a camera is framed: the
// bounding sphere of its geometry fills the image, seen from a little above and to the right of +Z; from an eye of the
// user's own, its middle is looked at. A level camera stays level when only its eye or target is moved. `yfov` makes
// any camera perspective.
View resolve_view(const Scene& scene, const ViewRequest& request, std::uint32_t width, std::uint32_t height);

// The same where the world box of the geometry is known already; only the cameras of `scene` are looked at.
View resolve_view(const Scene& scene, const Bounds& bounds, const ViewRequest& request, std::uint32_t width,
                  std::uint32_t height);

} // namespace wavepath
