// Shapes of pbrt-v4 as triangles, with what lights them and what they are made of.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/convert/mesh_files.h"
#include "host/convert/pbrt_reader.h"
#include "host/convert/shapes.h"
#include "host/convert/textures.h"

namespace wavepath::convert {
namespace {

constexpr double kShapeDegree = 3.141592653589793 / 180.0;

template <class Vector>
std::vector<Vector> vectors(PbrtReader& reader, const PbrtParam* param, std::size_t size) {
  std::vector<Vector> out;
  if (!param) return out;
  if (param->numbers.size() % size) reader.tokens.fail(fmt::format("\"{}\" has a part of a point", param->name));
  for (std::size_t i = 0; i < param->numbers.size(); i += size) {
    Vector v(0.0f);
    for (std::size_t k = 0; k < size; ++k) v[static_cast<int>(k)] = static_cast<float>(param->numbers[i + k]);
    out.push_back(v);
  }
  return out;
}

// Indices in groups of `size`, all of vertices that exist.
std::vector<std::uint32_t> indices_of(PbrtReader& reader, const PbrtParam* param, std::size_t vertices,
                                      std::size_t size) {
  std::vector<std::uint32_t> out;
  if (!param) {
    if (vertices != size) reader.tokens.fail("a mesh has no indices");
    for (std::uint32_t i = 0; i < size; ++i) out.push_back(i);
    return out;
  }
  if (param->numbers.size() % size) reader.tokens.fail("indices of a mesh have a part of a face");
  for (const double index : param->numbers) {
    if (!(index >= 0.0) || index >= static_cast<double>(vertices))
      reader.tokens.fail(fmt::format("a mesh has vertex {} among its indices, of {} vertices", index, vertices));
    out.push_back(static_cast<std::uint32_t>(index));
  }
  return out;
}

// P, N and uv, whose v grows upwards.
Mesh read_vertices(PbrtReader& reader, const PbrtParams& params) {
  Mesh mesh;
  mesh.positions = vectors<glm::vec3>(reader, params.find("P"), 3);
  mesh.normals = vectors<glm::vec3>(reader, params.find("N"), 3);
  mesh.uvs = vectors<glm::vec2>(reader, params.find("uv"), 2);
  if (mesh.positions.empty()) reader.tokens.fail("a mesh has no points \"P\"");
  if (!mesh.normals.empty() && mesh.normals.size() != mesh.positions.size())
    reader.tokens.fail("a mesh has other counts of P and N");
  if (!mesh.uvs.empty() && mesh.uvs.size() != mesh.positions.size())
    reader.tokens.fail("a mesh has other counts of P and uv");
  for (glm::vec2& uv : mesh.uvs) uv.y = 1.0f - uv.y;
  if (params.find("S")) reader.scene.losses.add("tangents of a mesh: those of its texture coordinates instead");
  params.find("faceIndices");
  return mesh;
}

Mesh read_triangles(PbrtReader& reader, const PbrtParams& params) {
  Mesh mesh = read_vertices(reader, params);
  mesh.indices = indices_of(reader, params.find("indices"), mesh.positions.size(), 3);
  return mesh;
}

Mesh read_patches(PbrtReader& reader, const PbrtParams& params) {
  Mesh mesh = read_vertices(reader, params);
  const std::vector<std::uint32_t> corners = indices_of(reader, params.find("indices"), mesh.positions.size(), 4);
  for (std::size_t i = 0; i < corners.size(); i += 4) {
    const auto at = [&](std::size_t k) { return glm::dvec3(mesh.positions[corners[i + k]]); };
    const glm::dvec3 normal = glm::cross(at(1) - at(0), at(2) - at(0)), diagonal = at(3) - at(0);
    if (std::abs(glm::dot(normal, diagonal)) > 1e-3 * glm::length(normal) * glm::length(diagonal))
      reader.scene.losses.add("patch of a bilinear mesh that is not flat: two triangles instead");
    mesh.indices.insert(mesh.indices.end(),
                        {corners[i], corners[i + 1], corners[i + 3], corners[i], corners[i + 3], corners[i + 2]});
  }
  if (mesh.uvs.empty() && corners.size() == 4 && mesh.positions.size() == 4)
    mesh.uvs = {{0, 1}, {1, 1}, {0, 0}, {1, 0}};
  return mesh;
}

Mesh read_subdivision(PbrtReader& reader, const PbrtParams& params) {
  const Mesh control = read_triangles(reader, params);
  const int levels = static_cast<int>(std::clamp(params.number("levels", 3.0), 0.0, 6.0));
  if (control.indices.size() << (2 * levels) > 100'000'000) {
    reader.scene.losses.add("subdivision surface: its control mesh instead");
    return subdivided(control, 0);
  }
  params.find("scheme");
  return subdivided(control, levels);
}

// A mesh of unit size, and the matrix that gives it the size of the shape.
struct Sized {
  Mesh mesh;
  glm::dmat4 matrix{1.0};
};

Sized read_quadric(PbrtReader& reader, const std::string& type, const PbrtParams& params) {
  const double radius = std::abs(params.number("radius", 1.0));
  const double phi = std::clamp(params.number("phimax", 360.0), 0.01, 360.0) * kShapeDegree;
  Sized sized;
  sized.matrix[0][0] = sized.matrix[1][1] = sized.matrix[2][2] = radius;
  if (type == "sphere") {
    const double lo = params.number("zmin", -radius), hi = params.number("zmax", radius);
    if (radius > 0.0) sized.mesh = sphere(std::min(lo, hi) / radius, std::max(lo, hi) / radius, phi);
  } else if (type == "disk") {
    sized.mesh = disk(radius > 0.0 ? std::clamp(params.number("innerradius", 0.0) / radius, 0.0, 1.0) : 0.0, phi);
    sized.matrix[3][2] = params.number("height", 0.0);
  } else {
    const double lo = params.number("zmin", -1.0), hi = params.number("zmax", 1.0);
    sized.mesh = cylinder(phi);
    sized.matrix[2][2] = hi - lo;
    sized.matrix[3][2] = lo;
  }
  reader.scene.losses.add(fmt::format("{} as triangles", type));
  return sized;
}

// The index of a mesh, made once for each source.
template <class Make>
std::uint32_t mesh_index(PbrtReader& reader, const std::string& source, const Make& make) {
  const auto key = std::pair{source, reader.now.is_reversed};
  if (const auto found = reader.meshes.find(key); found != reader.meshes.end() && !source.empty()) return found->second;
  Mesh mesh = make();
  if (const std::uint64_t bad = remove_bad_triangles(mesh)) reader.scene.losses.add("triangle without area", bad);
  if (reader.now.is_reversed) reverse(mesh);
  wind_by_normals(mesh);
  reader.scene.meshes.push_back(std::move(mesh));
  const auto index = static_cast<std::uint32_t>(reader.scene.meshes.size() - 1);
  if (!source.empty()) reader.meshes[key] = index;
  return index;
}

// Names what a quadric is made of, so that equal ones share their triangles.
std::string quadric_key(const std::string& type, const PbrtParams& params) {
  const double radius = std::abs(params.number("radius", 1.0));
  if (type == "cylinder") return fmt::format("cylinder {}", params.number("phimax", 360.0));
  if (type == "disk")
    return fmt::format("disk {} {}", params.number("innerradius", 0.0) / radius, params.number("phimax", 360.0));
  return fmt::format("sphere {} {} {}", params.number("zmin", -radius) / radius, params.number("zmax", radius) / radius,
                     params.number("phimax", 360.0));
}

// The material of a shape: with its light, its alpha and what it encloses.
std::uint32_t material_of_shape(PbrtReader& reader, const PbrtParams& params, std::uint32_t mesh,
                                const glm::dmat4& matrix, bool& is_visible) {
  Description& scene = reader.scene;
  Material material = scene.materials[reader.now.material];
  std::string key = fmt::format("{}", reader.now.material);
  is_visible = !material.is_boundary || reader.now.area_light.has_value();
  if (const PbrtParam* alpha = params.find("alpha")) {
    const Texture texture = read_scalar(reader, params, "alpha", 1.0);
    key += fmt::format("|alpha {} {} {}", alpha->type == "texture" ? alpha->strings[0] : "", texture.factor.x,
                       texture.image);
    material.alpha = texture;
  }
  if (const auto medium = reader.media.find(reader.now.inside); medium != reader.media.end()) {
    if (material.transmission > 0.0 && material.volume) {
      material.absorption = medium->second.absorption;
      key += "|inside " + reader.now.inside;
      material.scattering = medium->second.scattering;
      material.anisotropy_of_scattering = medium->second.anisotropy;
      if (medium->second.voxels) scene.losses.add("medium of voxels within glass");
    } else if (material.is_boundary) {
      fill_boundary(reader, medium->first, scene.meshes[mesh], matrix);
    }
  }
  if (reader.now.area_light) {
    const bool by_power = reader.now.area_light->has("power");
    const PbrtEmission emission =
        read_area_light(reader, *reader.now.area_light, by_power ? area(scene.meshes[mesh], matrix) : 0.0);
    material.emission = emission.radiance;
    material.double_sided = emission.both_sides;
    if (material.is_boundary) material.base = constant(0.0);
    key += fmt::format("|light {} {} {} {} {}", emission.radiance.factor.x, emission.radiance.factor.y,
                       emission.radiance.factor.z, emission.radiance.image, emission.both_sides);
  }
  if (key.find('|') == std::string::npos) return reader.now.material;
  const auto [found, is_new] = reader.variants.emplace(key, static_cast<std::uint32_t>(scene.materials.size()));
  if (is_new) scene.materials.push_back(material);
  return found->second;
}

} // namespace

void read_shape(PbrtReader& reader, const std::string& type, const PbrtParams& params) {
  Shape shape;
  shape.matrix = reader.now.transform;
  if (type == "trianglemesh") {
    shape.mesh = mesh_index(reader, "", [&] { return read_triangles(reader, params); });
  } else if (type == "bilinearmesh") {
    shape.mesh = mesh_index(reader, "", [&] { return read_patches(reader, params); });
  } else if (type == "loopsubdiv") {
    shape.mesh = mesh_index(reader, "", [&] { return read_subdivision(reader, params); });
  } else if (type == "plymesh") {
    const std::string path = reader.tokens.resolved(params.text("filename", ""));
    shape.mesh = mesh_index(reader, path, [&] { return read_ply(path, true); });
    shape.name = std::filesystem::path(path).stem().string();
    if (params.has("displacement")) reader.scene.losses.add("displacement of a mesh");
    params.find("edgelength");
  } else if (type == "sphere" || type == "disk" || type == "cylinder") {
    const Sized sized = read_quadric(reader, type, params);
    if (sized.mesh.indices.empty()) return;
    shape.mesh = mesh_index(reader, quadric_key(type, params), [&] { return sized.mesh; });
    shape.matrix = shape.matrix * sized.matrix;
    shape.name = type;
  } else {
    reader.scene.losses.add(fmt::format("shape '{}' left out", type));
    return;
  }
  bool is_visible = true;
  shape.material = material_of_shape(reader, params, shape.mesh, shape.matrix, is_visible);
  tell_unused(reader, fmt::format("shape '{}'", type), params);
  if (!is_visible) {
    const auto medium = reader.media.find(reader.now.inside);
    if (medium == reader.media.end() || !medium->second.voxels)
      reader.scene.losses.add("boundary of a medium without a surface left out");
    return;
  }
  if (reader.group)
    reader.scene.groups[*reader.group].push_back(shape);
  else
    reader.scene.shapes.push_back(shape);
}

} // namespace wavepath::convert
