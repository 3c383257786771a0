// Motion of what a picture shows: where a point of a surface, with its triangle, is in another pose of the scene, and
// where the camera of another picture shows it.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "host/integrators/path/first_hits.h"
#include "host/scene/pack/packed_scene.h"
#include "host/scene/scene.h"
#include "host/scene/staging/view.h"

namespace wavepath {

// Positions of all surfaces of a scene at one moment; with a shutter, when it opens.
struct SurfacePose {
  std::vector<std::vector<glm::vec3>> positions; // by mesh
  std::vector<Instance> instances;
};

SurfacePose pose_of(const Scene& scene);

// The next or the previous picture of a film.
struct OtherPicture {
  View view;
  std::optional<SurfacePose> pose{};        // empty = surfaces are where they are
  std::vector<std::uint32_t> instance_of{}; // by instance of this picture's pose; kNoIndex where it has none
};

// What motion is told between. The scene of the picture is packed with Packing::sources if surfaces move.
struct MotionPictures {
  SurfacePose here;                                // empty if nothing but the camera moves
  std::vector<std::vector<std::uint32_t>> indices; // by mesh of `here`
  std::vector<std::uint32_t> instance_of;          // by mesh of `here`: the last instance that shows it
  std::optional<OtherPicture> next, previous;      // empty where that motion is not asked for
};

// Notes the pose of the picture itself. Instances of the other ones are found by their nodes.
void set_pose_here(const Scene& scene, MotionPictures& pictures);

// Motion of what is at the pixel's centre, in pixels to the right and down: from its place in the picture of `view` to
// that in the `other` one. What is at infinity moves by the turn of the camera alone. In a stereo pair each eye's
// picture stands alone; in one of all directions the shorter way counts. Not a number where the other camera shows the
// point nowhere, or the other pose has no such surface. `size`: of the picture.
glm::dvec2 motion_to(const OtherPicture& other, const MotionPictures& pictures, const PackedScene& scene,
                     const View& view, const glm::uvec2& size, const FirstHit& found);

} // namespace wavepath
