#include "host/scene/scene_hash.h"

#include "host/base/hash.h"
#include "host/base/member_count.h"

namespace wavepath {
namespace {

// Fields are named by structured bindings, so that a struct with a new one does not compile until it is dealt with
// here. Material and TextureSlot have tables of their own, which are counted instead.
consteval std::size_t material_row_count() {
  std::size_t count = 0;
  visit_material_fields([&](const auto&) { ++count; });
  return count;
}
static_assert(member_count<Material>() == 1 + material_row_count(), // the name has none
              "a field of Material has no row in material.h");

consteval std::size_t slot_property_count() {
  std::size_t count = 0;
  TextureSlot slot;
  visit_texture_slot(slot, [&](const auto&) { ++count; });
  return count;
}
static_assert(member_count<TextureSlot>() == slot_property_count(), "visit_texture_slot() misses a property");

void add(Hash& hash, const TextureSlot& slot) {
  visit_texture_slot(slot, [&](const auto& property) { hash.add(property); });
}

template <class T>
void add(Hash& hash, const T& value) {
  hash.add(value);
}

void add(Hash& hash, const Material& material) {
  visit_material_fields([&](const auto& row) { add(hash, material.*row.field); });
}

void add(Hash& hash, const Image& image) {
  const auto& [name, width, height, bytes, floats] = image;
  hash.add(width);
  hash.add(height);
  hash.add_all(bytes);
  hash.add_all(floats);
}

void add(Hash& hash, const Primitive& primitive) {
  const auto& [first_index, index_count, material, has_normals] = primitive;
  hash.add(first_index);
  hash.add(index_count);
  hash.add(material);
  hash.add(has_normals);
}

void add(Hash& hash, const Mesh& mesh) {
  const auto& [name, positions, normals, tangents, layer_tangents, uvs, colors, indices, primitives, content,
               end_positions, end_normals, end_tangents, end_layer_tangents] =
      mesh; // content: a number of this process
  hash.add_all(positions);
  hash.add_all(normals);
  hash.add_all(tangents);
  for (const auto& layer : layer_tangents) hash.add_all(layer);
  for (const auto& set : uvs) hash.add_all(set);
  hash.add_all(colors);
  hash.add_all(indices);
  hash.add(primitives.size());
  for (const Primitive& primitive : primitives) add(hash, primitive);
  hash.add_all(end_positions);
  hash.add_all(end_normals);
  hash.add_all(end_tangents);
  for (const auto& layer : end_layer_tangents) hash.add_all(layer);
}

void add(Hash& hash, const Instance& instance) {
  const auto& [mesh, world_from_object, node] = instance; // node: a name of it
  hash.add(mesh);
  hash.add(world_from_object);
}

void add(Hash& hash, const PunctualLight& light) {
  const auto& [name, kind, intensity, position, direction, inner_cone, outer_cone, range, extent, node, profile,
               tangent] = light;
  hash.add(kind);
  hash.add(intensity);
  hash.add(position);
  hash.add(direction);
  hash.add(inner_cone);
  hash.add(outer_cone);
  hash.add(range);
  if (extent > 0.0) hash.add(extent);
  if (profile == kNoIndex) return;
  hash.add(profile);
  hash.add(tangent);
}

void add(Hash& hash, const LightProfile& profile) {
  const auto& [name, vertical, horizontal, intensities] = profile;
  hash.add_all(vertical);
  hash.add_all(horizontal);
  hash.add_all(intensities);
}

void add(Hash& hash, const Environment& environment) {
  const auto& [radiance, width, height, map, rotation] = environment;
  hash.add(radiance);
  hash.add(width);
  hash.add(height);
  hash.add_all(map);
  hash.add(rotation);
}

void add(Hash& hash, const VoxelGrid& grid) {
  hash.add(grid.first);
  hash.add(grid.brick_counts);
  hash.add_all(grid.bricks);
  hash.add_all(grid.constants);
  hash.add_all(grid.voxels);
  hash.add(grid.grid_from_index);
}

void add(Hash& hash, const Volume& volume) {
  const auto& [grids, world_from_grid, scattering, absorption, anisotropy, emission, scale, offset] = volume;
  add(hash, grids->density);
  if (grids->temperature) add(hash, *grids->temperature);
  hash.add(world_from_grid);
  hash.add(scattering);
  hash.add(absorption);
  for (const float number : {anisotropy, emission, scale, offset}) hash.add(number);
}

template <class T>
void add_each(Hash& hash, const std::vector<T>& values) {
  hash.add(values.size());
  for (const T& value : values) add(hash, value);
}

} // namespace

std::uint64_t hash_scene(const Scene& scene) {
  // The camera is not part of it: the caller has chosen a view. Names and warnings change no picture.
  const auto& [path, files, images, materials, meshes, instances, node_names, node_parents, cameras, lights, profiles,
               environment, volume, first_catcher, end_catcher, extensions_used, variants, warnings] = scene;
  Hash hash;
  add_each(hash, images);
  add_each(hash, materials);
  add_each(hash, meshes);
  add_each(hash, instances);
  add_each(hash, lights);
  add(hash, environment);
  for (const LightProfile& profile : profiles) add(hash, profile);
  if (volume) add(hash, *volume);
  if (end_catcher > first_catcher) {
    hash.add(first_catcher);
    hash.add(end_catcher);
  }
  return hash.value();
}

} // namespace wavepath
