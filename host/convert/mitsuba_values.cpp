// Spectra and textures of Mitsuba, in its RGB variants.
#include <algorithm>
#include <cmath>
#include <fstream>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/convert/materials.h"
#include "host/convert/mesh_files.h"
#include "host/convert/mitsuba_reader.h"
#include "host/convert/textures.h"

namespace wavepath::convert {
namespace {

constexpr int kDeepestTexture = 16;

SpectrumTable table_from(const MitsubaReader& reader, const pugi::xml_node& node, const std::string& text) {
  const std::vector<double> numbers = numbers_of(reader, node, text);
  if (numbers.empty() || numbers.size() % 2) fail_at(reader, node, "a spectrum has no pairs of wavelength and value");
  SpectrumTable table;
  for (std::size_t i = 0; i < numbers.size(); i += 2) table.emplace_back(numbers[i], numbers[i + 1]);
  std::ranges::stable_sort(table, {}, &SpectrumTable::value_type::first);
  return table;
}

// Lines of wavelength and value; comments begin with #.
SpectrumTable table_of_file(const MitsubaReader& reader, const pugi::xml_node& node, const std::string& path) {
  const std::vector<std::uint8_t> bytes = read_bytes(path);
  std::string text;
  bool in_comment = false;
  for (const std::uint8_t c : bytes) {
    in_comment = c == '#' || (in_comment && c != '\n');
    text += in_comment ? ' ' : static_cast<char>(c);
  }
  return table_from(reader, node, text);
}

// The table of a <spectrum>, if it is one.
std::optional<Spectrum> spectrum_in(const MitsubaReader& reader, const pugi::xml_node& node) {
  const std::string value = attribute(reader, node, "value"), file = attribute(reader, node, "filename");
  if (!file.empty()) return resample(table_of_file(reader, node, read_path(reader, node, file)));
  if (value.find(':') != std::string::npos) return resample(table_from(reader, node, value));
  return std::nullopt;
}

glm::dvec3 rgb_in(const MitsubaReader& reader, const pugi::xml_node& node) {
  const std::string value = attribute(reader, node, "value");
  if (value.starts_with('#')) fail_at(reader, node, "a colour in hexadecimal digits", "write it as three numbers");
  const std::vector<double> numbers = numbers_of(reader, node, value);
  if (numbers.size() == 1) return glm::dvec3(numbers[0]);
  if (numbers.size() != 3) fail_at(reader, node, "a colour has no three numbers");
  return {numbers[0], numbers[1], numbers[2]};
}

glm::dvec3 black_body_color(const MitsubaReader& reader, const pugi::xml_node& node, bool is_plugin) {
  const auto value = [&](const char* name, double otherwise) {
    if (is_plugin) return read_float(reader, node, name, otherwise);
    std::string text = attribute(reader, node, name);
    text.erase(std::remove_if(text.begin(), text.end(), [](char c) { return c == 'K' || c == 'k'; }), text.end());
    const std::vector<double> numbers = numbers_of(reader, node, text);
    return numbers.empty() ? otherwise : numbers[0];
  };
  return light_color(black_body(value("temperature", 6504.0))) * value("scale", 1.0);
}

glm::dvec3 spectrum_color(MitsubaReader& reader, const pugi::xml_node& node, Meaning meaning) {
  const std::string type = attribute(reader, node, "type");
  if (type == "blackbody") return black_body_color(reader, node, true);
  if (type == "d65" || type == "uniform")
    return glm::dvec3(read_float(reader, node, type == "d65" ? "scale" : "value", 1.0));
  if (type == "srgb" || type == "rgb") {
    const pugi::xml_node color = named_child(reader, node, "color");
    return color ? rgb_in(reader, color) : glm::dvec3(1.0);
  }
  if (type == "irregular" || type == "regular") {
    const std::vector<double> values = numbers_of(reader, node, read_text(reader, node, "values", ""));
    std::vector<double> at = numbers_of(reader, node, read_text(reader, node, "wavelengths", ""));
    if (type == "regular")
      for (std::size_t i = 0; i < values.size(); ++i) {
        const double lo = read_float(reader, node, "wavelength_min", 400.0),
                     hi = read_float(reader, node, "wavelength_max", 700.0);
        at.push_back(lo + (hi - lo) * static_cast<double>(i) /
                              std::max<double>(1.0, static_cast<double>(values.size()) - 1.0));
      }
    if (at.size() != values.size() || at.empty())
      fail_at(reader, node, "a spectrum has other counts of wavelengths and values");
    SpectrumTable table;
    for (std::size_t i = 0; i < at.size(); ++i) table.emplace_back(at[i], values[i]);
    std::ranges::stable_sort(table, {}, &SpectrumTable::value_type::first);
    return meaning == Meaning::light ? light_color(resample(table)) : reflected_color(resample(table));
  }
  if (!type.empty()) {
    reader.scene.losses.add(fmt::format("spectrum '{}': 1 instead", type));
    return glm::dvec3(1.0);
  }
  if (const std::optional<Spectrum> spectrum = spectrum_in(reader, node))
    return meaning == Meaning::light ? light_color(*spectrum) : reflected_color(*spectrum);
  return rgb_in(reader, node);
}

// Scale and offset of to_uv.
void set_uv_transform(MitsubaReader& reader, const pugi::xml_node& node, Texture& texture, double scale) {
  const glm::dmat4 matrix = read_transform(reader, node, "to_uv");
  if (matrix[0][1] != 0.0 || matrix[1][0] != 0.0) reader.scene.losses.add("rotation of a texture");
  // A 3x3 matrix keeps its translation in the third column.
  const pugi::xml_node steps = named_child(reader, node, "to_uv");
  const bool is_small = steps && steps.child("matrix") &&
                        numbers_of(reader, node, attribute(reader, steps.child("matrix"), "value")).size() == 9;
  const glm::dvec2 offset(matrix[is_small ? 2 : 3]);
  texture.uv_scale = scale * glm::dvec2(matrix[0][0], matrix[1][1]);
  texture.uv_offset = scale * offset;
}

Texture read_bitmap(MitsubaReader& reader, const pugi::xml_node& node, Meaning meaning) {
  Texture texture;
  const std::string path = read_path(reader, node, read_text(reader, node, "filename", ""));
  const bool is_raw = read_bool(reader, node, "raw", false);
  texture.image = reader.scene.images.add_file(path, is_raw ? Holds::numbers : Holds::colors);
  if (is_raw && meaning != Meaning::number)
    texture = mapped(reader.scene, texture, Holds::colors, [](const glm::dvec3& color) { return color; });
  set_uv_transform(reader, node, texture, 1.0);
  const std::string wrap = read_text(reader, node, "wrap_mode", "repeat");
  texture.clamps = wrap == "clamp";
  if (wrap == "mirror") reader.scene.losses.add("mirrored texture: it is repeated instead");
  texture.nearest = read_text(reader, node, "filter_type", "bilinear") == "nearest";
  return meaning == Meaning::number ? as_number(reader.scene, texture) : texture;
}

Texture value_of(MitsubaReader& reader, const pugi::xml_node& node, Meaning meaning) {
  const std::string_view tag = node.name();
  if (tag == "float" || tag == "integer" || tag == "rgb" || tag == "srgb")
    return constant(glm::max(rgb_in(reader, node), 0.0));
  if (tag == "spectrum") return constant(glm::max(spectrum_color(reader, node, meaning), 0.0));
  if (tag == "blackbody") return constant(glm::max(black_body_color(reader, node, false), 0.0));
  if (tag == "volume") { // of a medium
    if (named_child(reader, node, "value")) return read_texture_of(reader, node, "value", 1.0, meaning);
    reader.scene.losses.add("volume that varies: 0.5 everywhere instead");
    return constant(0.5);
  }
  if (tag != "texture") fail_at(reader, node, fmt::format("<{}> is no colour", std::string(tag).substr(0, 40)));
  const std::string type = attribute(reader, node, "type");
  if (type == "bitmap") return read_bitmap(reader, node, meaning);
  if (type == "checkerboard") {
    if (++reader.depth > kDeepestTexture) fail_at(reader, node, "nests textures too deep");
    const Texture one = read_texture_of(reader, node, "color0", 0.4, Meaning::reflectance);
    const Texture two = read_texture_of(reader, node, "color1", 0.2, Meaning::reflectance);
    --reader.depth;
    Texture texture = checkerboard(reader.scene, mean(reader.scene, one), mean(reader.scene, two));
    set_uv_transform(reader, node, texture, 1.0);
    return texture;
  }
  reader.scene.losses.add(fmt::format("texture '{}': grey instead", type));
  return constant(0.5);
}

} // namespace

Texture read_texture_of(MitsubaReader& reader, const pugi::xml_node& node, std::string_view name, double otherwise,
                        Meaning meaning) {
  const pugi::xml_node child = named_child(reader, node, name);
  return child ? value_of(reader, child, meaning) : constant(otherwise);
}

double read_index(MitsubaReader& reader, const pugi::xml_node& node, std::string_view name, const char* otherwise) {
  const pugi::xml_node child = named_child(reader, node, name);
  const std::string text = child ? attribute(reader, child, "value") : otherwise;
  if (const std::optional<double> named = named_ior(text)) return *named;
  if (child && std::string_view(child.name()) != "string") {
    const glm::dvec3 value = mean(reader.scene, value_of(reader, child, Meaning::number));
    return (value.x + value.y + value.z) / 3.0;
  }
  fail_at(reader, child, fmt::format("index of refraction '{}' is not known", text.substr(0, 40)),
          "write it as a number");
}

Texture read_metal_of(MitsubaReader& reader, const pugi::xml_node& node) {
  const pugi::xml_node eta = named_child(reader, node, "eta"), k = named_child(reader, node, "k");
  if (eta && k) {
    const std::optional<Spectrum> etas = spectrum_in(reader, eta), ks = spectrum_in(reader, k);
    if (etas && ks) {
      Spectrum reflectance;
      for (std::size_t i = 0; i < kWavelengths; ++i) reflectance[i] = conductor_reflectance((*etas)[i], (*ks)[i]);
      return constant(glm::clamp(reflected_color(reflectance), 0.0, 1.0));
    }
    const glm::dvec3 n = mean(reader.scene, value_of(reader, eta, Meaning::reflectance));
    const glm::dvec3 x = mean(reader.scene, value_of(reader, k, Meaning::reflectance));
    return constant(
        glm::dvec3(conductor_reflectance(n.r, x.r), conductor_reflectance(n.g, x.g), conductor_reflectance(n.b, x.b)));
  }
  const std::string material = read_text(reader, node, "material", "none");
  if (const std::optional<glm::dvec3> named = named_metal(material)) return constant(*named);
  fail_at(reader, node, fmt::format("metal '{}' is not known", material.substr(0, 40)), "give eta and k");
}

} // namespace wavepath::convert
