// Shapes of Mitsuba as triangles.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/convert/mesh_files.h"
#include "host/convert/mitsuba_reader.h"
#include "host/convert/shapes.h"
#include "host/convert/textures.h"

namespace wavepath::convert {
namespace {

struct MitsubaShape {
  std::string key; // of its mesh
  Mesh (*make)() = nullptr;
  glm::dmat4 matrix{1.0};
};

// The frame of a cylinder between two points.
glm::dmat4 along(const glm::dvec3& from, const glm::dvec3& to, double radius) {
  const glm::dvec3 axis = to - from;
  const double length = glm::length(axis);
  const glm::dvec3 z = length > 0.0 ? axis / length : glm::dvec3(0, 0, 1);
  const glm::dvec3 x = glm::normalize(glm::cross(std::abs(z.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0), z));
  glm::dmat4 matrix(1.0);
  matrix[0] = glm::dvec4(radius * x, 0.0), matrix[1] = glm::dvec4(radius * glm::cross(z, x), 0.0);
  matrix[2] = glm::dvec4(axis, 0.0), matrix[3] = glm::dvec4(from, 1.0);
  return matrix;
}

std::optional<MitsubaShape> analytic(MitsubaReader& reader, const pugi::xml_node& node, const std::string& type) {
  const glm::dmat4 one(1.0);
  if (type == "rectangle") return MitsubaShape{type, rectangle, one};
  if (type == "cube") return MitsubaShape{type, cube, one};
  if (type == "disk") return MitsubaShape{type, [] { return disk(); }, one};
  if (type == "sphere") {
    const glm::dvec3 center = read_vector(reader, node, "center", glm::dvec3(0.0));
    const double radius = std::abs(read_float(reader, node, "radius", 1.0));
    return MitsubaShape{type, [] { return sphere(); }, glm::scale(glm::translate(one, center), glm::dvec3(radius))};
  }
  if (type == "cylinder")
    return MitsubaShape{
        type, [] { return cylinder(); },
        along(read_vector(reader, node, "p0", glm::dvec3(0.0)),
              read_vector(reader, node, "p1", glm::dvec3(0.0, 0.0, 1.0)), read_float(reader, node, "radius", 1.0))};
  return std::nullopt;
}

Mesh read_mesh_file(MitsubaReader& reader, const pugi::xml_node& node, const std::string& type, const std::string& path,
                    bool mirrors) {
  Mesh mesh;
  if (type == "obj")
    mesh = read_obj(path, read_bool(reader, node, "flip_tex_coords", true));
  else if (type == "ply")
    mesh = read_ply(path, read_bool(reader, node, "flip_tex_coords", false));
  else
    mesh = read_serialized(
        path, static_cast<std::uint32_t>(std::clamp(read_float(reader, node, "shape_index", 0.0), 0.0, 4e9)));
  if (read_bool(reader, node, "face_normals", false)) mesh.normals.clear();
  const bool has_normals = !mesh.normals.empty();
  if (const std::uint64_t bad = remove_bad_triangles(mesh)) reader.scene.losses.add("triangle without area", bad);
  // Mitsuba takes normals of faces from where their corners are in the world; glTF turns those of mirrored ones back.
  if (mirrors && !has_normals) reverse(mesh);
  if (!has_normals && !read_bool(reader, node, "face_normals", false)) add_normals(mesh);
  return mesh;
}

// The index of a mesh, made once for each key.
template <class Make>
std::uint32_t mesh_of(MitsubaReader& reader, const std::string& key, const Make& make) {
  const auto [found, is_new] = reader.meshes.emplace(key, static_cast<std::uint32_t>(reader.scene.meshes.size()));
  if (is_new) {
    Mesh mesh = make();
    wind_by_normals(mesh);
    reader.scene.meshes.push_back(std::move(mesh));
  }
  return found->second;
}

void set_medium(MitsubaReader& reader, const pugi::xml_node& node, Material& material, std::string& key) {
  const pugi::xml_node medium = named_child(reader, node, "interior");
  if (!medium || (material.is_boundary && is_of_voxels(reader, medium))) return;
  if (attribute(reader, medium, "type") != "homogeneous" || material.transmission == 0.0 || !material.volume) {
    reader.scene.losses.add(material.is_boundary ? "medium in the air"
                                                 : "medium that is not uniform, or in an opaque body");
    return;
  }
  const glm::dvec3 extinction =
      mean(reader.scene, read_texture_of(reader, medium, "sigma_t", 1.0, Meaning::reflectance));
  const glm::dvec3 albedo = mean(reader.scene, read_texture_of(reader, medium, "albedo", 0.75, Meaning::reflectance));
  const glm::dvec3 scale = read_float(reader, medium, "scale", 1.0) * extinction;
  material.scattering = scale * glm::clamp(albedo, 0.0, 1.0);
  material.absorption = scale - material.scattering;
  if (const pugi::xml_node phase = medium.child("phase"); phase && attribute(reader, phase, "type") == "hg")
    material.anisotropy_of_scattering = read_float(reader, phase, "g", 0.8);
  key += fmt::format("|medium {}", medium.hash_value());
}

// Mitsuba's opaque BSDFs reflect on one side.
bool is_black_behind(const MitsubaReader& reader, const pugi::xml_node& bsdf) {
  for (const pugi::xml_node& inner : children_of(reader, bsdf, "bsdf"))
    if (attribute(reader, bsdf, "type") != "twosided" && is_black_behind(reader, inner)) return true;
  const std::string type = attribute(reader, bsdf, "type");
  return type == "diffuse" || type == "roughdiffuse" || type.ends_with("conductor") || type.ends_with("plastic");
}

std::uint32_t material_of(MitsubaReader& reader, const pugi::xml_node& node, bool& is_visible) {
  const std::vector<pugi::xml_node> bsdfs = children_of(reader, node, "bsdf"),
                                    emitters = children_of(reader, node, "emitter");
  std::string key = bsdfs.empty() ? "none" : fmt::format("{}", bsdfs[0].hash_value());
  if (!emitters.empty()) key += fmt::format("|light {}", emitters[0].hash_value());
  const pugi::xml_node interior = named_child(reader, node, "interior");
  if (interior) key += fmt::format("|inside {}", interior.hash_value());
  if (const auto found = reader.materials.find(key); found != reader.materials.end()) {
    const Material& known = reader.scene.materials[found->second];
    is_visible = !known.is_boundary || !emitters.empty();
    return found->second;
  }
  Material material;
  material.base = constant(0.5);
  if (!bsdfs.empty()) material = read_bsdf(reader, bsdfs[0]);
  set_medium(reader, node, material, key);
  is_visible = !material.is_boundary || !emitters.empty();
  if (!emitters.empty()) {
    const std::string type = attribute(reader, emitters[0], "type");
    if (type != "area")
      reader.scene.losses.add(fmt::format("emitter '{}': shines alike in all directions instead", type));
    material.emission = read_texture_of(reader, emitters[0], "radiance", 1.0, Meaning::light);
    material.double_sided = false; // Mitsuba's surfaces shine from the side of their normals
    if (material.is_boundary) material.base = constant(0.0);
  }
  if (!bsdfs.empty() && emitters.empty() && is_black_behind(reader, bsdfs[0]))
    reader.scene.losses.add("black back of a material without <twosided>: it reflects as the front");
  reader.materials[key] = static_cast<std::uint32_t>(reader.scene.materials.size());
  reader.scene.materials.push_back(std::move(material));
  return static_cast<std::uint32_t>(reader.scene.materials.size() - 1);
}

std::optional<Shape> to_shape(MitsubaReader& reader, const pugi::xml_node& node, bool in_group) {
  const std::string type = attribute(reader, node, "type");
  const bool flips = read_bool(reader, node, "flip_normals", false);
  Shape shape;
  shape.name = attribute(reader, node, "id");
  shape.matrix = read_transform(reader, node);
  if (const std::optional<MitsubaShape> made = analytic(reader, node, type)) {
    if (type != "rectangle" && type != "cube") reader.scene.losses.add(fmt::format("{} as triangles", type));
    shape.matrix = shape.matrix * made->matrix;
    shape.mesh = mesh_of(reader, fmt::format("{} {}", made->key, flips), [&] {
      Mesh mesh = made->make();
      if (flips) reverse(mesh);
      return mesh;
    });
  } else if (type == "obj" || type == "ply" || type == "serialized") {
    const std::string path = read_path(reader, node, read_text(reader, node, "filename", ""));
    const bool mirrors = glm::determinant(glm::dmat3(shape.matrix)) < 0.0;
    const std::string key =
        fmt::format("{}|{} {} {} {} {}", path, flips, mirrors, read_bool(reader, node, "face_normals", false),
                    read_float(reader, node, "shape_index", 0.0), read_text(reader, node, "flip_tex_coords", ""));
    shape.mesh = mesh_of(reader, key, [&] {
      Mesh mesh = read_mesh_file(reader, node, type, path, mirrors);
      if (flips) reverse(mesh);
      return mesh;
    });
  } else {
    reader.scene.losses.add(fmt::format("shape '{}' left out", type));
    return std::nullopt;
  }
  tell_unused(reader, node);
  bool is_visible = true;
  shape.material = material_of(reader, node, is_visible);
  if (is_visible) return shape;
  if (const pugi::xml_node medium = named_child(reader, node, "interior"); is_of_voxels(reader, medium)) {
    if (in_group)
      reader.scene.losses.add("medium of voxels in a group of shapes");
    else
      fill_boundary(reader, medium, reader.scene.meshes[shape.mesh], shape.matrix);
    return std::nullopt;
  }
  reader.scene.losses.add("boundary of a medium without a surface left out");
  return std::nullopt;
}

} // namespace

void read_shape_of(MitsubaReader& reader, const pugi::xml_node& node) {
  const std::string type = attribute(reader, node, "type");
  if (type == "shapegroup") return; // read where it is used
  if (type != "instance") {
    if (std::optional<Shape> shape = to_shape(reader, node, false)) reader.scene.shapes.push_back(*std::move(shape));
    return;
  }
  const std::vector<pugi::xml_node> groups = children_of(reader, node, "shape");
  if (groups.empty()) fail_at(reader, node, "an instance names no shape group");
  const std::string key = fmt::format("{}", groups[0].hash_value());
  const auto [found, is_new] = reader.groups.emplace(key, static_cast<std::uint32_t>(reader.scene.groups.size()));
  if (is_new) {
    std::vector<Shape> shapes;
    for (const pugi::xml_node& part : children_of(reader, groups[0], "shape")) {
      if (attribute(reader, part, "type") == "instance") fail_at(reader, part, "a shape group holds an instance");
      if (std::optional<Shape> shape = to_shape(reader, part, true)) shapes.push_back(*std::move(shape));
    }
    reader.scene.groups.push_back(std::move(shapes));
  }
  reader.scene.uses.push_back({found->second, read_transform(reader, node)});
}

} // namespace wavepath::convert
