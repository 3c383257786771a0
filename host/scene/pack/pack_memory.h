// Packs a scene in one pose after another: what did not change since the last one is taken over.
#pragma once

#include <cstdint>
#include <vector>

#include "host/scene/pack/geometry.h"
#include "host/scene/pack/kept_tree.h"
#include "host/scene/pack/packed_scene.h"
#include "host/scene/pack/packing.h"
#include "host/scene/scene.h"

namespace wavepath {

// What the scene packed last has taken over from the one before.
struct KeptParts {
  bool surfaces = false; // materials, textures and the environment
  bool geometry = false; // triangles, vertices and the tree
};

struct PackMemory {
  // The scene packed last: whoever packs again moves it here.
  PackedScene packed;
  bool is_still = false; // every vertex of the scene is where it was then

  // Told by pack_again(), beside KeptTrees::built.
  KeptParts kept;
  // Its own.
  bool has_packed = false;
  std::vector<std::uint32_t> material_index;
  std::vector<bool> material_used;
  std::vector<Object> objects;
  std::vector<std::uint32_t> object_of;
  std::vector<glm::dvec3> near;
  KeptTrees trees;
  double environment = 0.0; // integral of its luminance
};

// As pack(). `memory`: of the same scene in another pose, packed by the same `packing` but for `near`, or new. The
// result is that of pack(), but for the shape of trees and with it the order of triangles.
PackedScene pack_again(Scene& scene, const Packing& packing, PackMemory& memory);

} // namespace wavepath
