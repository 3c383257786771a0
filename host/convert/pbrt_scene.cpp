#include "host/convert/pbrt_scene.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/convert/pbrt_reader.h"

namespace wavepath::convert {
namespace {

constexpr std::size_t kMostSaved = 4096; // AttributeBegin without an end

glm::dvec3 read_triple(PbrtTokens& tokens) {
  const double x = read_number(tokens), y = read_number(tokens), z = read_number(tokens);
  return {x, y, z};
}

// Sixteen numbers, column by column.
glm::dmat4 read_matrix_words(PbrtTokens& tokens) {
  const bool in_brackets = tokens.peek().kind == PbrtToken::Kind::open;
  if (in_brackets) tokens.next();
  glm::dmat4 matrix;
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r) matrix[c][r] = read_number(tokens);
  if (in_brackets && tokens.next().kind != PbrtToken::Kind::close) tokens.fail("a matrix has no 16 numbers");
  return matrix;
}

// What a transform does where only one of the shutter's moments is meant.
void transform(PbrtReader& reader, const glm::dmat4& matrix, bool replaces = false) {
  if (!reader.now.at_start || !reader.now.at_end)
    reader.scene.losses.add("motion of a transform: where it is when the shutter opens");
  if (!reader.now.at_start) return;
  reader.now.transform = replaces ? matrix : reader.now.transform * matrix;
}

glm::dmat4 look_at(PbrtReader& reader) {
  const glm::dvec3 eye = read_triple(reader.tokens), to = read_triple(reader.tokens), up = read_triple(reader.tokens);
  const glm::dvec3 ahead = glm::normalize(to - eye), right = glm::normalize(glm::cross(glm::normalize(up), ahead));
  glm::dmat4 world_from_camera(1.0);
  world_from_camera[0] = glm::dvec4(right, 0.0);
  world_from_camera[1] = glm::dvec4(glm::cross(ahead, right), 0.0);
  world_from_camera[2] = glm::dvec4(ahead, 0.0);
  world_from_camera[3] = glm::dvec4(eye, 1.0);
  if (!(std::abs(glm::determinant(world_from_camera)) > 0.5)) reader.tokens.fail("LookAt has no direction");
  return glm::inverse(world_from_camera);
}

void save(PbrtReader& reader) {
  if (reader.saved.size() >= kMostSaved) reader.tokens.fail("nests attributes too deep");
  reader.saved.push_back(reader.now);
}

void restore(PbrtReader& reader) {
  if (reader.saved.empty()) reader.tokens.fail("has an end without a begin");
  reader.now = std::move(reader.saved.back());
  reader.saved.pop_back();
}

// The parameters of a directive, then those that Attribute set for its kind.
PbrtParams params_for(PbrtReader& reader, const char* kind) {
  PbrtParams params = read_params(reader.tokens);
  if (const auto found = reader.now.defaults.find(kind); found != reader.now.defaults.end())
    for (const PbrtParam& param : found->second.all) {
      bool is_given = false;
      for (const PbrtParam& own : params.all) is_given |= own.name == param.name;
      if (!is_given) {
        params.all.push_back(param);
        params.all.back().is_used = true; // whoever it does not fit does not miss it
      }
    }
  return params;
}

void make_named_medium(PbrtReader& reader) {
  const std::string name = read_string(reader.tokens);
  read_medium(reader, name, params_for(reader, "medium"));
}

void read_named_material(PbrtReader& reader) {
  const std::string name = read_string(reader.tokens);
  const PbrtParams params = params_for(reader, "material");
  if (!params.has("type")) reader.tokens.fail(fmt::format("material '{}' has no type", name));
  Material material = read_material(reader, params.text("type", ""), params);
  material.name = name;
  reader.materials[name] = static_cast<std::uint32_t>(reader.scene.materials.size());
  reader.scene.materials.push_back(std::move(material));
}

void use_named_material(PbrtReader& reader) {
  const std::string name = read_string(reader.tokens);
  const auto found = reader.materials.find(name);
  if (found == reader.materials.end()) reader.tokens.fail(fmt::format("material '{}' is not there", name));
  reader.now.material = found->second;
}

void begin_object(PbrtReader& reader) {
  const std::string name = read_string(reader.tokens);
  if (reader.group) reader.tokens.fail("has an object within an object");
  save(reader);
  const auto [found, is_new] = reader.groups.emplace(name, static_cast<std::uint32_t>(reader.scene.groups.size()));
  if (!is_new) reader.tokens.fail(fmt::format("object '{}' is there already", name));
  reader.group = found->second;
  reader.scene.groups.emplace_back();
}

void end_object(PbrtReader& reader) {
  if (!reader.group) reader.tokens.fail("has an ObjectEnd without a begin");
  reader.group.reset();
  restore(reader);
}

void use_object(PbrtReader& reader) {
  const std::string name = read_string(reader.tokens);
  const auto found = reader.groups.find(name);
  if (found == reader.groups.end()) reader.tokens.fail(fmt::format("object '{}' is not there", name));
  if (reader.group) reader.tokens.fail("has an instance within an object");
  reader.scene.uses.push_back({found->second, reader.now.transform});
}

void set_active(PbrtReader& reader) {
  const std::string_view which = reader.tokens.next().text;
  reader.now.at_start = which != "EndTime";
  reader.now.at_end = which != "StartTime";
}

void set_defaults(PbrtReader& reader) {
  const std::string kind = read_string(reader.tokens);
  const PbrtParams params = read_params(reader.tokens);
  PbrtParams& all = reader.now.defaults[kind];
  for (const PbrtParam& param : params.all) {
    std::erase_if(all.all, [&](const PbrtParam& old) { return old.name == param.name; });
    all.all.push_back(param);
  }
}

void read_texture_directive(PbrtReader& reader) {
  const std::string name = read_string(reader.tokens), type = read_string(reader.tokens),
                    kind = read_string(reader.tokens);
  read_texture(reader, name, type, kind, params_for(reader, "texture"));
}

void read_integrator(PbrtReader& reader) {
  read_string(reader.tokens);
  const PbrtParams params = read_params(reader.tokens);
  reader.scene.max_depth = 5;
  if (params.has("maxdepth"))
    reader.scene.max_depth = static_cast<int>(std::clamp(params.number("maxdepth", 5.0), 0.0, 1000.0));
}

void pass_over(PbrtReader& reader) {
  read_string(reader.tokens);
  read_params(reader.tokens);
}

void read_world(PbrtReader& reader) {
  reader.in_world = true;
  reader.now.transform = glm::dmat4(1.0);
  reader.now.at_start = reader.now.at_end = true;
  reader.coordinate_systems["world"] = glm::dmat4(1.0);
}

void place_light_source(PbrtReader& reader) {
  const std::string type = read_string(reader.tokens);
  read_light(reader, type, params_for(reader, "light"));
}

void rotate(PbrtReader& reader) {
  const double degrees = read_number(reader.tokens);
  const glm::dvec3 axis = read_triple(reader.tokens);
  if (!(glm::length(axis) > 0.0)) reader.tokens.fail("Rotate has no axis");
  transform(reader, glm::rotate(glm::dmat4(1.0), glm::radians(degrees), glm::normalize(axis)));
}

void use_coordinate_system(PbrtReader& reader) {
  const auto found = reader.coordinate_systems.find(read_string(reader.tokens));
  if (found == reader.coordinate_systems.end()) reader.tokens.fail("a coordinate system is not there");
  transform(reader, found->second, true);
}

void read_camera_directive(PbrtReader& reader) {
  const std::string type = read_string(reader.tokens);
  read_camera(reader, type, read_params(reader.tokens));
}

void use_material(PbrtReader& reader) {
  const std::string type = read_string(reader.tokens);
  Material material = read_material(reader, type, params_for(reader, "material"));
  reader.now.material = static_cast<std::uint32_t>(reader.scene.materials.size());
  reader.scene.materials.push_back(std::move(material));
}

void read_shape_directive(PbrtReader& reader) {
  const std::string type = read_string(reader.tokens);
  read_shape(reader, type, params_for(reader, "shape"));
}

void set_area_light(PbrtReader& reader) {
  const std::string type = read_string(reader.tokens);
  PbrtParams params = params_for(reader, "light");
  if (type != "diffuse") reader.tokens.fail(fmt::format("area light '{}' is none of pbrt-v4", type));
  reader.now.area_light = std::move(params);
}

void set_media(PbrtReader& reader) {
  reader.now.inside = read_string(reader.tokens);
  if (reader.tokens.peek().kind == PbrtToken::Kind::string && !read_string(reader.tokens).empty())
    reader.scene.losses.add("medium around surfaces or the camera");
}

void set_color_space(PbrtReader& reader) {
  if (read_string(reader.tokens) != "srgb") reader.scene.losses.add("colour space of the file: sRGB instead");
}

void read_include(PbrtReader& reader) {
  const std::string name = read_string(reader.tokens);
  reader.tokens.include(reader.tokens.resolved(name));
}

using Directive = void (*)(PbrtReader&);

const std::map<std::string_view, Directive>& directives() {
  static const std::map<std::string_view, Directive> kDirectives = {
      {"ActiveTransform", set_active},
      {"AreaLightSource", set_area_light},
      {"Attribute", set_defaults},
      {"AttributeBegin", save},
      {"AttributeEnd", restore},
      {"Camera", read_camera_directive},
      {"ColorSpace", set_color_space},
      {"ConcatTransform", [](PbrtReader& reader) { transform(reader, read_matrix_words(reader.tokens)); }},
      {"CoordSysTransform", use_coordinate_system},
      {"CoordinateSystem",
       [](PbrtReader& reader) { reader.coordinate_systems[read_string(reader.tokens)] = reader.now.transform; }},
      {"Film",
       [](PbrtReader& reader) {
         read_string(reader.tokens);
         read_film(reader, read_params(reader.tokens));
       }},
      {"Identity", [](PbrtReader& reader) { transform(reader, glm::dmat4(1.0), true); }},
      {"Import", read_include},
      {"Include", read_include},
      {"Integrator", read_integrator},
      {"LightSource", place_light_source},
      {"LookAt", [](PbrtReader& reader) { transform(reader, look_at(reader)); }},
      {"MakeNamedMaterial", read_named_material},
      {"MakeNamedMedium", make_named_medium},
      {"Material", use_material},
      {"MediumInterface", set_media},
      {"NamedMaterial", use_named_material},
      {"ObjectBegin", begin_object},
      {"ObjectEnd", end_object},
      {"ObjectInstance", use_object},
      {"Option", [](PbrtReader& reader) { read_params(reader.tokens); }},
      {"PixelFilter", pass_over},
      {"ReverseOrientation", [](PbrtReader& reader) { reader.now.is_reversed = !reader.now.is_reversed; }},
      {"Rotate", rotate},
      {"Sampler", pass_over},
      {"Accelerator", pass_over},
      {"Scale", [](PbrtReader& reader) { transform(reader, glm::scale(glm::dmat4(1.0), read_triple(reader.tokens))); }},
      {"Shape", read_shape_directive},
      {"Texture", read_texture_directive},
      {"Transform", [](PbrtReader& reader) { transform(reader, read_matrix_words(reader.tokens), true); }},
      {"TransformBegin", save},
      {"TransformEnd", restore},
      {"TransformTimes",
       [](PbrtReader& reader) {
         read_number(reader.tokens);
         read_number(reader.tokens);
       }},
      {"Translate",
       [](PbrtReader& reader) { transform(reader, glm::translate(glm::dmat4(1.0), read_triple(reader.tokens))); }},
      {"WorldBegin", read_world},
      {"WorldEnd", [](PbrtReader&) {}},
  };
  return kDirectives;
}

} // namespace

Description read_pbrt(const std::string& path) {
  PbrtReader reader(path);
  reader.scene.format = "pbrt-v4";
  reader.scene.materials.push_back(read_material(reader, "diffuse", {})); // of shapes before the first material
  for (;;) {
    const PbrtToken token = reader.tokens.next();
    if (token.kind == PbrtToken::Kind::end) break;
    const auto found = token.kind == PbrtToken::Kind::word ? directives().find(token.text) : directives().end();
    if (found == directives().end())
      reader.tokens.fail(fmt::format("'{}' is no directive of pbrt-v4", token.text.substr(0, 40)));
    found->second(reader);
  }
  if (!reader.in_world) reader.tokens.fail("has no WorldBegin", "give the scene's main file");
  if (reader.group || !reader.saved.empty()) reader.scene.losses.add("begin without an end");
  finish_camera(reader);
  return std::move(reader.scene);
}

} // namespace wavepath::convert
