// Shadow volumes of a scene: the triangles that are drawn of them for each light.
//
// Every triangle that casts, turned to face the light, has a volume of its own: the triangle, sides that lead away from
// the light, and its image at infinity. Sides that two triangles share in opposite directions cancel, whatever the mesh
// is (Kim et al. 2008), so that what is left stands on silhouettes and on the rims of open meshes. A point lies in as
// many volumes as triangles are between it and the light.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "host/integrators/hybrid/shadows/sources.h"

namespace wavepath {

// Pieces as kernels/hybrid/shadows/volume_types.h has them. The order of a cap's corners is that of its triangle, which
// its depths depend on to the bit; so those that face away from the light stand apart, and count the other way round.
struct VolumePieces {
  std::vector<glm::uvec2> outwards, inwards; // by the direction that they face
};

// The casters of a scene, corners at the same position welded.
class VolumeCasters {
public:
  // `culls_backs`: single-sided triangles cast only where their front faces the light.
  VolumeCasters(const PackedScene& scene, bool culls_backs);

  // Without caps there are sides alone.
  VolumePieces pieces(const ShadowSource& source, bool caps) const;
  // A triangle of the scene on a rim: with an edge that the others, as they face, do not have in the other direction.
  // Null if all is closed.
  const gpu::Triangle* open_triangle() const;

private:
  struct Caster {
    std::uint32_t triangle, instance;
    glm::dvec3 corner, normal; // device world; of no particular length
    std::uint32_t edges[3];    // edges between corners 0 and 1, 1 and 2, 2 and 0
    signed char directions[3]; // 1: as the edge, -1: the other
    bool lit_from_behind;      // true if light reaches it from behind
    bool flipped;              // its front is where the corners' order is clockwise
  };

  const PackedScene& scene_;
  std::vector<Caster> casters_;
  std::uint32_t edge_count_ = 0;
};

// Why volumes of closed meshes alone do not suit the scene; empty if they do.
std::string open_mesh(const PackedScene& scene);

} // namespace wavepath
