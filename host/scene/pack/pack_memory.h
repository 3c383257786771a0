// Packs a scene in one pose after another: what did not change since the last one is taken over.
#pragma once

#include <cstdint>
#include <vector>

#include "host/scene/pack/geometry.h"
#include "host/scene/pack/kept_tree.h"
#include "host/scene/pack/packed_scene.h"
#include "host/scene/pack/packing.h"
#include "host/scene/pack/textures.h"
#include "host/scene/scene.h"

namespace wavepath {

struct ArrayRange {
  std::size_t first = 0, count = 0;
};

// What the scene packed last has taken over from the one before.
struct KeptParts {
  bool textures = false;
  bool environment = false;
  bool surfaces = false; // materials, textures and the environment
  bool geometry = false; // triangles, vertices and the tree, but for what follows
  // The same, but for the nodes, instances, and these triangles and vertices, which are elsewhere.
  bool places = false;
  ArrayRange moved_triangles;
  std::vector<ArrayRange> moved_vertices; // of normals
  bool marks = false;                     // in triangles and instances, which lights they are
  bool lights = false;
  bool voxels = false;
};

// What of a material decides about triangles: which of them are packed, how rays meet them, which vertices they have.
struct ShapeTraits {
  std::uint32_t flags = 0; // by its numbers
  AlphaMode alpha_mode = AlphaMode::opaque;
  float alpha = 1.0f, alpha_cutoff = 0.0f; // as far as they matter
  std::vector<TextureSlot> textures;       // kNoIndex for the image of those whose place alone matters

  bool operator==(const ShapeTraits&) const = default;
};
ShapeTraits shape_traits(const Material& material);

// An instance of a mesh.
struct ShownMesh {
  std::uint32_t mesh = 0, node = kNoIndex;
  std::uint64_t content = 0; // of the mesh
  glm::dmat4 world_from_object{1.0};
};

struct PackMemory {
  // The scene packed last: whoever packs again moves it here.
  PackedScene packed;
  bool is_still = false; // every vertex of the scene is where it was then
  // What of the scene is another since then.
  bool other_materials = false, other_images = false, other_environment = false;
  bool keeps_trees = true; // for other poses

  // Told by pack_again(), beside KeptTrees::built.
  KeptParts kept;
  // Its own.
  bool has_packed = false;
  std::vector<std::uint32_t> material_index;
  std::vector<bool> material_used;
  Packing packing;
  std::vector<ShapeTraits> traits; // by material
  std::vector<Material> materials; // that they are of
  TextureTable textures;
  std::vector<PunctualLight> lights;
  bool shone = false; // some material did
  std::vector<Object> objects;
  KeptObject once;              // of the meshes that are shown once
  std::vector<ShownMesh> shown; // by instance
  std::size_t repaired_uvs = 0; // see pack_vertices()
  std::vector<std::uint32_t> object_of;
  std::vector<glm::dvec3> near;
  KeptTrees trees;
  double environment = 0.0; // integral of its luminance
};

// As pack(). `memory`: of the same scene in another pose or with other materials, images or environment, or new. The
// result is that of pack(), but for the shape of trees and with it the order of triangles.
PackedScene pack_again(Scene& scene, const Packing& packing, PackMemory& memory);

} // namespace wavepath
