// Runs the stages of packing in their order; see pack.h.
#include "host/scene/pack/pack.h"

#include <algorithm>
#include <optional>

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
                  std::uint64_t times, PackedScene& packed) {
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
                       layout.objects++, packed);
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
  if (parts.empty() && layout.usage.two_level()) return {};
  Object object = pack_parts(scene, layout, parts, near_in_device(layout, packed), 1, packed);
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

// True if the geometry that was packed last is that of this scene. `traits`: those of its materials.
bool has_same_geometry(const Scene& scene, const Layout& layout, const std::vector<ShapeTraits>& traits,
                       const glm::dmat4& device_from_world, const PackedScene& packed) {
  const PackMemory& before = *layout.memory;
  if (!before.is_still || before.packed.origin != packed.origin || before.packed.moves()) return false;
  if (before.packing.quality != layout.quality || before.traits != traits) return false;
  if (layout.with_sources && !before.packing.sources) return false;
  // Rays look alpha up, of which there may be another.
  const auto asks = [](const ShapeTraits& one) { return one.alpha_mode != AlphaMode::opaque; };
  if (before.other_images && std::ranges::any_of(traits, asks)) return false;
  if (before.near == layout.near) return true;
  return before.packed.cut.triangles == 0 && !has_huge(scene, layout, device_from_world, packed);
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

// An object for the static part and one for every shared mesh, then the top level. Returns by instance its object.
// Where an instance is cut, the object's zero is where the eye is to the nearest one: floats are finest there.
std::vector<std::uint32_t> pack_two_level(Scene& scene, Layout& layout, const glm::dmat4& device_from_world,
                                          PackedScene& packed, std::vector<Object>& objects) {
  std::vector<Placement> placements{{0, glm::dmat4(1.0)}};
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
    objects.push_back(pack_parts(scene, layout, parts, near, layout.usage.mesh_instances[m], packed));
  }
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
  if (packed.dropped_triangles > 0)
    scene.warnings.add("triangles without area or with coordinates that are not finite were dropped",
                       packed.dropped_triangles);
  pack_vertices(scene, layout.usage, streams, layout.cut_vertices, packed);
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
  const bool same_materials = same_uses && same_look_up && !before.other_materials && !before.other_images;
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
  kept.geometry = same_uses && has_same_geometry(scene, layout, traits, device_from_world, packed);
  if (kept.geometry)
    take_geometry(before, packed);
  else
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
