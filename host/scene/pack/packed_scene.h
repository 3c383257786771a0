// The arrays that the kernels read: geometry in BVH leaf order around an origin near the eye, lights with their
// intervals, texels, and the features that this scene needs.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "bvh/build.h"
#include "host/scene/material.h"
#include "host/scene/pack/atlas.h"
#include "host/scene/pack/volume.h"
#include "kernels/base/features.h"
#include "kernels/base/scene_types.h"

namespace wavepath {

// A feature or an array that this scene does not need.
struct LeftOut {
  std::string what, why;
  std::uint64_t bytes = 0;  // device memory that was saved
  gpu::Feature feature = 0; // kFeature bit of the code that was left out; 0 = data only
};

// A range of PackedScene::triangles, drawn once for each of a range of PackedScene::instances.
struct Draw {
  std::uint32_t first_triangle = 0, triangle_count = 0; // copies of spatial splits included
  std::uint32_t first_instance = 0, instance_count = 1; // 0 and 1 if the scene has no instances
};

// Triangles whose source ids are `first_id` or more, up to the next run, are shown by `node` of the file.
struct NodeRun {
  std::uint32_t first_id = 0, node = 0;
};

// A triangle of the scene: its corners are at `first_index` and the two after it in the mesh's index list.
struct SourceTriangle {
  std::uint32_t mesh = 0, first_index = 0;
};

// Triangles of MASK and BLEND surfaces whose images let rays through somewhere; copies and instances do not count.
struct AlphaCounts {
  // Triangles that rays must look up; opaque ones and holes, which they need not.
  std::uint64_t asked = 0, opaque = 0, holes = 0;

  std::uint64_t total() const { return asked + opaque + holes; }
  AlphaCounts& operator+=(const AlphaCounts& other) {
    asked += other.asked, opaque += other.opaque, holes += other.holes;
    return *this;
  }
};

// Triangles that were cut because they are huge beside their distance to the eye, see cut.h; instances do not count.
struct CutCounts {
  std::uint64_t triangles = 0, pieces = 0;
  bool coarse = false; // see Cut
};

struct PackedScene {
  glm::dvec3 origin{0.0}; // world position of the device's origin
  double radius = 0.0;    // radius of the geometry's bounding sphere, metres
  glm::vec3 centre{0.0f}; // centre of that sphere, in the device's world space

  std::vector<bvh::WideNode> nodes;
  std::uint32_t root = 0; // node
  bool root_is_top = false;
  std::uint32_t stack_size = 0; // an upper bound on the traversal stack's entries
  std::vector<gpu::Triangle> triangles;
  // Displacements of the corners of each triangle while the shutter is open; empty if nothing moves.
  std::vector<gpu::Triangle> motions;
  std::vector<gpu::Instance> instances; // empty unless root_is_top
  std::vector<Draw> draws;              // together they draw every visible triangle

  // Empty if no surface of the scene needs them (see the kFeature bits).
  std::vector<glm::uvec4> triangle_vertices; // also present if triangles were cut
  std::vector<glm::vec4> vertex_normals, vertex_uvs, vertex_colors;
  // Offset in vertices from a normal to the layers' own tangents of its vertex; 0 = there are none.
  std::uint32_t layer_tangents = 0;
  // Index in vertex_normals of the normals at the time when the shutter closes, if the scene moves.
  std::uint32_t end_normals = 0;

  std::vector<gpu::Material> materials;
  // By material, and the albedo tables that they refer to; empty where no lobe (kLobe bits) is in use.
  std::vector<gpu::MaterialLayers> layers;
  std::vector<glm::vec4> albedo_tables;
  std::vector<std::string> material_names;          // for messages
  std::uint32_t first_catcher = 0, end_catcher = 0; // materials of the shadow catcher: first <= m < end
  // Which node of the file shows what, for node_of(): of meshes that are shown once by triangle, of the others by
  // gpu::Instance::id. kNoIndex: no node does.
  std::vector<NodeRun> node_runs;
  std::vector<std::uint32_t> instance_nodes;
  std::uint32_t once_instance = kNoIndex; // Instance::id of the meshes that are shown once
  // By triangle, if Packing::sources asks; and by gpu::Instance::id its index in Scene::instances, kNoIndex for
  // once_instance.
  std::vector<SourceTriangle> sources;
  std::vector<std::uint32_t> instance_sources;
  std::vector<std::string> node_names; // by node of the file; empty where it has no name
  std::vector<gpu::Texture> textures;
  std::vector<std::uint32_t> texels; // texels that kernels look up themselves
  Atlases atlases;                   // texels that the device's samplers look up

  std::vector<gpu::Light> lights; // lights that next-event estimation samples, the environment included
  // By punctual light of `lights`: its index among those of the scene.
  std::vector<std::uint32_t> lamp_sources;
  // Table of groups of lights, as kernels read it (kBindGroupTable); empty unless the packing asks for groups.
  std::vector<std::uint32_t> light_groups;
  // Parts of light triangles that are cut: see kernels/light/light_sampling.glsl.
  std::vector<std::uint32_t> light_parts;
  std::uint32_t local_light_count = 0; // number of lights with a location, which come first
  // Result of light_tree_words(): the light tree, and branches and clusters of lights; empty if lights are picked by
  // power.
  std::vector<glm::uvec4> light_tree;
  std::uint32_t light_tree_depth = 0;
  double light_locations = 0.0;  // estimated number of cells that contain lights, see lights.h
  double typical_radiance = 0.0; // radiance that all lights together bring to a surface, by order of magnitude
  glm::vec3 environment_radiance{0.0f};
  float environment_probability = 0.0f;
  double environment_rotation = 0.0;
  std::uint32_t environment_width = 0, environment_height = 0;
  std::vector<glm::vec4> environment; // radiance, probability of the texel
  // Intervals of the rows, then of the columns of each; their cuts in the same order (see intervals.h).
  std::vector<std::uint32_t> environment_ends;

  std::shared_ptr<const PackedVoxels> voxels; // null without a volume
  gpu::VolumeFrame volume{};

  gpu::Feature features = 0; // kFeature and kLobe bits
  std::vector<LeftOut> left_out;
  std::uint64_t triangle_count = 0;    // triangles of the scene, in all instances
  std::uint64_t dropped_triangles = 0; // non-finite or degenerate
  AlphaCounts alpha;
  CutCounts cut;
  double bvh_seconds = 0.0;
  bvh::Quality bvh_quality = bvh::Quality::fast;
  std::uint64_t triangles_stored = 0; // pieces included, without the copies of spatial splits
  double sah_cost = 0.0;              // of the tree over the most triangles, see bvh::Measure

  bool moves() const { return !motions.empty(); }
  // Triangle::id of the scene's triangle from which an item was made.
  std::uint32_t source_id(std::uint32_t item) const {
    const std::uint32_t id = triangles[item].id;
    return id & gpu::kPieceId ? triangle_vertices[item].w : id;
  }
};

} // namespace wavepath
