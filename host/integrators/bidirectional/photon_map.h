// Photon maps: the scenes that need them, the number of samples that use one map, and its search radius.
#pragma once

#include <cstdint>

#include <glm/glm.hpp>

#include "kernels/base/features.h"
#include "kernels/base/frame_types.h"
#include "kernels/bidirectional/photon_types.h"

namespace wavepath {

struct PackedScene;
struct ScenePlan;
struct RenderPlan;

// Surfaces with a delta lobe: smooth metal, smooth glass, coated surfaces.
struct DeltaSurfaces {
  double area = 0.0;
  glm::dvec3 centre{0.0}; // in the device's world space
};
DeltaSurfaces find_delta_surfaces(const PackedScene& scene);

// True if the settings use photons in scenes that need them.
bool asks_for_photons(const RenderPlan& settings);
// True if such a scene may need photons, as far as can be told before it is packed. `features`: kFeature bits.
bool may_have_photons(const RenderPlan& settings, const ScenePlan& scene, gpu::Feature features);

// Plan of the photon maps. A block of samples, a power of two, has one map for each replicate, so that there are as
// many light paths for photons as samples, up to a limit. It depends on the size of the picture alone.
struct PhotonPlan {
  std::uint32_t block = 0;      // samples
  std::uint32_t path_count = 0; // light paths of each replicate
  std::uint32_t cell_count = 0;

  std::uint32_t photons() const { return gpu::kReplicates * path_count; }
  std::uint64_t bytes() const;
};
PhotonPlan plan_photons(std::uint64_t pixels);

// Search radius in metres of the first block, and of a later one. It shrinks as Knaus and Zwicker (2011) do, as a
// function of samples alone, so that ranges of samples that are rendered apart join to the same picture.
float first_radius(const gpu::Frame& frame, const DeltaSurfaces& surfaces);
float radius_of_block(float first, const PhotonPlan& plan, std::uint32_t block);

gpu::PhotonFrame photon_frame(const PhotonPlan& plan, float radius);

} // namespace wavepath
