// BSDFs of Mitsuba as materials of glTF.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/convert/materials.h"
#include "host/convert/mitsuba_reader.h"
#include "host/convert/textures.h"

namespace wavepath::convert {
namespace {

constexpr int kDeepestBsdf = 16;

Material nested(MitsubaReader& reader, const pugi::xml_node& node, std::size_t index) {
  const std::vector<pugi::xml_node> parts = children_of(reader, node, "bsdf");
  if (index >= parts.size()) fail_at(reader, node, "a BSDF lacks the one within it");
  return read_bsdf(reader, parts[index]);
}

void read_alpha(MitsubaReader& reader, const pugi::xml_node& node, Material& material) {
  const Texture both = read_texture_of(reader, node, "alpha", 0.1, Meaning::number);
  const auto own = [&](const char* name) {
    return named_child(reader, node, name) ? read_texture_of(reader, node, name, 0.1, Meaning::number) : both;
  };
  set_roughness(reader.scene, material, own("alpha_u"), own("alpha_v"));
  if (read_text(reader, node, "distribution", "beckmann") == "beckmann")
    reader.scene.losses.add("Beckmann's distribution of microfacets: GGX instead");
}

Material read_plastic(MitsubaReader& reader, const pugi::xml_node& node, bool rough) {
  const double ior = read_index(reader, node, "int_ior", "polypropylene") / read_index(reader, node, "ext_ior", "air");
  const Texture reflectance = read_texture_of(reader, node, "diffuse_reflectance", 0.5, Meaning::reflectance);
  Material material;
  if (read_bool(reader, node, "nonlinear", false)) {
    material = coated_diffuse(reader.scene, reflectance, ior);
  } else { // the colour is that which leaves, whatever the number of reflections inside
    material.base = reflectance;
    material.specular = 1.0;
    material.ior = std::max(1.0, ior);
    material.roughness = constant(0.0);
  }
  if (rough) read_alpha(reader, node, material);
  material.specular_color =
      mean(reader.scene, read_texture_of(reader, node, "specular_reflectance", 1.0, Meaning::reflectance));
  return material;
}

Material read_glass(MitsubaReader& reader, const pugi::xml_node& node, const std::string& type) {
  double ior = read_index(reader, node, "int_ior", "bk7") / read_index(reader, node, "ext_ior", "air");
  if (ior < 1.0) {
    reader.scene.losses.add("index of refraction below 1: its inverse instead");
    ior = 1.0 / std::max(ior, 1e-3);
  }
  Material material = dielectric(ior, type == "thindielectric");
  if (type == "roughdielectric") read_alpha(reader, node, material);
  material.base = read_texture_of(reader, node, "specular_transmittance", 1.0, Meaning::reflectance);
  material.specular_color =
      mean(reader.scene, read_texture_of(reader, node, "specular_reflectance", 1.0, Meaning::reflectance));
  return material;
}

Material read_conductor(MitsubaReader& reader, const pugi::xml_node& node, bool rough) {
  Material material = conductor(
      product(reader.scene, read_metal_of(reader, node),
              read_texture_of(reader, node, "specular_reflectance", 1.0, Meaning::reflectance), Holds::colors));
  if (rough) read_alpha(reader, node, material);
  return material;
}

// A constant of a parameter that glTF has no texture for here.
double constant_of(MitsubaReader& reader, const pugi::xml_node& node, const char* name, double otherwise) {
  const Texture texture = read_texture_of(reader, node, name, otherwise, Meaning::number);
  if (!texture.is_constant()) reader.scene.losses.add(fmt::format("texture of '{}': its mean instead", name));
  return mean(reader.scene, texture).x;
}

Material read_principled(MitsubaReader& reader, const pugi::xml_node& node, bool thin) {
  Material material;
  material.base = read_texture_of(reader, node, "base_color", 0.5, Meaning::reflectance);
  material.metallic = read_texture_of(reader, node, "metallic", 0.0, Meaning::number);
  material.specular = 1.0;
  const double r0 = 0.08 * std::clamp(read_float(reader, node, "specular", 0.5), 0.0, 10.0);
  material.ior = named_child(reader, node, "eta") ? read_index(reader, node, "eta", "bk7")
                                                  : 2.0 / (1.0 - std::sqrt(std::min(r0, 0.9))) - 1.0;
  material.ior = std::max(1.0, material.ior);
  const Texture roughness = read_texture_of(reader, node, "roughness", 0.5, Meaning::number);
  const double stretch = std::sqrt(1.0 - 0.9 * std::clamp(constant_of(reader, node, "anisotropic", 0.0), 0.0, 1.0));
  if (stretch < 1.0 && roughness.is_constant()) {
    const double alpha = roughness.factor.x * roughness.factor.x;
    set_roughness(reader.scene, material, constant(alpha / stretch), constant(alpha * stretch));
  } else {
    material.roughness = roughness;
    if (stretch < 1.0) reader.scene.losses.add("anisotropy of a textured roughness");
  }
  material.transmission = std::clamp(constant_of(reader, node, "spec_trans", 0.0), 0.0, 1.0);
  material.volume = !thin;
  if (thin) material.diffuse_transmission = 0.5 * std::clamp(constant_of(reader, node, "diff_trans", 0.0), 0.0, 2.0);
  if (thin && material.diffuse_transmission > 0.0)
    material.diffuse_transmission_color = mean(reader.scene, material.base);
  material.coat = std::clamp(constant_of(reader, node, "clearcoat", 0.0), 0.0, 1.0);
  const double gloss = std::clamp(constant_of(reader, node, "clearcoat_gloss", 0.0), 0.0, 1.0);
  material.coat_roughness = std::sqrt(0.1 + (0.001 - 0.1) * gloss);
  const double sheen = constant_of(reader, node, "sheen", 0.0), tint = constant_of(reader, node, "sheen_tint", 0.0);
  if (sheen > 0.0) {
    const glm::dvec3 base = mean(reader.scene, material.base);
    const double largest = std::max({base.x, base.y, base.z, 1e-6});
    material.sheen = sheen * glm::mix(glm::dvec3(1.0), base / largest, glm::dvec3(tint));
    material.sheen_roughness = 0.5;
    reader.scene.losses.add("sheen of a principled material: that of glTF instead");
  }
  if (material.coat > 0.0) reader.scene.losses.add("clear coat of a principled material: that of glTF instead");
  for (const char* name : {"flatness", "spec_tint"})
    if (constant_of(reader, node, name, 0.0) > 0.0)
      reader.scene.losses.add(fmt::format("'{}' of a principled material", name));
  return material;
}

Material of_bsdf_type(MitsubaReader& reader, const pugi::xml_node& node, const std::string& type) {
  if (type == "diffuse" || type == "roughdiffuse") {
    if (type == "roughdiffuse") reader.scene.losses.add("roughness of a diffuse surface");
    return diffuse(read_texture_of(reader, node, "reflectance", 0.5, Meaning::reflectance));
  }
  if (type == "conductor" || type == "roughconductor") return read_conductor(reader, node, type == "roughconductor");
  if (type == "dielectric" || type == "thindielectric" || type == "roughdielectric")
    return read_glass(reader, node, type);
  if (type == "plastic" || type == "roughplastic" || type == "pplastic")
    return read_plastic(reader, node, type != "plastic");
  if (type == "principled" || type == "principledthin") return read_principled(reader, node, type == "principledthin");
  if (type == "twosided") {
    if (children_of(reader, node, "bsdf").size() > 1)
      reader.scene.losses.add("material of the back: that of the front instead");
    return nested(reader, node, 0);
  }
  if (type == "mask") {
    Material material = nested(reader, node, 0);
    material.alpha = read_texture_of(reader, node, "opacity", 0.5, Meaning::number);
    return material;
  }
  if (type == "blendbsdf") {
    const Material a = nested(reader, node, 0), b = nested(reader, node, 1);
    return blended(reader.scene, a, b, read_texture_of(reader, node, "weight", 0.5, Meaning::number));
  }
  if (type == "bumpmap") {
    reader.scene.losses.add("bump map");
    return nested(reader, node, 0);
  }
  if (type == "normalmap") {
    Material material = nested(reader, node, 0);
    const pugi::xml_node map = named_child(reader, node, "normalmap");
    if (map && attribute(reader, map, "type") == "bitmap") {
      material.normal = constant(1.0);
      material.normal.image =
          reader.scene.images.add_file(read_path(reader, map, read_text(reader, map, "filename", "")), Holds::numbers);
    }
    return material;
  }
  Material material;
  material.is_boundary = type == "null";
  if (material.is_boundary) return material;
  reader.scene.losses.add(fmt::format("BSDF '{}': diffuse grey instead", type));
  return diffuse(constant(0.5));
}

} // namespace

Material read_bsdf(MitsubaReader& reader, const pugi::xml_node& node) {
  if (++reader.depth > kDeepestBsdf) fail_at(reader, node, "nests BSDFs too deep");
  Material material = of_bsdf_type(reader, node, attribute(reader, node, "type"));
  --reader.depth;
  tell_unused(reader, node);
  if (const std::string id = attribute(reader, node, "id"); !id.empty()) material.name = id;
  return material;
}

} // namespace wavepath::convert
