// The camera of a picture: a glTF camera, one given on the command line, or one that frames the scene.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <glm/glm.hpp>

#include "host/scene/scene.h"
#include "host/scene/staging/framing.h"

namespace wavepath {

// A resolved camera, in world space. The ray through image position (x, y) in [-1,1], y upwards. Perspective: from
// position in direction forward + x*right + y*up. Orthographic: from position + x*right + y*up in direction forward.
struct View {
  bool orthographic = false;
  glm::dvec3 position{0.0};
  glm::dvec3 forward{0.0, 0.0, -1.0}; // unit length
  glm::dvec3 right{1.0, 0.0, 0.0};    // half extent of the image at unit distance; orthographic: in metres
  glm::dvec3 up{0.0, 1.0, 0.0};
};

// The flags --camera, --eye, --look-at, --up and --yfov; values not given come from the chosen camera.
struct ViewRequest {
  std::string camera{}; // name or index; empty = the first
  std::optional<glm::dvec3> eye{}, look_at{}, up{};
  std::optional<double> yfov{}; // radians
};

// Throws Error if the named camera does not exist or the request is degenerate. Nothing that a camera was authored to
// show is cropped: its vertical angle or height is kept in images as wide as its own or wider, its horizontal angle or
// width in narrower ones; a perspective camera without an aspect ratio fits any. With `yfov` that angle is the vertical
// one of every image. A scene without a camera is framed: an object is seen from the front and its right, and fills
// kFramedFraction of the image; in an interior the camera stands where find_standpoint() says. With --eye it looks at
// the middle of the scene's box. A level camera stays level when only its eye or target is moved. `yfov` makes any
// camera perspective.
View resolve_view(const Scene& scene, const ViewRequest& request, std::uint32_t width, std::uint32_t height);

// The same with what find_framing() found; reads only the cameras of `scene`.
View resolve_view(const Scene& scene, const Framing& framing, const ViewRequest& request, std::uint32_t width,
                  std::uint32_t height);

// True if the view depends on the framing.
bool is_framed(const Scene& scene, const ViewRequest& request);

} // namespace wavepath
