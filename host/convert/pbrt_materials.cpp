// Materials of pbrt-v4 as those of glTF.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/convert/materials.h"
#include "host/convert/pbrt_reader.h"
#include "host/convert/textures.h"

namespace wavepath::convert {
namespace {

// Sets what "roughness", or "uroughness" and "vroughness" say.
void read_roughness(PbrtReader& reader, const PbrtParams& params, const std::string& prefix, Material& material) {
  const bool remap = params.flag("remaproughness", true);
  const auto value = [&](const char* name) {
    const std::string own = prefix + name;
    return read_scalar(reader, params, (params.has(own) ? own : prefix + "roughness").c_str(), 0.0);
  };
  const auto alpha = [&](const Texture& roughness) {
    if (!remap) return roughness;
    return mapped(reader.scene, roughness, Holds::numbers,
                  [](const glm::dvec3& x) { return glm::sqrt(glm::max(x, 0.0)); });
  };
  const Texture u = value("uroughness"), v = value("vroughness"), alpha_u = alpha(u);
  set_roughness(reader.scene, material, alpha_u, u == v ? alpha_u : alpha(v));
}

Material read_coated_diffuse(PbrtReader& reader, const PbrtParams& params) {
  Material material = coated_diffuse(reader.scene, read_color(reader, params, "reflectance", constant(0.5)),
                                     read_ior(reader, params, "eta", 1.5));
  read_roughness(reader, params, "", material);
  if (params.has("albedo")) reader.scene.losses.add("medium between coat and base of a coated material");
  for (const char* name : {"thickness", "g", "maxdepth", "nsamples"}) params.find(name);
  return material;
}

Material read_coated_conductor(PbrtReader& reader, const PbrtParams& params) {
  Material material = conductor(read_metal(reader, params, "conductor."));
  read_roughness(reader, params, "conductor.", material);
  Material coat;
  read_roughness(reader, params, "interface.", coat);
  material.coat = 1.0;
  material.coat_roughness = mean(reader.scene, coat.roughness).x;
  if (std::abs(read_ior(reader, params, "interface.eta", 1.5) - 1.5) > 1e-3)
    reader.scene.losses.add("index of refraction of a coat: 1.5 instead");
  if (params.has("albedo")) reader.scene.losses.add("medium between coat and base of a coated material");
  for (const char* name : {"thickness", "g", "maxdepth", "nsamples"}) params.find(name);
  return material;
}

Material read_mixture(PbrtReader& reader, const PbrtParams& params) {
  const PbrtParam* names = params.find("materials");
  if (!names || names->strings.size() != 2) reader.tokens.fail("a mixture names no two materials");
  const Material* parts[2];
  for (std::size_t i = 0; i < 2; ++i) {
    const auto found = reader.materials.find(names->strings[i]);
    if (found == reader.materials.end() && names->strings[i] != "interface")
      reader.tokens.fail(fmt::format("material '{}' is not there", names->strings[i]));
    static const Material kNothing = [] {
      Material nothing;
      nothing.is_boundary = true;
      return nothing;
    }();
    parts[i] = found == reader.materials.end() ? &kNothing : &reader.scene.materials[found->second];
  }
  const Material a = *parts[0], b = *parts[1];
  return blended(reader.scene, a, b, read_scalar(reader, params, "amount", 0.5));
}

Material of_type(PbrtReader& reader, const std::string& type, const PbrtParams& params) {
  if (type == "diffuse") return diffuse(read_color(reader, params, "reflectance", constant(0.5)));
  if (type == "coateddiffuse") return read_coated_diffuse(reader, params);
  if (type == "coatedconductor") return read_coated_conductor(reader, params);
  if (type == "mix") return read_mixture(reader, params);
  if (type == "conductor") {
    Material material = conductor(read_metal(reader, params, ""));
    read_roughness(reader, params, "", material);
    return material;
  }
  if (type == "dielectric" || type == "thindielectric") {
    Material material = dielectric(read_ior(reader, params, "eta", 1.5), type == "thindielectric");
    if (type == "dielectric") read_roughness(reader, params, "", material);
    return material;
  }
  if (type == "diffusetransmission") {
    const double scale = params.number("scale", 1.0);
    const Texture reflectance = read_color(reader, params, "reflectance", constant(0.25));
    const Texture transmittance = read_color(reader, params, "transmittance", constant(0.25));
    Material material =
        diffuse_transmission(scale * mean(reader.scene, reflectance), scale * mean(reader.scene, transmittance));
    if (reflectance.is_constant()) return material;
    Texture base = reflectance; // the colours of both sides keep their own textures out of glTF's factors
    base.factor *= scale / std::max(1e-6, 1.0 - material.diffuse_transmission);
    material.base = bounded(reader.scene, base, Holds::colors);
    if (!transmittance.is_constant()) reader.scene.losses.add("texture of diffuse transmission: its mean instead");
    return material;
  }
  if (type == "subsurface") {
    reader.scene.losses.add("subsurface scattering: a coated diffuse surface instead");
    Material material = coated_diffuse(reader.scene, read_color(reader, params, "reflectance", constant(0.5)),
                                       read_ior(reader, params, "eta", 1.33));
    read_roughness(reader, params, "", material);
    return material;
  }
  if (type == "interface" || type.empty() || type == "none") {
    Material material;
    material.is_boundary = true;
    return material;
  }
  if (type == "hair" || type == "measured") {
    reader.scene.losses.add(fmt::format("material '{}': diffuse grey instead", type));
    for (const PbrtParam& param : params.all) param.is_used = true;
    return diffuse(constant(0.5));
  }
  reader.tokens.fail(fmt::format("material '{}' is none of pbrt-v4", type), "upgrade the scene with `pbrt --upgrade`");
}

} // namespace

Material read_material(PbrtReader& reader, const std::string& type, const PbrtParams& params) {
  Material material = of_type(reader, type, params);
  if (params.has("displacement")) reader.scene.losses.add("bump map");
  if (params.has("normalmap")) {
    material.normal = constant(1.0);
    material.normal.image =
        reader.scene.images.add_file(reader.tokens.resolved(params.text("normalmap", "")), Holds::numbers);
  }
  params.find("type");
  tell_unused(reader, fmt::format("material '{}'", type), params);
  return material;
}

} // namespace wavepath::convert
