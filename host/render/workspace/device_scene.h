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

namespace wavepath {

// Of values and of colours, in images.
using AtlasImages = std::array<std::unique_ptr<DeviceImage>, 2>;
// An atlas that is empty becomes a small image, since every declared binding has to be bound.
AtlasImages upload_atlases(Device& device, const Atlases& atlases);
// Of kernels with kFeatureSampledTextures, besides DeviceScene::bindings(). Null images: the layout alone.
std::vector<Binding> atlas_bindings(const AtlasImages& images);

struct DeviceScene {
  Buffer nodes; // for ray queries, QueryScene::items
  Buffer triangles, triangle_vertices, vertex_normals, vertex_uvs, vertex_colors, instances;
  Buffer materials, textures, srgb_table, lights, light_tree, environment, environment_ends;
  std::optional<QueryStructures> queries; // that kernels trace rays through in place of the nodes
  std::vector<Buffer> texels;             // pages of 1 << gpu::kTexelPageShift words, at least one
  AtlasImages atlases;                    // null unless samplers look textures up

  std::vector<Binding> bindings() const;
  std::uint64_t bvh_bytes() const; // nodes, triangles and instances
  std::uint64_t other_bytes() const;
};

// `by_query`: for kernels that trace rays by ray queries. Throws Error before allocating anything if the device's
// limits or memory cannot hold it, but for the structures of ray queries, whose size only the driver knows.
DeviceScene upload_scene(Device& device, const PackedScene& scene, bool by_query = false);

} // namespace wavepath
