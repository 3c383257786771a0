// A packed scene on the device: the only place where host arrays become device buffers.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "host/gpu/acceleration.h"
#include "host/gpu/kernel.h"
#include "host/scene/pack/pack.h"
#include "host/scene/pack/pack_memory.h"

namespace wavepath {

// Images of the two atlases: that of values and that of colours.
using AtlasImages = std::array<std::unique_ptr<DeviceImage>, 2>;
// Uploads the atlases. An empty atlas becomes a small image, since every declared binding must be bound.
AtlasImages upload_atlases(Device& device, const Atlases& atlases);
// Bindings of kernels with kFeatureSampledTextures, besides DeviceScene::bindings(). Null images give the layout alone.
std::vector<Binding> atlas_bindings(const AtlasImages& images);

// Bindings of kernels with kFeatureVoxels, besides DeviceScene::bindings(). Null buffers give the layout alone.
std::vector<Binding> volume_bindings(const Buffer* volume, const Buffer* grid, const Buffer* voxels);

struct DeviceScene {
  Buffer nodes; // BVH nodes; for ray queries, QueryScene::items
  Buffer triangles, triangle_vertices, vertex_normals, vertex_uvs, vertex_colors, instances;
  Buffer materials, textures, srgb_table, lights, light_tree, environment, environment_ends;
  Buffer volume, volume_grid, voxels;     // see PackedVoxels; empty without a volume
  std::optional<QueryStructures> queries; // structures for ray queries; empty: kernels traverse `nodes`
  std::vector<Buffer> texels;             // pages of 1 << gpu::kTexelPageShift words; at least one page
  AtlasImages atlases;                    // null unless the device's samplers look textures up

  std::vector<Binding> bindings() const;
  std::uint64_t bvh_bytes() const; // bytes of nodes, triangles and instances
  std::uint64_t other_bytes() const;
};

// Uploads a scene. `by_query`: for kernels that trace rays by ray queries. Throws Error before allocating anything if
// the device's limits or memory cannot hold the scene. The size of structures for ray queries is known to the driver
// alone, so they may throw later.
DeviceScene upload_scene(Device& device, const PackedScene& scene, bool by_query = false);

// The same of a scene that was packed again. `before`: the one packed before, of which `kept` was taken over; those
// parts go over on the device as well, and nothing is left of it.
DeviceScene upload_next_scene(Device& device, const PackedScene& scene, bool by_query, DeviceScene before,
                              const KeptParts& kept);

} // namespace wavepath
