// Adaptive subdivision: patches are cut where light on a coarse mesh changes most (after Cohen, Greenberg, Immel,
// Brock, "An Efficient Radiosity Approach for Realistic Image Synthesis", CG&A 1986).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "host/integrators/radiosity/patch_mesh.h"
#include "host/integrators/radiosity/refinement.h"

namespace wavepath {

// The coarse mesh has 1 patch for so many of the final one.
inline constexpr std::uint32_t kCoarseShare = 4;

// Cuts patches of the tree until there are `count`. `corners`: irradiance of the coarse solution, three of a face.
void refine(PatchTree& tree, const PatchMesh& mesh, const std::vector<Face>& faces, std::span<const glm::vec4> corners,
            std::uint32_t count);

} // namespace wavepath
