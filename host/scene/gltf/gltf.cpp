// Reads a glTF file into a Scene: open, pose, place; meshes, materials and images follow from what is placed.
#include "host/scene/gltf/gltf.h"

#include <algorithm>
#include <cmath>
#include <future>
#include <map>
#include <tuple>

#include <glm/gtc/matrix_access.hpp>
#include <glm/gtc/type_ptr.hpp>

#include "host/base/error.h"
#include "host/base/memory.h"
#include "host/scene/bounds.h"
#include "host/scene/gltf/accessor.h"
#include "host/scene/gltf/extensions.h"
#include "host/scene/gltf/flat.h"
#include "host/scene/gltf/image.h"
#include "host/scene/gltf/image_light.h"
#include "host/scene/gltf/instancing.h"
#include "host/scene/gltf/light_profiles.h"
#include "host/scene/gltf/material.h"
#include "host/scene/gltf/mesh.h"
#include "host/scene/gltf/motion.h"
#include "host/scene/gltf/nodes.h"
#include "host/scene/gltf/open_document.h"
#include "host/scene/gltf/pose.h"
#include "host/scene/gltf/texture.h"
#include "host/scene/gltf/uri.h"
#include "host/scene/gltf/variants.h"
#include "host/scene/gltf/volumes.h"

namespace wavepath {

namespace gltf {

// What an import leaves behind for the next one.
struct Imported {
  MaterialMap materials;
  std::map<MeshUse, std::uint32_t> meshes;
  std::size_t material_count = 0; // of the scene, before others added theirs
  bool holds_values = false;      // an image does, as take_images() says
};

} // namespace gltf

namespace {

using gltf::Document;
using gltf::Imported;

// A mesh that is flattened, and along what.
using FlatUse = std::tuple<std::uint32_t, double, double, double>;

// The state of an import.
struct Import {
  Document& document;
  Scene& scene;
  std::vector<glm::dmat4> world;
  bool keeps_lines = false; // instances without area stay, as they may have some when the shutter closes
  gltf::MaterialMap materials{};
  std::map<gltf::MeshUse, std::uint32_t> meshes{};
  std::map<FlatUse, std::uint32_t> flat_meshes{};
  std::vector<glm::dmat4> upright{};           // of Scales::signs, once one is needed
  std::map<gltf::MeshUse, Mesh> read_before{}; // meshes that need not be read again
  gltf::ProfileMap profiles{};
};

bool is_affine(const glm::dmat4& matrix) {
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      if (!std::isfinite(matrix[i][j])) return false;
    }
  }
  return glm::row(matrix, 3) == glm::dvec4(0.0, 0.0, 0.0, 1.0);
}

const glm::dmat4& upright_matrix(Import& import, std::size_t node) {
  if (import.upright.empty()) import.upright = gltf::world_matrices(import.document, gltf::Scales::signs);
  return import.upright[node];
}

// Converts the materials of a node's mesh before its geometry is read, so that images are decoded at the same time.
void convert_materials(Import& import, const tinygltf::Node& node, bool keeps_variants) {
  if (node.mesh < 0) return;
  for (const tinygltf::Primitive& primitive :
       import.document.model.meshes[static_cast<std::size_t>(node.mesh)].primitives) {
    if (!gltf::has_triangles(primitive)) continue;
    gltf::use_material(import.document, import.scene, import.materials, primitive.material);
    if (!keeps_variants) continue;
    for (const int material : gltf::all_materials(primitive))
      gltf::use_material(import.document, import.scene, import.materials, material);
  }
}

void convert_materials(Import& import, const std::vector<int>& nodes, const std::vector<bool>& hidden, bool keeps_all) {
  for (const int node : nodes)
    if (keeps_all || !hidden[static_cast<std::size_t>(node)])
      convert_materials(import, import.document.model.nodes[static_cast<std::size_t>(node)], keeps_all);
}

std::uint32_t add_mesh(Import& import, Mesh mesh) {
  import.scene.meshes.push_back(std::move(mesh));
  return static_cast<std::uint32_t>(import.scene.meshes.size() - 1);
}

// A transform may need a copy of the mesh of its own.
void require_copy(const Import& import, const Mesh& mesh) {
  const std::uint64_t vertex = 3 * sizeof(glm::vec3) + 2 * sizeof(glm::vec4) + 2 * sizeof(glm::vec2);
  require_memory(import.document.file, "a flattened copy of a mesh",
                 vertex * mesh.positions.size() + sizeof(std::uint32_t) * mesh.indices.size(),
                 "use a machine with more memory");
}

// `mirrors`: what the transform would do if its scales were not zero.
void place_flat(Import& import, std::uint32_t mesh, const glm::dmat4& transform, bool mirrors) {
  const gltf::FlatTransform flat = gltf::flat_transform(transform, mirrors);
  const glm::dvec3& d = flat.direction;
  const auto [found, is_new] = import.flat_meshes.emplace(FlatUse{mesh, d.x, d.y, d.z}, 0);
  if (is_new) {
    require_copy(import, import.scene.meshes[mesh]);
    found->second = add_mesh(import, gltf::flattened(import.scene.meshes[mesh], d));
  }
  import.scene.instances.push_back({found->second, flat.world_from_flat});
}

// Places the instances of a node whose mesh has no skin.
void place_instances(Import& import, std::size_t node_index, std::uint32_t mesh) {
  Scene& scene = import.scene;
  const auto list = [&](const glm::dmat4& world, gltf::Scales scales) {
    return gltf::instance_matrices(import.document, scene.warnings, import.document.model.nodes[node_index], world,
                                   scales);
  };
  const std::vector<glm::dmat4> transforms = list(import.world[node_index], gltf::Scales::authored);
  std::vector<glm::dmat4> upright; // once one is flat
  for (std::size_t i = 0; i < transforms.size(); ++i) {
    const glm::dmat3 linear(transforms[i]);
    const gltf::Extent extent = gltf::extent_of(linear);
    if (!is_affine(transforms[i]) || !std::isfinite(glm::determinant(linear))) {
      scene.warnings.add("instance with a transform that is not affine or not finite left out");
    } else if (extent == gltf::Extent::flat) {
      if (upright.empty()) upright = list(upright_matrix(import, node_index), gltf::Scales::signs);
      place_flat(import, mesh, transforms[i], glm::determinant(glm::dmat3(upright[i])) < -gltf::kFlatRounding);
    } else if (extent == gltf::Extent::solid && std::isfinite(1.0 / glm::determinant(linear))) {
      scene.instances.push_back({mesh, transforms[i]});
    } else if (import.keeps_lines) {
      require_copy(import, scene.meshes[mesh]);
      scene.instances.push_back(
          {add_mesh(import, gltf::collapsed(scene.meshes[mesh], transforms[i])), glm::dmat4(1.0)});
    } else {
      scene.warnings.add("instance with a scale of zero area left out");
    }
  }
}

void place_mesh(Import& import, std::size_t node_index) {
  const auto& node = import.document.model.nodes[node_index];
  const auto& source = import.document.model.meshes[static_cast<std::size_t>(node.mesh)];
  gltf::MeshUse use{node.mesh, node.weights.empty() ? source.weights : node.weights, node.skin};
  const auto [found, is_new] = import.meshes.emplace(use, 0);
  if (const auto kept = import.read_before.find(use); is_new && kept != import.read_before.end()) {
    found->second = add_mesh(import, std::move(kept->second));
  } else if (is_new) {
    found->second =
        add_mesh(import, gltf::read_mesh(import.document, import.scene, import.materials, use, import.world));
    if (node.skin < 0) import.scene.meshes[found->second].content = new_content();
  }
  const std::uint32_t mesh = found->second;
  if (import.scene.meshes[mesh].indices.empty()) return;
  if (node.skin >= 0) {
    import.scene.instances.push_back({mesh, glm::dmat4(1.0)}); // in world space already
  } else {
    place_instances(import, node_index, mesh);
  }
}

void place_camera(Import& import, std::size_t node_index) {
  const tinygltf::Node& node = import.document.model.nodes[node_index];
  const auto& source = import.document.model.cameras[static_cast<std::size_t>(node.camera)];
  Camera camera;
  camera.name = !source.name.empty() ? source.name : node.name;
  camera.orthographic = source.type == "orthographic";
  camera.world_from_camera = import.world[node_index];
  if (camera.orthographic) {
    camera.xmag = std::abs(source.orthographic.xmag);
    camera.ymag = std::abs(source.orthographic.ymag);
    camera.znear = source.orthographic.znear;
    camera.zfar = source.orthographic.zfar;
  } else {
    camera.znear = source.perspective.znear;
    if (source.perspective.zfar != 0.0) camera.zfar = source.perspective.zfar; // else it is infinitely far
    camera.yfov = source.perspective.yfov;
    camera.aspect = source.perspective.aspectRatio;
  }
  if (!finite_point(glm::dvec3(camera.world_from_camera[3]))) {
    import.scene.warnings.add("camera beyond the largest coordinates left out");
    return;
  }
  const double widest = std::max({camera.xmag, camera.ymag, camera.aspect});
  const bool sound =
      (camera.orthographic ? camera.xmag > 0.0 && camera.ymag > 0.0
                           : camera.yfov > 0.0 && camera.yfov < 3.141592653589793 && camera.aspect >= 0.0) &&
      widest < kLargestCoordinate;
  if (!sound) {
    import.document.fail("camera " + std::to_string(node.camera) +
                         " has a field of view, aspect ratio or size that no camera can have");
  }
  // A scale has no meaning for a camera, so that one of zero takes no direction from it.
  glm::dmat4& world = camera.world_from_camera;
  if (gltf::extent_of(glm::dmat3(world)) != gltf::Extent::solid)
    for (int i = 0; i < 3; ++i) world[i] = upright_matrix(import, node_index)[i];
  if (is_affine(world)) {
    import.scene.cameras.push_back(camera);
  } else {
    import.scene.warnings.add("camera with a transform that is not affine or not finite left out");
  }
}

LightKind to_light_kind(const Document& document, const std::string& type) {
  if (type == "point") return LightKind::point;
  if (type == "spot") return LightKind::spot;
  if (type == "directional") return LightKind::directional;
  document.fail("a light has unknown type '" + gltf::shown(type) + "'");
}

void set_cone(Import& import, const tinygltf::Light& source, PunctualLight& light) {
  constexpr double kRightAngle = 1.5707963267948966;
  light.outer_cone = std::clamp(source.spot.outerConeAngle, 0.0, kRightAngle);
  light.inner_cone = std::clamp(source.spot.innerConeAngle, 0.0, light.outer_cone);
  if (light.outer_cone != source.spot.outerConeAngle || light.inner_cone != source.spot.innerConeAngle) {
    import.scene.warnings.add("spot light cone outside its range, clamped");
  }
}

glm::dvec3 unit(const glm::dvec3& v) {
  return glm::normalize(v / std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)})); // not a number for none
}

// KHR_lights_punctual: a scale is ignored but for its effect on position and orientation. Where it leaves nothing of
// the direction, that is the limit of small scales.
glm::dvec3 light_direction(Import& import, std::size_t node) {
  const glm::dmat4& world = import.world[node];
  if (gltf::extent_of(glm::dmat3(world)) == gltf::Extent::solid) return unit(-glm::dvec3(world[2]));
  const double size = std::max({glm::length(world[0]), glm::length(world[1]), glm::length(world[2])});
  const bool is_left = glm::length(world[2]) > gltf::kFlatRounding * size;
  return unit(-glm::dvec3(is_left ? world[2] : upright_matrix(import, node)[2]));
}

void add_light(Import& import, std::size_t node_index, PunctualLight light) {
  const glm::dmat4& world = import.world[node_index];
  light.node = static_cast<std::uint32_t>(node_index);
  light.position = glm::dvec3(world[3]);
  light.direction = light_direction(import, node_index);
  const bool finite = glm::all(glm::lessThan(light.intensity, glm::vec3(1e30f))) &&
                      std::isfinite(glm::length(light.direction) + glm::length(light.tangent));
  if (!is_affine(world) || !finite) {
    import.scene.warnings.add("light with an intensity or a transform that is not affine or not finite left out");
    return;
  }
  import.scene.lights.push_back(std::move(light));
}

void place_light(Import& import, std::size_t node_index) {
  const tinygltf::Node& node = import.document.model.nodes[node_index];
  const auto extension = node.extensions.find("KHR_lights_punctual");
  if (extension == node.extensions.end()) return;
  const auto index = static_cast<std::size_t>(extension->second.Get("light").GetNumberAsInt());
  const tinygltf::Light& source = import.document.model.lights[index];
  PunctualLight light;
  light.name = !source.name.empty() ? source.name : node.name;
  light.kind = to_light_kind(import.document, source.type);
  glm::dvec3 color(1.0);
  for (std::size_t i = 0; i < 3 && i < source.color.size(); ++i) color[static_cast<int>(i)] = source.color[i];
  light.intensity = glm::vec3(glm::max(color, 0.0) * std::max(source.intensity, 0.0));
  if (glm::any(glm::lessThan(color, glm::dvec3(0.0))) || source.intensity < 0.0) {
    import.scene.warnings.add("negative light clamped to zero");
  }
  if (light.kind != LightKind::directional && source.range > 0.0 && std::isfinite(source.range))
    light.range = source.range;
  if (light.kind == LightKind::spot) set_cone(import, source, light);
  add_light(import, node_index, light);
}

// A luminaire has a direction beside the one that it is aimed at.
void place_profile_light(Import& import, std::size_t node_index) {
  const tinygltf::Node& node = import.document.model.nodes[node_index];
  std::optional<PunctualLight> light = gltf::read_profile_light(import.document, import.scene, import.profiles, node);
  if (!light) return;
  const glm::dvec3 aim = light_direction(import, node_index), beside(import.world[node_index][0]);
  glm::dvec3 tangent = beside - aim * glm::dot(aim, beside);
  if (!(glm::length(tangent) > gltf::kFlatRounding * glm::length(beside)))
    tangent = glm::dvec3(upright_matrix(import, node_index)[0]), tangent -= aim * glm::dot(aim, tangent);
  light->tangent = unit(tangent);
  add_light(import, node_index, *light);
}

void add_file(const Document& document, Scene& scene, const std::string& uri) {
  if (const auto file = gltf::resolve_uri(document.path.parent_path(), uri)) scene.files.push_back(file->string());
}

// What the file says of its scene whatever the moment.
Scene begin_scene(const Document& document) {
  Scene scene;
  scene.path = document.path.string();
  scene.warnings = document.warnings;
  scene.variants = document.variants;
  for (const std::filesystem::path& asset : document.assets) scene.files.push_back(asset.string());
  for (const auto* sources : {&document.buffers, &document.images, &document.profiles})
    for (const gltf::Source& source : *sources)
      if (!source.uri.empty() && !gltf::is_data_uri(source.uri)) add_file(document, scene, source.uri);
  for (const gltf::NodeVolume& volume : document.volumes) add_file(document, scene, volume.source.uri);
  scene.extensions_used = document.model.extensionsUsed;
  for (const tinygltf::Node& node : document.model.nodes) scene.node_names.push_back(node.name);
  scene.node_parents = gltf::node_parents(document);
  return scene;
}

// Poses the document, and finds out where its nodes are then.
std::vector<glm::dmat4> pose_nodes(Document& document, Scene& scene, const LoadOptions& options, double seconds,
                                   gltf::Shutter shutter) {
  if (!options.animation.empty()) gltf::pose(document, scene.warnings, options.animation, seconds, shutter);
  return gltf::world_matrices(document);
}

void place_nodes(Import& import, const std::vector<int>& nodes, const std::vector<bool>& hidden,
                 const LoadOptions& options) {
  for (const int node_index : nodes) {
    const auto index = static_cast<std::size_t>(node_index);
    const tinygltf::Node& node = import.document.model.nodes[index];
    if (node.camera >= 0) place_camera(import, index); // visibility affects no cameras
    if (hidden[index]) continue;
    const std::size_t placed = import.scene.instances.size();
    if (node.mesh >= 0) place_mesh(import, index);
    for (std::size_t i = placed; i < import.scene.instances.size(); ++i)
      import.scene.instances[i].node = static_cast<std::uint32_t>(index);
    place_light(import, index);
    place_profile_light(import, index);
  }
  import.scene.volume =
      gltf::place_volume(import.document, import.scene.warnings, nodes, hidden, import.world, options.replaces_volume);
  if (import.scene.instances.empty() && !import.scene.volume && !options.replaces_volume)
    import.scene.warnings.add("scene shows no mesh");
}

// The scene at one moment. `decode`: its images too.
Scene load_moment(Document& document, const LoadOptions& options, double seconds, gltf::Shutter shutter, bool decode,
                  const SceneDescribed& described, Imported* imported = nullptr) {
  Scene scene = begin_scene(document);
  gltf::warn_of_unsupported_extensions(scene.extensions_used, scene.warnings);
  Import import{document, scene, pose_nodes(document, scene, options, seconds, shutter), options.shutter.has_value()};
  const std::vector<int> nodes = gltf::scene_nodes(document, options.scene);
  const std::vector<bool> hidden = gltf::hidden_nodes(document);
  convert_materials(import, nodes, hidden, options.keeps_hidden);
  std::future<std::vector<TextureImage>> images;
  if (decode)
    images = std::async(std::launch::async, gltf::decode_images, gltf::image_files(document, import.materials.images));
  place_nodes(import, nodes, hidden, options);
  if (decode) scene.environment = gltf::read_image_light(document, options.scene);
  if (imported) {
    const bool held = imported->holds_values;
    *imported = {std::move(import.materials), std::move(import.meshes), scene.materials.size(), held};
  }
  if (described) described(scene);
  if (decode) {
    const bool holds_values = gltf::take_images(scene, images.get());
    if (imported) imported->holds_values = holds_values;
  }
  return scene;
}

// The scene as the shutter opens, with what moves until it closes.
Scene load_motion(Document& document, const LoadOptions& options, bool decode, const SceneDescribed& described,
                  Imported* imported) {
  const auto [open, close] = *options.shutter;
  Scene scene = load_moment(document, options, open, {close}, decode, described, imported);
  if (close == open) return scene;
  const Scene end = load_moment(document, options, close, {{}, true}, false, {});
  if (scene.volume != end.volume) scene.warnings.add("volume that moves while the shutter is open stays as it opens");
  gltf::add_motion(scene, end);
  return scene;
}

// Gives a scene the images that its materials read now, of which those that were there before go over; then those that
// others added. Where images hold values, what materials make of them is looked at anew.
void take_next_images(Document& document, const gltf::ImageMap& before, std::vector<Image> images, Imported& imported,
                      Scene& scene) {
  const gltf::ImageMap& now = imported.materials.images;
  const auto take_all = [&] {
    imported.holds_values = gltf::take_images(scene, gltf::decode_images(gltf::image_files(document, now)));
  };
  if (imported.holds_values) {
    take_all();
  } else {
    std::vector<Image> result(now.sources.size());
    gltf::ImageMap missing;
    std::vector<std::size_t> places;
    for (const auto& [key, index] : now.index_of) {
      const auto known = before.index_of.find(key);
      if (known != before.index_of.end()) {
        result[index] = std::move(images[known->second]);
      } else {
        missing.sources.push_back(now.sources[index]);
        places.push_back(index);
      }
    }
    std::vector<TextureImage> decoded = gltf::decode_images(gltf::image_files(document, missing));
    if (std::ranges::any_of(decoded, &TextureImage::holds_values)) {
      take_all();
    } else {
      for (std::size_t i = 0; i < places.size(); ++i) result[places[i]] = std::move(decoded[i].image);
      scene.images = std::move(result);
    }
  }
  for (std::size_t i = before.sources.size(); i < images.size(); ++i) scene.images.push_back(std::move(images[i]));
}

// What meshes carry for a material.
bool reads_alike(const Material& a, const Material& b) {
  const auto same = [](const TextureSlot& s, const TextureSlot& t) {
    return s.uv_set == t.uv_set && s.uv_matrix == t.uv_matrix;
  };
  const auto sets = [](const Material& m) {
    std::uint64_t bits = 0;
    visit_textures(m,
                   [&](const MaterialTexture&, const TextureSlot& s) { bits |= std::uint64_t{1} << (s.uv_set & 63); });
    return bits;
  };
  if (sets(a) != sets(b) || needs_tangents(a) != needs_tangents(b)) return false;
  if (!needs_tangents(a)) return true;
  return same(tangent_slot(a), tangent_slot(b)) &&
         same(layer_tangent_slot(a, kCoatTangents), layer_tangent_slot(b, kCoatTangents)) &&
         same(layer_tangent_slot(a, kGrainTangents), layer_tangent_slot(b, kGrainTangents));
}

// Reads the materials of an import anew, in the order that they have. Returns whether the meshes are still theirs.
bool read_materials_again(Import& import, const gltf::MaterialMap& before, const std::vector<Material>& materials) {
  if (!before.crowded.empty()) return false; // some are versions for single primitives
  std::vector<int> order(before.materials.size());
  for (const auto& [material, index] : before.materials) order[index] = material;
  for (const int material : order) gltf::use_material(import.document, import.scene, import.materials, material);
  for (std::size_t i = 0; i < order.size(); ++i)
    if (!reads_alike(materials[i], import.scene.materials[i])) return false;
  return true;
}

// Whether every instance and vertex is where it was. Meshes that went over have left nothing in `before`.
bool has_same_shape(const Scene& before, const Scene& scene) {
  const auto same_mesh = [](const Mesh& a, const Mesh& b) {
    return a.positions == b.positions && a.normals == b.normals && a.tangents == b.tangents;
  };
  if (before.volume != scene.volume) return false;
  if (before.instances.size() < scene.instances.size()) return false; // others may have added some
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance &a = before.instances[i], &b = scene.instances[i];
    if (a.world_from_object != b.world_from_object || a.mesh != b.mesh) return false;
    const Mesh& kept = before.meshes[a.mesh]; // without vertices where it went over
    if (!kept.positions.empty() && !same_mesh(kept, scene.meshes[b.mesh])) return false;
  }
  return true;
}

} // namespace

struct GltfFile::State {
  gltf::Document document;
  gltf::Imported imported;
  std::map<std::size_t, std::vector<double>> file_matrices{}; // of nodes whose matrix was replaced
  bool is_still = false, keeps_materials = true, forgets_meshes = false;
};

GltfFile::GltfFile(const std::filesystem::path& path) : state_(new State{gltf::open_document(path), {}}) {}

GltfFile::~GltfFile() = default;

bool GltfFile::is_still() const { return state_->is_still; }

bool GltfFile::keeps_materials() const { return state_->keeps_materials; }

void GltfFile::set_matrix(std::size_t node, const std::optional<glm::dmat4>& matrix) {
  std::vector<double>& own = state_->document.model.nodes.at(node).matrix;
  state_->file_matrices.try_emplace(node, own);
  own = matrix ? std::vector<double>(glm::value_ptr(*matrix), glm::value_ptr(*matrix) + 16)
               : state_->file_matrices.at(node);
  if (matrix)
    state_->document.told_matrices.insert(node);
  else
    state_->document.told_matrices.erase(node);
}

void GltfFile::set_visible(std::size_t node, bool is_visible) {
  gltf::set_hidden(state_->document.model.nodes.at(node), !is_visible);
  state_->document.told_hidden.insert(node);
}

glm::dmat4 GltfFile::matrix(std::size_t node) const {
  return gltf::local_matrix(state_->document.model.nodes.at(node), gltf::Scales::authored);
}

bool GltfFile::is_visible(std::size_t node) const { return !gltf::is_hidden(state_->document.model.nodes.at(node)); }

std::size_t GltfFile::node_count() const { return state_->document.model.nodes.size(); }

void GltfFile::forget_meshes() { state_->forgets_meshes = true; }

std::size_t GltfFile::material_count() const { return state_->imported.material_count; }

Scene GltfFile::load(const LoadOptions& options, const SceneDescribed& described) {
  Document& document = state_->document;
  gltf::choose_variant(document, options.variant);
  document.keeps_textures = gltf::animates_materials(document, options.animation);
  if (options.shutter) return load_motion(document, options, true, described, &state_->imported);
  return load_moment(document, options, options.at, {}, true, described, &state_->imported);
}

Scene GltfFile::pose(const LoadOptions& options, Scene before) {
  Document& document = state_->document;
  Imported& imported = state_->imported;
  const bool other_variant = gltf::choose_variant(document, options.variant);
  const bool moves_materials = gltf::animates_materials(document, options.animation);
  state_->keeps_materials = !other_variant && !moves_materials;
  if (options.shutter) { // motion changes meshes, so that all are read again
    const gltf::ImageMap images = std::move(imported.materials.images);
    Scene scene = load_motion(document, options, false, {}, &imported);
    take_next_images(document, images, std::move(before.images), imported, scene);
    state_->is_still = false;
    return scene;
  }
  Scene scene = begin_scene(document);
  Import import{document, scene, pose_nodes(document, scene, options, options.at, {})};
  const std::vector<int> nodes = gltf::scene_nodes(document, options.scene);
  const std::vector<bool> hidden = gltf::hidden_nodes(document);
  const gltf::ImageMap images = imported.materials.images;
  const std::size_t known = imported.material_count;
  before.materials.resize(known);
  if (!moves_materials) {
    import.materials = std::move(imported.materials);
    scene.materials = std::move(before.materials);
  } else if (!read_materials_again(import, imported.materials, before.materials)) {
    import.materials = {};
    scene.materials.clear();
    convert_materials(import, nodes, hidden, options.keeps_hidden);
    state_->forgets_meshes = true;
  }
  state_->forgets_meshes |= other_variant; // primitives show other materials
  for (auto& [use, mesh] : imported.meshes)
    if (use.skin < 0 && !before.meshes[mesh].moves() && !state_->forgets_meshes)
      import.read_before.emplace(use, std::move(before.meshes[mesh]));
  place_nodes(import, nodes, hidden, options);
  imported = {std::move(import.materials), std::move(import.meshes), scene.materials.size(), imported.holds_values};
  state_->is_still = !state_->forgets_meshes && has_same_shape(before, scene);
  state_->forgets_meshes = false;
  if (!moves_materials && scene.materials.size() == known)
    scene.images = std::move(before.images);
  else
    take_next_images(document, images, std::move(before.images), imported, scene);
  state_->keeps_materials &= imported.materials.images.sources.size() == images.sources.size();
  return scene;
}

Scene load_gltf(const std::filesystem::path& path, const LoadOptions& options, const SceneDescribed& described) {
  return GltfFile(path).load(options, described);
}

} // namespace wavepath
