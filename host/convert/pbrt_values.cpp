// Parameters of pbrt as colours, numbers and textures.
#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/convert/mesh_files.h"
#include "host/convert/pbrt_reader.h"
#include "host/convert/textures.h"

namespace wavepath::convert {
namespace {

glm::dvec3 rgb_of(PbrtReader& reader, const PbrtParam& param) {
  if (param.numbers.size() < 3) reader.tokens.fail(fmt::format("\"{}\" has fewer than three numbers", param.name));
  return {param.numbers[0], param.numbers[1], param.numbers[2]};
}

SpectrumTable to_table(PbrtReader& reader, const std::string& what, const std::vector<double>& numbers) {
  if (numbers.size() < 2 || numbers.size() % 2) reader.tokens.fail(fmt::format("\"{}\" has no pairs of numbers", what));
  SpectrumTable table;
  for (std::size_t i = 0; i < numbers.size(); i += 2) table.emplace_back(numbers[i], numbers[i + 1]);
  std::ranges::stable_sort(table, {}, &SpectrumTable::value_type::first);
  return table;
}

// Lines of a wavelength and a value.
SpectrumTable read_table(PbrtReader& reader, const std::string& path) {
  const std::vector<std::uint8_t> bytes = read_bytes(path);
  std::vector<double> numbers;
  const char *at = reinterpret_cast<const char*>(bytes.data()), *end = at + bytes.size();
  while (at < end) {
    if (*at == '#') {
      at = std::find(at, end, '\n');
      continue;
    }
    double value = 0.0;
    const auto [stop, error] = std::from_chars(at, end, value);
    if (error == std::errc() && std::isfinite(value)) numbers.push_back(value);
    at = stop > at ? stop : at + 1;
  }
  return to_table(reader, path, numbers);
}

// The table of a spectrum that is listed or in a file.
Spectrum spectrum_of(PbrtReader& reader, const PbrtParam& param) {
  if (!param.strings.empty()) return resample(read_table(reader, reader.tokens.resolved(param.strings[0])));
  return resample(to_table(reader, param.name, param.numbers));
}

double average(const Spectrum& spectrum) {
  double sum = 0.0;
  for (const double value : spectrum) sum += value;
  return sum / static_cast<double>(kWavelengths);
}

const Texture& named_texture(PbrtReader& reader, const std::map<std::string, Texture>& textures,
                             const PbrtParam& param) {
  const auto found = param.strings.empty() ? textures.end() : textures.find(param.strings[0]);
  if (found == textures.end())
    reader.tokens.fail(fmt::format("texture '{}' is not there", param.strings.empty() ? "" : param.strings[0]));
  return found->second;
}

Texture read_image_map(PbrtReader& reader, const PbrtParams& params, bool is_color) {
  const std::string encoding = params.text("encoding", "sRGB");
  const bool is_coded = encoding == "sRGB" || encoding.starts_with("gamma");
  const std::string path = reader.tokens.resolved(params.text("filename", ""));
  Texture texture;
  if (is_color && !is_coded) { // linear bytes, as sRGB
    texture.image = reader.scene.images.add_file(path, Holds::numbers);
    texture = mapped(reader.scene, texture, Holds::colors, [](const glm::dvec3& color) { return color; });
  } else {
    // Numbers are decoded as colours are, unless the file says otherwise.
    texture.image = reader.scene.images.add_file(path, is_coded ? Holds::colors : Holds::numbers);
  }
  const double su = params.number("uscale", 1.0), sv = params.number("vscale", 1.0);
  texture.uv_scale = {su, sv};
  texture.uv_offset = {params.number("udelta", 0.0), 1.0 - sv - params.number("vdelta", 0.0)};
  const std::string wrap = params.text("wrap", "repeat");
  texture.clamps = wrap == "clamp" || wrap == "black";
  if (wrap == "black")
    reader.scene.losses.add("texture that is black outside of its image: its border is repeated instead");
  if (encoding.starts_with("gamma")) reader.scene.losses.add("texture with a gamma: read as sRGB");
  if (params.flag("invert", false))
    texture = mapped(reader.scene, texture, Holds::colors, [](const glm::dvec3& color) { return 1.0 - color; });
  texture.factor *= params.number("scale", 1.0);
  params.find("filter"), params.find("maxanisotropy");
  return is_color ? texture : as_number(reader.scene, texture);
}

Texture read_checkerboard(PbrtReader& reader, const PbrtParams& params, bool is_color) {
  const auto value = [&](const char* name, double otherwise) {
    return is_color ? read_color(reader, params, name, constant(otherwise))
                    : read_scalar(reader, params, name, otherwise);
  };
  const Texture one = value("tex1", 1.0), two = value("tex2", 0.0);
  if (params.number("dimension", 2.0) != 2.0) {
    reader.scene.losses.add("checkerboard in space: the mean of its colours instead");
    return constant(0.5 * (mean(reader.scene, one) + mean(reader.scene, two)));
  }
  if (!one.is_constant() || !two.is_constant())
    reader.scene.losses.add("checkerboard of textures: of their means instead");
  Texture texture = checkerboard(reader.scene, mean(reader.scene, one), mean(reader.scene, two));
  // pbrt's squares have the unit as their side, and v grows upwards.
  const double su = 0.5 * params.number("uscale", 1.0), sv = -0.5 * params.number("vscale", 1.0);
  texture.uv_scale = {su, sv};
  texture.uv_offset = {0.5 * params.number("udelta", 0.0), -sv + 0.5 * params.number("vdelta", 0.0)};
  return texture;
}

} // namespace

Texture read_color(PbrtReader& reader, const PbrtParams& params, const char* name, const Texture& otherwise) {
  const PbrtParam* param = params.find(name);
  if (!param) return otherwise;
  if (param->type == "texture") return named_texture(reader, reader.colors, *param);
  if (param->type == "rgb") return constant(glm::max(rgb_of(reader, *param), 0.0));
  if (param->type == "spectrum") {
    if (!param->strings.empty() && named_illuminant(param->strings[0])) return constant(1.0);
    return constant(glm::max(reflected_color(spectrum_of(reader, *param)), 0.0));
  }
  reader.tokens.fail(fmt::format("\"{} {}\" is no colour of pbrt-v4", param->type, param->name),
                     "upgrade the scene with `pbrt --upgrade`");
}

Texture read_scalar(PbrtReader& reader, const PbrtParams& params, const char* name, double otherwise) {
  const PbrtParam* param = params.find(name);
  if (!param) return constant(otherwise);
  if (param->type == "texture") return named_texture(reader, reader.numbers, *param);
  return constant(param->numbers.empty() ? otherwise : param->numbers[0]);
}

glm::dvec3 read_light_color(PbrtReader& reader, const PbrtParam* param) {
  if (!param) return glm::dvec3(1.0);
  if (param->type == "rgb") return glm::max(rgb_of(reader, *param), 0.0);
  if (param->type == "blackbody") {
    const double kelvin = param->numbers.empty() ? 6500.0 : param->numbers[0];
    return glm::max(unit_luminance(light_color(black_body(kelvin))), 0.0);
  }
  if (param->type != "spectrum")
    reader.tokens.fail(fmt::format("\"{} {}\" is no spectrum of pbrt-v4", param->type, param->name),
                       "upgrade the scene with `pbrt --upgrade`");
  if (!param->strings.empty()) {
    if (const std::optional<glm::dvec3> named = named_illuminant(param->strings[0])) return *named;
    if (param->strings[0].starts_with("stdillum-") || param->strings[0].starts_with("illum-")) {
      reader.scene.losses.add(fmt::format("illuminant '{}': white instead", param->strings[0]));
      return glm::dvec3(1.0);
    }
  }
  return glm::max(unit_luminance(light_color(spectrum_of(reader, *param))), 0.0);
}

glm::dvec3 read_coefficient(PbrtReader& reader, const PbrtParams& params, const char* name,
                            const glm::dvec3& otherwise) {
  const PbrtParam* param = params.find(name);
  if (!param) return otherwise;
  if (param->type == "rgb") return glm::max(rgb_of(reader, *param), 0.0);
  return glm::max(reflected_color(spectrum_of(reader, *param)), 0.0);
}

double read_ior(PbrtReader& reader, const PbrtParams& params, const char* name, double otherwise) {
  const PbrtParam* param = params.find(name);
  if (!param) return otherwise;
  double ior = otherwise;
  if (param->type == "spectrum" && !param->strings.empty()) {
    const std::optional<double> named = named_ior(param->strings[0]);
    ior = named ? *named : average(spectrum_of(reader, *param));
  } else if (param->type == "spectrum") {
    ior = average(spectrum_of(reader, *param));
  } else if (!param->numbers.empty()) {
    ior = param->numbers[0];
  }
  if (param->type == "spectrum") reader.scene.losses.add("dispersion of glass: one index of refraction instead");
  if (ior < 1.0 && ior > 0.0) {
    reader.scene.losses.add("index of refraction below 1: its inverse instead");
    ior = 1.0 / ior;
  }
  return std::clamp(ior, 1.0, 100.0);
}

Texture read_metal(PbrtReader& reader, const PbrtParams& params, const std::string& prefix) {
  if (params.has("reflectance")) return read_color(reader, params, "reflectance", constant(1.0));
  const PbrtParam *eta = params.find(prefix + "eta"), *k = params.find(prefix + "k");
  const auto metal_of = [](const PbrtParam* param) {
    std::string name = param && !param->strings.empty() ? param->strings[0] : param ? "" : "metal-Cu-eta";
    if (!name.starts_with("metal-")) return std::string();
    return name.substr(6, name.rfind('-') - 6);
  };
  if (!eta || (!metal_of(eta).empty() && metal_of(eta) == metal_of(k))) {
    const std::optional<glm::dvec3> named = named_metal(metal_of(eta));
    if (named) return constant(*named);
  }
  if (!eta || !k) reader.tokens.fail("a conductor has only one of eta and k");
  const auto value = [&](const PbrtParam& param, std::size_t i, const Spectrum& spectrum) {
    if (param.type == "rgb" || param.type == "float") return param.numbers[std::min(i, param.numbers.size() - 1)];
    return spectrum[i];
  };
  const bool eta_by_channel = eta->type != "spectrum", k_by_channel = k->type != "spectrum";
  if (eta_by_channel != k_by_channel) reader.tokens.fail("eta and k of a conductor are of different types");
  if (eta_by_channel) {
    if (eta->numbers.empty() || k->numbers.empty()) reader.tokens.fail("eta and k have no numbers");
    glm::dvec3 color;
    for (int c = 0; c < 3; ++c)
      color[c] = conductor_reflectance(value(*eta, static_cast<std::size_t>(c), {}),
                                       value(*k, static_cast<std::size_t>(c), {}));
    return constant(color);
  }
  const Spectrum etas = spectrum_of(reader, *eta), ks = spectrum_of(reader, *k);
  Spectrum reflectance;
  for (std::size_t i = 0; i < kWavelengths; ++i) reflectance[i] = conductor_reflectance(etas[i], ks[i]);
  return constant(glm::clamp(reflected_color(reflectance), 0.0, 1.0));
}

void read_texture(PbrtReader& reader, const std::string& name, const std::string& type, const std::string& kind,
                  const PbrtParams& params) {
  if (type != "spectrum" && type != "float")
    reader.tokens.fail(fmt::format("texture '{}' has type '{}'", name, type),
                       "upgrade the scene with `pbrt --upgrade`");
  const bool is_color = type == "spectrum";
  const Holds holds = is_color ? Holds::colors : Holds::numbers;
  const auto value = [&](const char* parameter, double otherwise) {
    return is_color ? read_color(reader, params, parameter, constant(otherwise))
                    : read_scalar(reader, params, parameter, otherwise);
  };
  Texture texture;
  const std::string mapping = params.text("mapping", "uv");
  if (mapping != "uv")
    reader.scene.losses.add(fmt::format("texture mapping '{}': the mesh's own coordinates instead", mapping));
  if (kind == "constant") {
    texture = value("value", 1.0);
  } else if (kind == "scale") {
    texture = product(reader.scene, value("tex", 1.0), read_scalar(reader, params, "scale", 1.0), holds);
  } else if (kind == "mix") {
    texture =
        mixed(reader.scene, value("tex1", 0.0), value("tex2", 1.0), read_scalar(reader, params, "amount", 0.5), holds);
  } else if (kind == "imagemap" || kind == "ptex") {
    if (kind == "ptex") {
      reader.scene.losses.add("texture of Ptex: grey instead");
      texture = constant(0.5);
    } else {
      texture = read_image_map(reader, params, is_color);
    }
  } else if (kind == "checkerboard") {
    texture = read_checkerboard(reader, params, is_color);
  } else if (kind == "directionmix" || kind == "dots" || kind == "bilerp") {
    reader.scene.losses.add(fmt::format("texture '{}': a mean instead", kind));
    const char* names[] = {kind == "dots"     ? "inside"
                           : kind == "bilerp" ? "v00"
                                              : "tex1",
                           kind == "dots"     ? "outside"
                           : kind == "bilerp" ? "v11"
                                              : "tex2"};
    texture = constant(0.5 * (mean(reader.scene, value(names[0], 0.0)) + mean(reader.scene, value(names[1], 1.0))));
  } else {
    reader.scene.losses.add(fmt::format("texture '{}': grey instead", kind));
    texture = constant(0.5);
  }
  tell_unused(reader, fmt::format("texture '{}'", kind), params);
  (is_color ? reader.colors : reader.numbers)[name] = texture;
}

void tell_unused(PbrtReader& reader, const std::string& what, const PbrtParams& params) {
  for (const PbrtParam& param : params.all)
    if (!param.is_used) reader.scene.losses.add(fmt::format("parameter '{}' of {} ignored", param.name, what));
}

} // namespace wavepath::convert
