// Maps of photons: in which scenes there are any, how many samples share one, and how far from a point it finds
// photons.
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

// Surfaces with a lobe of one direction: smooth metal, smooth glass, what is coated.
struct DeltaSurfaces {
  double area = 0.0;
  glm::dvec3 centre{0.0}; // device world
};
DeltaSurfaces find_delta_surfaces(const PackedScene& scene);

// Whether settings ask for photons, wherever a scene has use for them.
bool asks_for_photons(const RenderPlan& settings);
// Whether a scene of these kFeature bits may have use for them: what is found before it is packed.
bool may_have_photons(const RenderPlan& settings, const ScenePlan& scene, gpu::Feature features);

// Samples in blocks of a power of two share a map for each replicate, so that as many light paths are traced for
// photons as there are samples, but not above a bound. All of it is a function of the picture's size.
struct PhotonPlan {
  std::uint32_t block = 0;      // samples
  std::uint32_t path_count = 0; // of a replicate
  std::uint32_t cell_count = 0;

  std::uint32_t photons() const { return gpu::kReplicates * path_count; }
  std::uint64_t bytes() const;
};
PhotonPlan plan_photons(std::uint64_t pixels);

// The radius of the first pass over all pixels, and of a later block: as Knaus and Zwicker (2011) shrink it, a function
// of the samples alone, so that ranges of samples that are rendered apart join to the same picture.
float first_radius(const gpu::Frame& frame, const DeltaSurfaces& surfaces);
float radius_of_block(float first, const PhotonPlan& plan, std::uint32_t block);

gpu::PhotonFrame photon_frame(const PhotonPlan& plan, float radius);

} // namespace wavepath
