// Finds the point that a position of the picture shows, by the BVH on the host: for the point under the pointer, and
// for the focus.
#pragma once

#include <optional>

#include <glm/glm.hpp>

#include "host/scene/pack/packed_scene.h"
#include "host/scene/staging/view.h"
#include "kernels/base/frame_types.h"

namespace wavepath {

struct PickedSurface {
  glm::dvec3 point;      // in world space
  gpu::Hit hit;          // without barycentric weights; for node_of() and material_of()
  double distance = 0.0; // from the camera ray's origin, metres
};

// The first hit of the camera ray through `position`, in world space. `position`: from the picture's top left
// corner, in pixels; `size`: of the picture. Counts every triangle as a whole, cut-outs in its texture included.
// `passes_backs`: single-sided triangles are not there from behind.
std::optional<glm::dvec3> pick(const PackedScene& scene, const View& view, const glm::dvec2& pixel,
                               const glm::dvec2& size, bool passes_backs = true);

// The same with the surface that is there.
std::optional<PickedSurface> pick_surface(const PackedScene& scene, const View& view, const glm::dvec2& pixel,
                                          const glm::dvec2& size, bool passes_backs = true);

// Depth of a point along the view axis; not positive behind the camera.
double depth_of(const View& view, const glm::dvec3& point);

// The depth of what the middle of the picture shows; of the middle of the scene where that is nothing.
double depth_of_middle(const PackedScene& scene, const View& view, bool passes_backs = true);

} // namespace wavepath
