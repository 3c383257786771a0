// Runs the stages of packing in their order; see pack.h.
#include "host/scene/pack/pack.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <tbb/parallel_for.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/base/clock.h"
#include "host/base/error.h"
#include "host/scene/bounds.h"
#include "host/scene/pack/albedo_tables.h"
#include "host/scene/pack/bodies.h"
#include "host/scene/pack/cut_scene.h"
#include "host/scene/pack/environment_light.h"
#include "host/scene/pack/features.h"
#include "host/scene/pack/geometry.h"
#include "host/scene/pack/instances.h"
#include "host/scene/pack/light_groups.h"
#include "host/scene/pack/lights.h"
#include "host/scene/pack/materials.h"
#include "host/scene/pack/pack_memory.h"
#include "host/scene/pack/vertices.h"

namespace wavepath {
namespace {

constexpr const char* kDropped = "triangles without area or with coordinates that are not finite were dropped";
constexpr const char* kRepaired = "texture coordinates that are not finite were set to zero";

// Tables that the stages of packing geometry share.
struct Layout {
  Usage usage;
  std::optional<AlphaCoverage> alpha;        // once triangles are packed
  std::vector<std::uint32_t> material_index; // by scene material
  bool with_vertices = false;                // triangles refer to vertex streams
  bool with_sources = false;                 // see Packing
  bvh::Quality quality = bvh::Quality::fast;
  std::vector<glm::dvec3> near; // see Packing, world space
  std::vector<CutVertex> cut_vertices;
  PackMemory* memory = nullptr;
  std::size_t objects = 0; // packed so far

  explicit Layout(const Scene& scene) : usage(find_usage(scene)) {}
};

void list_parts(const Scene& scene, const Layout& layout, std::uint32_t mesh_index,
                const glm::dmat4& device_from_object, std::vector<Part>& parts) {
  const Mesh& mesh = scene.meshes[mesh_index];
  const std::vector<std::uint32_t> flags =
      layout.alpha ? triangle_flags(scene, mesh, *layout.alpha) : std::vector<std::uint32_t>(mesh.primitives.size());
  const bool mirrored = glm::determinant(glm::dmat3(device_from_object)) < 0.0;
  for (std::uint32_t p = 0; p < mesh.primitives.size(); ++p) {
    if (mesh.primitives[p].index_count < 3) continue;
    parts.push_back({mesh_index, p, flags[p] | layout.material_index[mesh.primitives[p].material],
                     layout.usage.first_vertex[mesh_index], device_from_object, mirrored});
  }
}

// `near`: in the space of the parts. `times`: instances of the object.
Object pack_parts(const Scene& scene, Layout& layout, const std::vector<Part>& parts, std::span<const glm::dvec3> near,
                  std::uint64_t times, KeptObject* kept, PackedScene& packed) {
  const PlacedCut cut{cut_huge(scene, parts, near), static_cast<std::uint32_t>(packed.cut.pieces),
                      static_cast<std::uint32_t>(layout.usage.vertex_count)};
  packed.cut.triangles += cut.cut.triangles.size();
  packed.cut.pieces += cut.cut.pieces.size();
  packed.cut.coarse |= cut.cut.coarse;
  if (!cut.cut.empty() && !layout.with_vertices) {
    layout.with_vertices = true;
    packed.triangle_vertices.resize(packed.triangles.size(), glm::uvec4(0));
  }
  list_cut_vertices(scene, parts, cut.cut, layout.cut_vertices);
  return append_object(scene, parts, cut, *layout.alpha, layout.with_vertices, layout.with_sources, times,
                       layout.quality, layout.memory && layout.memory->keeps_trees ? &layout.memory->trees : nullptr,
                       layout.objects++, kept, packed);
}

// Of meshes that are shown once.
std::vector<Part> list_static_parts(const Scene& scene, const Layout& layout, const glm::dmat4& device_from_world) {
  std::vector<Part> parts;
  for (const Instance& instance : scene.instances) {
    if (layout.usage.mesh_instances[instance.mesh] != 1) continue;
    const std::size_t first = parts.size();
    list_parts(scene, layout, instance.mesh, device_from_world * instance.world_from_object, parts);
    for (std::size_t p = first; p < parts.size(); ++p) parts[p].node = instance.node;
  }
  return parts;
}

std::vector<glm::dvec3> near_in_device(const Layout& layout, const PackedScene& packed) {
  std::vector<glm::dvec3> near;
  for (const glm::dvec3& p : layout.near) near.push_back(p - packed.origin);
  return near;
}

// Meshes that are shown once, baked into one object around the origin; without triangles if all of them are shared.
Object pack_static(const Scene& scene, Layout& layout, const glm::dmat4& device_from_world, PackedScene& packed) {
  const std::vector<Part> parts = list_static_parts(scene, layout, device_from_world);
  KeptObject* kept = layout.memory ? &layout.memory->once : nullptr;
  if (kept) *kept = {};
  if (parts.empty() && layout.usage.two_level()) return {};
  Object object = pack_parts(scene, layout, parts, near_in_device(layout, packed), 1, kept, packed);
  for (const PartRun& run : object.part_runs)
    if (packed.node_runs.empty() || packed.node_runs.back().node != parts[run.part].node)
      packed.node_runs.push_back({run.first_id, parts[run.part].node});
  return object;
}

// Whether any triangle would be cut.
bool has_huge(const Scene& scene, const Layout& layout, const glm::dmat4& device_from_world,
              const PackedScene& packed) {
  if (!cut_huge(scene, list_static_parts(scene, layout, device_from_world), near_in_device(layout, packed)).empty())
    return true;
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    if (layout.usage.mesh_instances[m] < 2) continue;
    std::vector<Part> parts;
    list_parts(scene, layout, m, glm::dmat4(1.0), parts);
    if (!cut_huge(scene, parts, near_instances(scene, m, layout.near)).empty()) return true;
  }
  return false;
}

// True if materials show the triangles that were packed last as they do now, around the same origin. `traits`: of them.
bool has_same_look(const Layout& layout, const std::vector<ShapeTraits>& traits, const PackedScene& packed) {
  const PackMemory& before = *layout.memory;
  if (before.packed.origin != packed.origin || before.packed.moves()) return false;
  if (before.packing.quality != layout.quality || before.traits != traits) return false;
  if (layout.with_sources && !before.packing.sources) return false;
  // Rays look alpha up, of which there may be another.
  const auto asks = [](const ShapeTraits& one) { return one.alpha_mode != AlphaMode::opaque; };
  return !(before.other_images && std::ranges::any_of(traits, asks));
}

// True if the geometry that was packed last is that of this scene.
bool has_same_geometry(const Scene& scene, const Layout& layout, const glm::dmat4& device_from_world,
                       const PackedScene& packed) {
  const PackMemory& before = *layout.memory;
  if (!before.is_still) return false;
  if (before.near == layout.near) return true;
  return before.packed.cut.triangles == 0 && !has_huge(scene, layout, device_from_world, packed);
}

std::vector<ShownMesh> list_shown(const Scene& scene) {
  std::vector<ShownMesh> shown;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    shown.push_back({instance.mesh, instance.node, mesh.moves() ? 0 : mesh.content, instance.world_from_object});
  }
  return shown;
}

// True if the scene shows the meshes that were packed last, maybe elsewhere, and none of them is cut.
bool has_same_meshes(const Scene& scene, const Layout& layout, const glm::dmat4& device_from_world,
                     const PackedScene& packed) {
  const PackMemory& before = *layout.memory;
  const auto same = [](const ShownMesh& a, const ShownMesh& b) {
    return a.content != 0 && a.mesh == b.mesh && a.node == b.node && a.content == b.content;
  };
  return std::ranges::equal(before.shown, list_shown(scene), same) && before.packed.cut.triangles == 0 &&
         !has_huge(scene, layout, device_from_world, packed);
}

bool any_shines(const Scene& scene, const Usage& usage) {
  for (std::size_t m = 0; m < scene.materials.size(); ++m)
    if (usage.material_used[m] && !scene.materials[m].unlit && scene.materials[m].emission != glm::vec3(0.0f))
      return true;
  return false;
}

// Which lights triangles are, in their order, and those of instances.
std::vector<std::uint32_t> light_marks(const PackedScene& packed) {
  std::vector<std::uint32_t> marks;
  marks.reserve(packed.triangles.size() + packed.instances.size());
  for (const gpu::Triangle& triangle : packed.triangles) marks.push_back(triangle.light);
  for (const gpu::Instance& instance : packed.instances) marks.push_back(instance.first_light);
  return marks;
}

void take_materials(PackMemory& memory, PackedScene& packed) {
  PackedScene& before = memory.packed;
  packed.materials = std::move(before.materials);
  packed.material_names = std::move(before.material_names);
  packed.layers = std::move(before.layers);
  packed.albedo_tables = std::move(before.albedo_tables);
}

void take_textures(PackMemory& memory, PackedScene& packed) {
  PackedScene& before = memory.packed;
  packed.textures = std::move(before.textures);
  packed.texels = std::move(before.texels);
  packed.atlases = std::move(before.atlases);
}

void take_environment(PackMemory& memory, PackedScene& packed) {
  PackedScene& before = memory.packed;
  packed.environment_radiance = before.environment_radiance;
  packed.environment_rotation = before.environment_rotation;
  packed.environment_width = before.environment_width;
  packed.environment_height = before.environment_height;
  packed.environment = std::move(before.environment);
  packed.environment_ends = std::move(before.environment_ends);
}

// The volume, whose voxels are those of the memory if they come from the same grids. A volume without density is none.
void pack_volume(Scene& scene, PackMemory& memory, PackedScene& packed) {
  if (!scene.volume) return;
  std::shared_ptr<const PackedVoxels> before = std::move(memory.packed.voxels);
  memory.kept.voxels = before && before->grids == scene.volume->grids;
  packed.voxels = memory.kept.voxels ? std::move(before) : pack_voxels(scene.volume->grids);
  Volume volume = *scene.volume;
  if (const double factor = volume_thinning(volume, *packed.voxels); factor < 1.0) {
    volume.scattering = glm::vec3(glm::dvec3(volume.scattering) * factor);
    volume.absorption = glm::vec3(glm::dvec3(volume.absorption) * factor);
    scene.warnings.add("the volume is denser than can be resolved, and was thinned to an optical depth of 256 a voxel");
  }
  packed.volume = volume_frame(volume, *packed.voxels, packed.origin);
  if (packed.voxels->cells.x == 0 || !(packed.volume.extinction > 0.0f)) packed.voxels.reset();
}

void take_lights(PackMemory& memory, PackedScene& packed) {
  PackedScene& before = memory.packed;
  packed.lights = std::move(before.lights);
  packed.lamp_sources = std::move(before.lamp_sources);
  packed.light_parts = std::move(before.light_parts);
  packed.local_light_count = before.local_light_count;
  packed.light_tree = std::move(before.light_tree);
  packed.light_tree_depth = before.light_tree_depth;
  packed.light_locations = before.light_locations;
  packed.typical_radiance = before.typical_radiance;
  packed.environment_probability = before.environment_probability;
}

void take_geometry(PackMemory& memory, PackedScene& packed) {
  PackedScene& before = memory.packed;
  packed.nodes = std::move(before.nodes);
  packed.root = before.root;
  packed.root_is_top = before.root_is_top;
  packed.stack_size = before.stack_size;
  packed.triangles = std::move(before.triangles);
  packed.instances = std::move(before.instances);
  packed.node_runs = std::move(before.node_runs);
  packed.instance_nodes = std::move(before.instance_nodes);
  packed.once_instance = before.once_instance;
  packed.sources = std::move(before.sources);
  packed.instance_sources = std::move(before.instance_sources);
  packed.draws = std::move(before.draws);
  packed.triangle_vertices = std::move(before.triangle_vertices);
  packed.vertex_normals = std::move(before.vertex_normals);
  packed.vertex_uvs = std::move(before.vertex_uvs);
  packed.vertex_colors = std::move(before.vertex_colors);
  packed.layer_tangents = before.layer_tangents;
  packed.triangle_count = before.triangle_count;
  packed.dropped_triangles = before.dropped_triangles;
  packed.alpha = before.alpha;
  packed.cut = before.cut;
  packed.triangles_stored = before.triangles_stored;
  packed.sah_cost = before.sah_cost;
}

// The top level over objects: the first one where it is, the others where instances show them. `centres`: by mesh, what
// has become the object's zero. Returns by instance its object.
std::vector<std::uint32_t> place_objects(Scene& scene, const glm::dmat4& device_from_world,
                                         std::span<const Object> objects, std::span<const std::uint32_t> object_of_mesh,
                                         std::span<const glm::dvec3> centres, PackedScene& packed) {
  std::vector<Placement> placements{{0, glm::dmat4(1.0)}};
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    if (object_of_mesh[instance.mesh] != kNoIndex)
      placements.push_back({object_of_mesh[instance.mesh],
                            glm::translate(device_from_world * instance.world_from_object, centres[instance.mesh]),
                            instance.node, i});
  }

  std::size_t skipped = 0;
  std::vector<std::uint32_t> object_of = pack_instances(objects, placements, packed, skipped);
  if (skipped > 0)
    scene.warnings.add("instances too large, too far or too small for single precision were dropped", skipped);
  return object_of;
}

// An object for the static part and one for every shared mesh, then the top level. Returns by instance its object.
// Where an instance is cut, the object's zero is where the eye is to the nearest one: floats are finest there.
std::vector<std::uint32_t> pack_two_level(Scene& scene, Layout& layout, const glm::dmat4& device_from_world,
                                          PackedScene& packed, std::vector<Object>& objects) {
  std::vector<std::uint32_t> object_of_mesh(scene.meshes.size(), kNoIndex);
  std::vector<glm::dvec3> centres(scene.meshes.size(), glm::dvec3(0.0)); // in the mesh, what becomes the object's zero
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    if (layout.usage.mesh_instances[m] < 2) continue;
    std::vector<Part> parts;
    list_parts(scene, layout, m, glm::dmat4(1.0), parts);
    std::vector<glm::dvec3> near = near_instances(scene, m, layout.near);
    if (!cut_huge(scene, parts, near).empty()) {
      centres[m] = near[0];
      parts.clear();
      list_parts(scene, layout, m, glm::translate(glm::dmat4(1.0), -centres[m]), parts);
      for (glm::dvec3& p : near) p -= centres[m];
    }
    object_of_mesh[m] = static_cast<std::uint32_t>(objects.size());
    objects.push_back(pack_parts(scene, layout, parts, near, layout.usage.mesh_instances[m], nullptr, packed));
  }
  return place_objects(scene, device_from_world, objects, object_of_mesh, centres, packed);
}

// Instances of one object that follow each other become one draw. `object_of`: by instance, of a two-level scene.
std::vector<Draw> list_draws(const PackedScene& packed, const std::vector<Object>& objects,
                             const std::vector<std::uint32_t>& object_of) {
  if (!packed.root_is_top)
    return objects[0].item_count ? std::vector<Draw>{{objects[0].first_item, objects[0].item_count, 0, 1}}
                                 : std::vector<Draw>{};
  std::vector<Draw> draws;
  for (std::uint32_t i = 0; i < object_of.size(); ++i) {
    const Object& object = objects[object_of[i]];
    if (i > 0 && object_of[i] == object_of[i - 1])
      ++draws.back().instance_count;
    else
      draws.push_back({object.first_item, object.item_count, i, 1});
  }
  return draws;
}

// Floats are finest near zero. An eye inside the box becomes the origin; for an eye outside, the nearest point of the
// box does, so that the geometry does not lie far from zero.
void place_origin(const Scene& scene, const std::optional<glm::dvec3>& eye, PackedScene& packed) {
  const Bounds bounds = world_bounds(scene);
  packed.origin = eye && !bounds.empty() ? glm::clamp(*eye, bounds.lo, bounds.hi) : bounds.centre();
  packed.radius = bounds.radius();
  if (scene.volume) packed.radius += voxel_metres(*scene.volume); // the outer voxels reach beyond the box
  packed.centre = glm::vec3(bounds.centre() - packed.origin);
}

// Warns of textures that --textures hardware cannot look up.
void warn_of_exact(const TextureTable& textures, Warnings& warnings) {
  const ExactTextures exact = count_exact(textures);
  if (exact.floats > 0)
    warnings.add("textures of more than 8 bits are filtered exactly in spite of --textures hardware", exact.floats);
  if (exact.unplaced > 0)
    warnings.add(
        "textures are filtered exactly in spite of --textures hardware, as the device's images cannot hold them",
        exact.unplaced);
}

// The materials of the shadow catcher, which stand together as in the scene.
void place_catcher(const Scene& scene, const std::vector<std::uint32_t>& material_index, PackedScene& packed) {
  packed.first_catcher = packed.end_catcher = 0;
  for (std::uint32_t m = scene.first_catcher; m < scene.end_catcher; ++m) {
    if (material_index[m] == kNoIndex) continue;
    if (packed.end_catcher == 0) packed.first_catcher = material_index[m];
    packed.end_catcher = material_index[m] + 1;
  }
}

void pack_surfaces(const Scene& scene, const std::vector<std::uint32_t>& material_index, MaterialTable& materials,
                   PackedScene& packed) {
  packed.materials = std::move(materials.materials);
  for (std::size_t m = 0; m < scene.materials.size(); ++m)
    if (material_index[m] != kNoIndex) packed.material_names.push_back(scene.materials[m].name);
  if (packed.materials.size() > gpu::kTriangleMaterialMask)
    throw Error(scene.path, "has more than 268435455 materials", "merge materials that are equal");
  packed.layers = std::move(materials.layers);
}

void pack_textures(Scene& scene, const TextureTable& textures, PackedScene& packed) {
  packed.textures = textures.textures;
  packed.texels = pack_texels(textures, scene);
  packed.atlases = pack_atlases(textures, scene);
  warn_of_exact(textures, scene.warnings);
}

// Triangles, the trees over them, and vertices. `object_of`: by instance, of a two-level scene.
void pack_geometry(Scene& scene, Layout& layout, const glm::dmat4& device_from_world, std::vector<Object>& objects,
                   std::vector<std::uint32_t>& object_of, PackedScene& packed) {
  layout.alpha.emplace(scene, layout.usage);
  const Streams streams = needed_streams(scene, layout.usage);
  layout.with_vertices = streams.any();
  const auto start = Clock::now();
  packed.triangles.reserve(layout.usage.triangles_stored);
  if (layout.with_vertices) packed.triangle_vertices.reserve(layout.usage.triangles_stored);
  objects = {pack_static(scene, layout, device_from_world, packed)};
  object_of.clear();
  if (layout.usage.two_level()) {
    object_of = pack_two_level(scene, layout, device_from_world, packed, objects);
    for (const std::uint32_t object : object_of) packed.triangle_count += objects[object].source_count;
  } else {
    packed.root = objects[0].root;
    packed.stack_size = objects[0].depth;
    packed.triangle_count = objects[0].source_count;
  }
  if (packed.moves())
    packed.motions.resize(packed.triangles.size(), gpu::Triangle{}); // objects after the first stand still
  packed.draws = list_draws(packed, objects, object_of);
  for (const Object& object : objects) packed.triangles_stored += object.triangle_count;
  packed.sah_cost = std::ranges::max_element(objects, {}, &Object::triangle_count)->sah_cost;
  packed.bvh_seconds = seconds_since(start);
  if (packed.cut.coarse)
    scene.warnings.add(
        "triangles that are huge beside their distance to the eye were cut less finely than they should "
        "be, as there are so many");
  if (packed.dropped_triangles > 0) scene.warnings.add(kDropped, packed.dropped_triangles);
  const std::size_t repaired = pack_vertices(scene, layout.usage, streams, layout.cut_vertices, packed);
  if (repaired > 0) scene.warnings.add(kRepaired, repaired);
  if (layout.memory) layout.memory->repaired_uvs = repaired;
}

// The parts that were packed last where they are now, and which of them are elsewhere.
std::vector<Part> list_moved_parts(const Scene& scene, const Layout& layout, const glm::dmat4& device_from_world,
                                   std::vector<std::uint32_t>& moved) {
  std::vector<Part> parts = layout.memory->once.parts;
  std::vector<const glm::dmat4*> places(scene.meshes.size());
  for (const Instance& instance : scene.instances) places[instance.mesh] = &instance.world_from_object;
  for (std::uint32_t p = 0; p < parts.size(); ++p) {
    const glm::dmat4 now = device_from_world * *places[parts[p].mesh];
    if (now == parts[p].device_from_object) continue;
    parts[p].device_from_object = now;
    parts[p].mirrored = glm::determinant(glm::dmat3(now)) < 0.0;
    moved.push_back(p);
  }
  return parts;
}

// Gives the first object of `nodes` those of `tree`, and moves the nodes of the others.
void replace_nodes(const bvh::WideTree& tree, std::vector<Object>& objects, std::vector<bvh::WideNode>& nodes) {
  const std::uint32_t before = objects[0].node_count, now = static_cast<std::uint32_t>(tree.nodes.size());
  const std::ptrdiff_t common = std::min(before, now);
  if (now < before)
    nodes.erase(nodes.begin() + common, nodes.begin() + before);
  else
    nodes.insert(nodes.begin() + common, now - before, bvh::WideNode{});
  for (std::size_t n = now; n < nodes.size(); ++n) nodes[n].first_child += now - before;
  for (std::size_t i = 1; i < objects.size(); ++i) objects[i].root += now - before;
  objects[0].node_count = now;
  std::ranges::copy(tree.nodes, nodes.begin());
}

// Packs meshes that are shown once and are elsewhere now into the geometry that was packed last.
void replace_moved(const Scene& scene, const Layout& layout, const KeptTree& tree, bool goes_on,
                   std::span<const std::uint32_t> moved, PackedScene& packed) {
  PackMemory& memory = *layout.memory;
  Object& object = memory.objects[0];
  const std::size_t old_items = object.item_count, items = tree.tree.order.size();
  replace_nodes(tree.tree, memory.objects, packed.nodes);
  const std::size_t first = goes_on ? tree.still.order.size() : 0;
  if (!goes_on && tree.former.size() == old_items) {
    rearrange_items(scene, memory.once, tree, moved, packed);
  } else {
    if (items != old_items) { // there is one object only
      packed.triangles.resize(items);
      if (!packed.triangle_vertices.empty()) packed.triangle_vertices.resize(items);
      if (!packed.sources.empty()) packed.sources.resize(items);
    }
    write_items(scene, memory.once, tree, static_cast<std::uint32_t>(first), packed);
  }
  object.item_count = static_cast<std::uint32_t>(items);
  object.depth = tree.tree.depth;
  object.sah_cost = tree.sah_cost;
  object.lo = {tree.box.lo.x, tree.box.lo.y, tree.box.lo.z};
  object.hi = {tree.box.hi.x, tree.box.hi.y, tree.box.hi.z};
  memory.kept.moved_triangles = {first, items - first};
  const Streams streams = needed_streams(scene, layout.usage);
  std::uint32_t last = kNoIndex;
  for (const std::uint32_t p : moved) {
    const std::uint32_t mesh = memory.once.parts[p].mesh;
    if (std::exchange(last, mesh) == mesh) continue; // another primitive of it
    for (const Instance& instance : scene.instances)
      if (instance.mesh == mesh)
        pack_moved_vertices(scene, layout.usage, streams, mesh, instance.world_from_object, packed);
    if (!streams.normals) continue;
    const ArrayRange range{layout.usage.first_vertex[mesh], scene.meshes[mesh].positions.size()};
    memory.kept.moved_vertices.push_back(range);
    if (streams.layer_tangents)
      memory.kept.moved_vertices.push_back({packed.layer_tangents + range.first, range.count});
  }
}

// Of the geometry that was packed last, where nothing but places is other than then, takes over what stays, and packs
// the rest. False if that does not do, and nothing was taken over.
bool move_geometry(Scene& scene, const Layout& layout, const glm::dmat4& device_from_world, PackedScene& packed) {
  PackMemory& memory = *layout.memory;
  const auto start = Clock::now();
  const bool two_level = layout.usage.two_level();
  std::vector<std::uint32_t> moved;
  std::vector<Part> parts = list_moved_parts(scene, layout, device_from_world, moved);
  bool goes_on = true;
  if (!moved.empty()) {
    const std::optional<std::vector<MovedTriangles>> triangles = move_triangles(scene, parts, memory.once, moved);
    if (!triangles) return false;
    KeptTree& tree = memory.trees.of_objects[0];
    goes_on = move_again(*triangles, layout.quality, tree, memory.trees.built);
    const std::size_t items = tree.tree.order.size(), nodes = tree.tree.nodes.size();
    if (two_level && items != memory.objects[0].item_count) return false; // others lie behind them
    if (items > bvh::kMaxItems || memory.packed.nodes.size() + nodes > bvh::kMaxNodes) return false;
  }
  take_geometry(memory, packed);
  memory.once.parts = std::move(parts);
  if (two_level) packed.nodes.resize(packed.root); // the top level comes last
  if (!moved.empty()) replace_moved(scene, layout, memory.trees.of_objects[0], goes_on, moved, packed);
  if (memory.shone) {
    tbb::parallel_for(std::size_t{0}, packed.triangles.size(),
                      [&](std::size_t i) { packed.triangles[i].light = gpu::kNone; });
    memory.kept.moved_triangles = {0, packed.triangles.size()};
  }
  if (two_level) {
    std::vector<std::uint32_t> object_of_mesh(scene.meshes.size(), kNoIndex);
    std::uint32_t next = 1;
    for (std::uint32_t m = 0; m < scene.meshes.size(); ++m)
      if (layout.usage.mesh_instances[m] > 1) object_of_mesh[m] = next++;
    packed.instances.clear(), packed.instance_nodes.clear(), packed.instance_sources.clear();
    packed.once_instance = kNoIndex;
    const std::vector<glm::dvec3> centres(scene.meshes.size(), glm::dvec3(0.0)); // nothing is cut
    memory.object_of = place_objects(scene, device_from_world, memory.objects, object_of_mesh, centres, packed);
    packed.triangle_count = 0;
    for (const std::uint32_t object : memory.object_of) packed.triangle_count += memory.objects[object].source_count;
  } else {
    packed.stack_size = memory.objects[0].depth;
  }
  packed.draws = list_draws(packed, memory.objects, memory.object_of);
  packed.sah_cost = std::ranges::max_element(memory.objects, {}, &Object::triangle_count)->sah_cost;
  packed.bvh_seconds = seconds_since(start);
  if (packed.dropped_triangles > 0) scene.warnings.add(kDropped, packed.dropped_triangles);
  if (memory.repaired_uvs > 0) scene.warnings.add(kRepaired, memory.repaired_uvs);
  return true;
}

// `memory`: null where nothing is remembered.
PackedScene pack_scene(Scene& scene, const Packing& packing, PackMemory* memory) {
  PackMemory nothing;
  PackMemory& before = memory ? *memory : nothing;
  PackedScene packed;
  packed.bvh_quality = packing.quality;
  packed.node_names = scene.node_names;
  if (before.has_packed && before.is_still && before.packing.eye == packing.eye) {
    packed.origin = before.packed.origin, packed.radius = before.packed.radius, packed.centre = before.packed.centre;
  } else {
    place_origin(scene, packing.eye, packed);
  }
  Layout layout(scene);
  layout.quality = packing.quality;
  layout.with_sources = packing.sources;
  layout.near = packing.near;
  layout.memory = memory;
  before.kept = {};
  before.trees.built = 0;

  KeptParts& kept = before.kept;
  const bool same_uses = before.has_packed && before.material_used == layout.usage.material_used;
  const bool same_look_up = before.packing.mips == packing.mips && before.packing.samplers == packing.samplers;
  // Of bodies that overlap, the size decides which one counts.
  const bool same_bodies = before.is_still || std::ranges::none_of(scene.materials, is_body);
  const bool same_materials =
      same_uses && same_look_up && same_bodies && !before.other_materials && !before.other_images;
  kept.environment = before.has_packed && !before.other_environment && before.packing.direct == packing.direct;
  if (same_materials) {
    kept.textures = true;
    layout.material_index = before.material_index;
    take_materials(before, packed);
    take_textures(before, packed);
  } else {
    MaterialTable materials = pack_materials(scene, layout.usage, packing.mips, packing.samplers);
    layout.material_index = std::move(materials.packed_index);
    pack_surfaces(scene, layout.material_index, materials, packed);
    kept.textures = before.has_packed && same_look_up && !before.other_images &&
                    holds_same_texels(before.textures, materials.textures);
    if (kept.textures)
      take_textures(before, packed);
    else
      pack_textures(scene, materials.textures, packed);
    if (memory) memory->textures = std::move(materials.textures);
  }
  take_environment(before, packed); // of another one, the memory
  if (!kept.environment) before.environment = pack_environment(scene.environment, packing.direct, packed);
  kept.surfaces = same_materials && kept.environment;
  pack_volume(scene, before, packed);

  place_catcher(scene, layout.material_index, packed);
  const glm::dmat4 device_from_world = glm::translate(glm::dmat4(1.0), -packed.origin);
  std::vector<ShapeTraits> traits = std::move(before.traits);
  if (memory && !(same_materials && traits.size() == scene.materials.size())) {
    std::vector<ShapeTraits> now;
    for (const Material& material : scene.materials) now.push_back(shape_traits(material));
    before.traits = std::move(traits);
    traits = std::move(now);
  } else {
    before.traits = traits;
  }
  const bool same_look = same_uses && has_same_look(layout, traits, packed);
  kept.geometry = same_look && has_same_geometry(scene, layout, device_from_world, packed);
  kept.places = same_look && !kept.geometry && before.keeps_trees &&
                has_same_meshes(scene, layout, device_from_world, packed) &&
                move_geometry(scene, layout, device_from_world, packed);
  if (kept.geometry)
    take_geometry(before, packed);
  else if (!kept.places)
    pack_geometry(scene, layout, device_from_world, before.objects, before.object_of, packed);
  const bool shines = any_shines(scene, layout.usage);
  kept.lights = kept.geometry && kept.environment && before.packing.direct == packing.direct &&
                before.packing.lights == packing.lights && before.lights == scene.lights &&
                (same_materials || !(shines || before.shone));
  kept.marks = kept.lights || (kept.geometry && same_materials && before.packing.direct == packing.direct);
  if (kept.lights) {
    take_lights(before, packed);
  } else {
    std::vector<std::uint32_t> marks;
    if (kept.geometry && !kept.marks) {
      marks = light_marks(packed);
      for (gpu::Triangle& triangle : packed.triangles) triangle.light = gpu::kNone;
      for (gpu::Instance& instance : packed.instances) instance.first_light = 0;
    }
    pack_lights(scene, before.objects, before.object_of, before.environment, packing.direct, packing.lights, packed);
    if (kept.geometry && !kept.marks) kept.marks = marks == light_marks(packed);
  }
  if (!packing.light_groups.empty())
    pack_light_groups(find_light_groups(scene, packing.light_groups), layout.material_index, packed);
  packed.features = find_features(scene, layout.usage, packed);
  if (const gpu::Feature lobes = packed.features & gpu::kLobesAll) {
    for (std::size_t m = 0; m < scene.materials.size(); ++m)
      if (layout.material_index[m] != kNoIndex && has_layer_tangents(scene.materials[m]))
        packed.layers[layout.material_index[m]].layer_tangents = packed.layer_tangents;
    const std::size_t texels =
        packed.materials.size() * gpu::kMaterialTexels + packed.layers.size() * gpu::kLayerTexels;
    if (!same_materials)
      packed.albedo_tables =
          make_albedo_tables(packed.materials, packed.layers, lobes, static_cast<std::uint32_t>(texels));
  } else {
    packed.layers.clear();
  }
  packed.left_out = list_left_out(layout.usage, packed, packing.direct);
  if (memory) {
    memory->has_packed = true;
    memory->material_index = std::move(layout.material_index);
    memory->material_used = std::move(layout.usage.material_used);
    memory->near = std::move(layout.near);
    memory->packing = packing;
    memory->traits = std::move(traits);
    memory->lights = scene.lights;
    memory->shone = shines;
    memory->shown = list_shown(scene);
  }
  return packed;
}

} // namespace

ShapeTraits shape_traits(const Material& m) {
  ShapeTraits traits;
  const bool bits[] = {m.double_sided,    m.transmission > 0.0f, m.diffuse_transmission > 0.0f, m.unlit,
                       may_be_pane(m),    may_be_wall(m),        m.emission != glm::vec3(0.0f), is_body(m),
                       needs_tangents(m), has_layer_tangents(m)};
  for (const bool bit : bits) traits.flags = traits.flags << 1 | (bit ? 1u : 0u);
  traits.alpha_mode = m.alpha_mode;
  if (m.alpha_mode != AlphaMode::opaque) traits.alpha = m.base_color.a;
  if (m.alpha_mode == AlphaMode::mask) traits.alpha_cutoff = m.alpha_cutoff;
  visit_textures(m, [&](const MaterialTexture& row, const TextureSlot& slot) {
    const bool covers = row.field == &Material::base_color_texture && m.alpha_mode != AlphaMode::opaque;
    TextureSlot& kept = traits.textures.emplace_back(slot);
    if (!covers) kept.image = kNoIndex;
  });
  return traits;
}

PackedScene pack(Scene& scene, const Packing& packing) { return pack_scene(scene, packing, nullptr); }

PackedScene pack_again(Scene& scene, const Packing& packing, PackMemory& memory) {
  return pack_scene(scene, packing, &memory);
}

} // namespace wavepath
