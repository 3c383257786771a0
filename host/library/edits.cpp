// Edits of a resident scene.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <wavepath/session.h>
#include <glm/glm.hpp>

#include "host/base/error.h"
#include "host/base/overloaded.h"
#include "host/library/field_value.h"
#include "host/library/guard.h"
#include "host/library/session_state.h"
#include "host/render/settings/flag_value.h"
#include "host/scene/material.h"
#include "host/scene/scene.h"

namespace wavepath_v0 {
namespace {

using wavepath::Material;

// Calls visit(name, values, count, lo, hi) for each field of numbers.
template <class Visit>
void visit_numbers(Material& m, const Visit& visit) {
  wavepath::visit_material_fields(wavepath::Overloaded{
      [&](const wavepath::MaterialFactor<float>& row) { visit(row.name, &(m.*row.field), 1, row); },
      [&](const wavepath::MaterialFactor<glm::vec3>& row) { visit(row.name, &(m.*row.field)[0], 3, row); },
      [&](const wavepath::MaterialFactor<glm::vec4>& row) { visit(row.name, &(m.*row.field)[0], 4, row); },
      [](const auto&) {}});
}

std::vector<std::string> list_fields() {
  std::vector<std::string> names;
  Material any;
  visit_numbers(any, [&](const char* name, float*, int, const auto&) { names.emplace_back(name); });
  names.emplace_back("double_sided");
  return names;
}

std::vector<std::string> list_textures() {
  std::vector<std::string> names;
  wavepath::visit_material_fields(wavepath::Overloaded{
      [&](const wavepath::MaterialTexture& row) { names.emplace_back(row.name); }, [](const auto&) {}});
  return names;
}

[[noreturn]] void refuse_field(const std::string& name, const std::vector<std::string>& known) {
  throw wavepath::UsageError(name, "is no field of a material", wavepath::suggestion(name, known));
}

// The material as it will be after update().
Material material_of(const SessionState& state, std::size_t material) {
  if (const auto found = state.edited.find(material); found != state.edited.end()) return found->second;
  const std::vector<Material>& all = state.session->scene().materials;
  if (material >= all.size())
    throw wavepath::UsageError("material", fmt::format("{} does not exist", material),
                               fmt::format("the scene has {}", all.size()));
  return all[material];
}

void edit_material(SessionState& state, std::size_t index, const Material& material) {
  state.session->set_material(index, material);
  state.edited[index] = material;
}

wavepath::Image image_of(const std::string& name, const Texels& texels) {
  const std::size_t count = std::size_t{texels.width} * texels.height;
  const bool bytes = !texels.bytes.empty();
  const std::size_t given = bytes ? texels.bytes.size() : texels.floats.size();
  if (texels.channels < 1 || texels.channels > 4 || count == 0 || given != count * texels.channels)
    throw wavepath::UsageError(name,
                               fmt::format("has {} values for {}x{} texels of {} channels", given, texels.width,
                                           texels.height, texels.channels),
                               "give height x width x 1 to 4 values");
  wavepath::Image image{.name = name, .width = texels.width, .height = texels.height, .bytes = {}, .floats = {}};
  const auto fill = [&](auto& out, const auto& in, auto one) {
    out.resize(4 * count);
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t c = 0; c < 4; ++c)
        out[4 * i + c] = c < texels.channels     ? in[i * texels.channels + c]
                         : c == 3                ? one
                         : texels.channels == 1u ? in[i]
                                                 : decltype(one){};
  };
  if (bytes)
    fill(image.bytes, texels.bytes, std::uint8_t{255});
  else
    fill(image.floats, texels.floats, 1.0f);
  return image;
}

glm::dmat4 matrix_of(const Matrix4& rows) {
  glm::dmat4 matrix;
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) matrix[c][r] = rows[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)];
  return matrix;
}

template <class Vector>
std::vector<Vector> vectors_of(const std::string& what, const std::vector<float>& values) {
  constexpr std::size_t kCount = Vector::length();
  if (values.size() % kCount != 0)
    throw wavepath::UsageError(what, fmt::format("has {} values, no multiple of {}", values.size(), kCount),
                               fmt::format("give count x {} numbers", kCount));
  std::vector<Vector> vectors(values.size() / kCount);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) throw wavepath::UsageError(what, "holds a value that is not finite", "mend it");
    vectors[i / kCount][static_cast<int>(i % kCount)] = values[i];
  }
  return vectors;
}

wavepath::Mesh mesh_of(const MeshData& data) {
  wavepath::Mesh mesh;
  mesh.name = data.name;
  mesh.positions = vectors_of<glm::vec3>("vertices", data.positions);
  mesh.normals = vectors_of<glm::vec3>("normals", data.normals);
  for (glm::vec3& normal : mesh.normals)
    if (const float length = glm::length(normal); length > 0.0f) normal /= length;
  mesh.uvs[0] = mesh.uvs[1] = vectors_of<glm::vec2>("uvs", data.uvs);
  mesh.indices = data.indices;
  if (mesh.indices.empty() || mesh.indices.size() % 3 != 0)
    throw wavepath::UsageError("faces", fmt::format("have {} indices", mesh.indices.size()), "give count x 3 indices");
  mesh.primitives.push_back({.first_index = 0,
                             .index_count = static_cast<std::uint32_t>(mesh.indices.size()),
                             .material = static_cast<std::uint32_t>(data.material),
                             .has_normals = !mesh.normals.empty()});
  if (mesh.normals.empty()) mesh.normals.assign(mesh.positions.size(), glm::vec3(0.0f));
  return mesh;
}

} // namespace

const std::vector<std::string>& Session::material_fields() {
  static const std::vector<std::string> names = list_fields();
  return names;
}

const std::vector<std::string>& Session::material_textures() {
  static const std::vector<std::string> names = list_textures();
  return names;
}

std::vector<double> Session::material(std::size_t material, const std::string& field) const {
  return wavepath::guarded([&] {
    const DeviceLock lock(*state_->device);
    Material copy = material_of(*state_, material);
    std::vector<double> value;
    if (field == "double_sided") return std::vector<double>{copy.double_sided ? 1.0 : 0.0};
    visit_numbers(copy, [&](const char* name, const float* values, int count, const auto&) {
      if (field == name) value.assign(values, values + count);
    });
    if (value.empty()) refuse_field(field, material_fields());
    return value;
  });
}

void Session::set_material(std::size_t material, const std::string& field, const std::vector<double>& value) {
  wavepath::guarded([&] {
    const DeviceLock lock(*state_->device);
    Material copy = material_of(*state_, material);
    bool found = field == "double_sided";
    if (found) {
      check_value(field, value, 1);
      copy.double_sided = value[0] != 0.0;
    }
    visit_numbers(copy, [&](const char* name, float* values, int count, const auto& row) {
      if (field != name) return;
      found = true;
      check_value(field, value, static_cast<std::size_t>(count));
      // The file's emission is a factor times a strength, and absorption is computed of a colour and a distance.
      const bool is_open = field == "emission" || field == "attenuation" || field == "scattering";
      const double highest = is_open ? 1e30 : row.hi;
      for (const double number : value)
        if ((number < row.lo || number > highest) && !(row.or_zero && number == 0.0))
          throw wavepath::UsageError(field, fmt::format("cannot be {}", number),
                                     fmt::format("give {} to {}", row.lo, highest));
      std::ranges::copy(value, values);
    });
    if (!found) refuse_field(field, material_fields());
    edit_material(*state_, material, copy);
  });
}

void Session::set_texture(std::size_t material, const std::string& texture, const Texels& texels) {
  wavepath::guarded([&] {
    const DeviceLock lock(*state_->device);
    Material copy = material_of(*state_, material);
    bool found = false;
    wavepath::visit_material_fields(wavepath::Overloaded{[&](const wavepath::MaterialTexture& row) {
                                                           if (texture != row.name) return;
                                                           found = true;
                                                           wavepath::TextureSlot& slot = copy.*row.field;
                                                           slot.image = static_cast<std::uint32_t>(
                                                               state_->session->add_image(image_of(texture, texels)));
                                                           slot.srgb = row.srgb;
                                                         },
                                                         [](const auto&) {}});
    if (!found) refuse_field(texture, material_textures());
    edit_material(*state_, material, copy);
  });
}

std::size_t Session::add_material(const std::string& name) {
  return wavepath::guarded([&] {
    const DeviceLock lock(*state_->device);
    Material material;
    material.name = name;
    const std::size_t index = state_->session->add_material(material);
    state_->edited[index] = material;
    return index;
  });
}

Matrix4 Session::matrix(std::size_t node) const {
  return wavepath::guarded([&] {
    const DeviceLock lock(*state_->device);
    const glm::dmat4 matrix = state_->session->matrix(node);
    Matrix4 rows{};
    for (int r = 0; r < 4; ++r)
      for (int c = 0; c < 4; ++c) rows[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)] = matrix[c][r];
    return rows;
  });
}

void Session::set_matrix(std::size_t node, const Matrix4& parent_from_node) {
  wavepath::guarded([&] {
    const DeviceLock lock(*state_->device);
    state_->session->set_matrix(node, matrix_of(parent_from_node));
  });
}

void Session::reset_matrix(std::size_t node) {
  wavepath::guarded([&] {
    const DeviceLock lock(*state_->device);
    state_->session->reset_matrix(node);
  });
}

bool Session::is_visible(std::size_t node) const {
  return wavepath::guarded([&] {
    const DeviceLock lock(*state_->device);
    return state_->session->is_visible(node);
  });
}

void Session::set_visible(std::size_t node, bool is_visible) {
  wavepath::guarded([&] {
    const DeviceLock lock(*state_->device);
    state_->session->set_visible(node, is_visible);
  });
}

std::size_t Session::add_mesh(const MeshData& mesh) {
  return wavepath::guarded([&] {
    const DeviceLock lock(*state_->device);
    return state_->session->add_mesh({mesh.name, mesh_of(mesh), matrix_of(mesh.world_from_object), true});
  });
}

void Session::remove_mesh(std::size_t node) {
  wavepath::guarded([&] {
    const DeviceLock lock(*state_->device);
    state_->session->remove_mesh(node);
  });
}

void Session::set_environment(const Texels& radiance, double intensity, double degrees) {
  wavepath::guarded([&] {
    const DeviceLock lock(*state_->device);
    const wavepath::Image image = image_of("environment", radiance);
    if (image.floats.empty())
      throw wavepath::UsageError("environment", "holds bytes", "give linear radiance as floats");
    wavepath::Environment environment{.radiance = glm::vec3(static_cast<float>(intensity)),
                                      .width = image.width,
                                      .height = image.height,
                                      .map = {},
                                      .rotation = glm::radians(degrees)};
    for (std::size_t i = 0; i < image.floats.size(); i += 4) {
      const glm::vec3 value(image.floats[i], image.floats[i + 1], image.floats[i + 2]);
      for (int c = 0; c < 3; ++c)
        if (!(value[c] >= 0.0f && std::isfinite(value[c])))
          throw wavepath::UsageError("environment", "holds radiance that is negative or not finite", "mend it");
      environment.map.push_back(value);
    }
    state_->session->set_environment(std::move(environment));
  });
}

std::vector<Redone> Session::update() {
  return wavepath::guarded([&] {
    const DeviceLock lock(*state_->device);
    const wavepath::SessionUpdate update = state_->session->update();
    state_->edited.clear();
    std::vector<Redone> redone;
    for (const wavepath::Redone& part : update.redone) redone.push_back({part.what, part.milliseconds});
    return redone;
  });
}

} // namespace wavepath_v0
