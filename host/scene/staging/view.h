// The camera of a picture: a glTF camera, one given on the command line, or one that frames the scene.
#pragma once

#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>

#include <glm/glm.hpp>

#include "host/scene/scene.h"
#include "host/scene/staging/framing.h"

namespace wavepath {

enum class Projection : std::uint8_t { perspective, orthographic, fisheye, equirectangular };
inline constexpr std::string_view kProjectionNames[] = {"perspective", "orthographic", "fisheye", "equirectangular"};

// Cameras whose picture shows angles: an equidistant fisheye, or all directions.
enum class Panorama : std::uint8_t { none, fisheye, sphere };

struct Clip {
  double near = 0.0, far = std::numeric_limits<double>::infinity(); // metres

  friend bool operator==(const Clip&, const Clip&) = default;
};

// A resolved camera, in world space. The ray through image position (x, y) in [-1,1], y upwards. Perspective: from
// position in direction forward + x*right + y*up. Orthographic: from position + x*right + y*up in direction forward.
// kernels/base/camera_model.glsl has the others.
struct View {
  bool orthographic = false;
  glm::dvec3 position{0.0};
  glm::dvec3 forward{0.0, 0.0, -1.0}; // unit length
  glm::dvec3 right{1.0, 0.0, 0.0}; // half extent of the image at unit distance; orthographic: metres; panorama: radians
  glm::dvec3 up{0.0, 1.0, 0.0};
  Panorama panorama = Panorama::none;    // without `orthographic`
  glm::dvec2 shift{0.0};                 // added to x and y; neither orthographic nor of a sphere
  double angle_limit = std::numbers::pi; // from the axis of a fisheye up to which it sees anything
  Clip clip{};                           // what camera rays see: along the view axis, in a panorama from the eye
  double eye_distance = 0.0;             // of a stereo pair, each eye with half of the picture; 0 = one eye
  // Velocity of the eye in world space, in units of the speed of light. The fields above are then those of the camera's
  // own space, as if it had just come to rest. Neither orthographic nor of a stereo pair.
  glm::dvec3 velocity{0.0};
};

constexpr double kMostSpeed = 0.999999; // whose radiance straight ahead is 1414^5 times that at rest

// Whether the kernels of this camera need kFeatureCameraModel.
bool has_camera_model(const View& view);

// True if a picture of this camera can be rasterized: one eye at rest, and a plane, shifted or clipped or not.
bool is_rasterizable(const View& view);

// The ray through a position in the picture, from the middle between the eyes; `direction` of any length. False where
// the camera sees nothing.
bool ray_through(const View& view, const glm::dvec2& position, glm::dvec3& origin, glm::dvec3& direction);

// Where that camera shows a point: in [-1,1] of the picture if it is not outside of it, y upwards. `point`: in world
// space, with w = 1; w = 0 for one at infinity, in this direction. `eye`: -1 left, 1 right, each with a picture of its
// own; 0 = the only one. False where it shows the point nowhere: behind a perspective or orthographic camera, within
// the circle of a sphere's eyes. Clip planes cut nothing here.
bool project(const View& view, const glm::dvec4& point, int eye, glm::dvec2& position);

// Whether the left eye's picture stands above the right one's, not to the left of it.
bool stacks_eyes(Panorama panorama);

// Pixels of focal lengths and principal point; the top left corner of the picture is 0, 0.
struct Intrinsics {
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;
};

// The matrix K of a picture of this size, of either eye; nothing for a sphere. Pixels a radian for a fisheye, pixels a
// metre for parallel rays.
std::optional<Intrinsics> intrinsics_of(const View& view, std::uint32_t width, std::uint32_t height);

// Angles in radians that the picture of an eye shows across and down; nothing for parallel rays.
std::optional<glm::dvec2> angles_of(const View& view);

// The flags of a camera; values not given come from the chosen camera.
struct ViewRequest {
  std::string camera{}; // name or index; empty = the first
  std::optional<glm::dvec3> eye{}, look_at{}, up{};
  std::optional<double> yfov{}; // radians
  std::optional<Projection> projection{};
  std::optional<double> fov{};  // radians, of a fisheye across the smaller side
  std::optional<double> ymag{}; // half height in metres, orthographic
  std::optional<glm::dvec2> shift{};
  std::optional<Intrinsics> intrinsics{};
  std::optional<Clip> clip{};
  bool clips_as_file = false; // by the chosen camera's znear and zfar
  double stereo = 0.0;        // metres between the eyes; 0 = one eye
  glm::dvec3 velocity{0.0};   // as View has it
};

// Throws UsageError where the flags do not go together.
void check_view(const ViewRequest& request);

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

// True if the view depends on the framing: on where the camera stands, or on how far the middle of the scene is.
bool is_framed(const Scene& scene, const ViewRequest& request);
bool needs_framing(const Scene& scene, const ViewRequest& request);

} // namespace wavepath
