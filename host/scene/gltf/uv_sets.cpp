// Maps the sets of texture coordinates that a material reads to the two that a vertex has.
#include "host/scene/gltf/uv_sets.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "host/base/overloaded.h"
#include "host/scene/gltf/uri.h"

namespace wavepath::gltf {
namespace {

// Texture coordinates are that far off where a map takes them from others: a tenth of a texel of 8192.
constexpr double kMapTolerance = 1e-5;

template <class Visit>
void visit_slots(Material& material, Visit&& visit) {
  const auto visit_row = [&](const MaterialTexture& row) {
    if ((material.*row.field).present()) visit(row, material.*row.field);
  };
  visit_material_fields(Overloaded{visit_row, [](const auto&) {}});
}

// Without repetition: that of the tangents first, as no map of it has the same, then in the order of the table.
std::vector<std::uint32_t> sets_read(const Material& material) {
  std::vector<std::uint32_t> sets;
  const auto add = [&](std::uint32_t set) {
    if (std::ranges::find(sets, set) == sets.end()) sets.push_back(set);
  };
  if (material.normal_texture.present()) add(material.normal_texture.uv_set);
  visit_textures(material, [&](const MaterialTexture&, const TextureSlot& slot) { add(slot.uv_set); });
  if (needs_tangents(material)) add(tangent_slot(material).uv_set);
  return sets;
}

struct AffineMap {
  glm::dmat2 matrix{1.0};
  glm::dvec2 offset{0.0};
};

glm::dvec2 uv_at(const Elements& elements, std::size_t i) { return glm::dvec2(vector_at<2>(elements, i)); }

bool all_finite(const glm::dvec2& uv) { return std::isfinite(uv.x) && std::isfinite(uv.y); }

// Least squares, and then whether every vertex agrees.
std::optional<AffineMap> find_map(const Elements& from, const Elements& to) {
  AffineMap map;
  if (!to.present()) return AffineMap{glm::dmat2(0.0), glm::dvec2(0.0)};
  if (!from.present() || from.count != to.count || from.components != 2 || to.components != 2) return {};
  const auto largest_error = [&] {
    double error = 0.0, extent = 1.0;
    for (std::size_t i = 0; i < from.count; ++i) {
      const glm::dvec2 uv = uv_at(from, i), wanted = uv_at(to, i);
      if (!all_finite(uv) || !all_finite(wanted)) continue;
      const glm::dvec2 difference = map.matrix * uv + map.offset - wanted;
      error = std::max({error, std::abs(difference.x), std::abs(difference.y)});
      extent = std::max({extent, std::abs(wanted.x), std::abs(wanted.y)});
    }
    return error / extent;
  };
  if (largest_error() == 0.0) return map; // a copy, as most are
  glm::dvec2 from_mean(0.0), to_mean(0.0);
  double count = 0.0;
  for (std::size_t i = 0; i < from.count; ++i) {
    if (!all_finite(uv_at(from, i)) || !all_finite(uv_at(to, i))) continue;
    from_mean += uv_at(from, i), to_mean += uv_at(to, i), count += 1.0;
  }
  from_mean /= std::max(count, 1.0), to_mean /= std::max(count, 1.0);
  glm::dmat2 spread(0.0), product(0.0);
  for (std::size_t i = 0; i < from.count; ++i) {
    const glm::dvec2 a = uv_at(from, i) - from_mean, b = uv_at(to, i) - to_mean;
    if (!all_finite(a) || !all_finite(b)) continue;
    spread += glm::outerProduct(a, a), product += glm::outerProduct(b, a);
  }
  const double determinant = glm::determinant(spread);
  if (!(determinant > 1e-12 * spread[0][0] * spread[1][1])) return {}; // points on a line
  map.matrix = product * glm::inverse(spread);
  map.offset = to_mean - map.matrix * from_mean;
  if (largest_error() < kMapTolerance) return map;
  return {};
}

// A set of the file as vertices have it: a set of theirs, and a map of it.
struct UvSource {
  std::uint32_t set = 0;
  AffineMap map;
};

void apply(const UvSource& source, TextureSlot& slot) {
  const glm::dmat2 matrix(slot.uv_matrix);
  slot.uv_offset = glm::vec2(matrix * source.map.offset + glm::dvec2(slot.uv_offset));
  slot.uv_matrix = glm::mat2(matrix * source.map.matrix);
  slot.uv_set = source.set;
}

void leave_out(const MaterialTexture& row, TextureSlot& slot, Material& material, Warnings& warnings) {
  const std::string property = row.gltf;
  warnings.add(property.substr(property.rfind('.') + 1) + " of material '" + shown(material.name) +
               "' left out: with TEXCOORD_" + std::to_string(slot.uv_set) +
               " the material reads more than two sets of texture coordinates");
  slot = {};
  if (row.field == &Material::emission_texture) material.emission = glm::vec3(0.0f); // or all of it would shine
}

} // namespace

std::optional<UvSets> take_uv_sets(Material& material) {
  std::vector<std::uint32_t> sets = sets_read(material);
  if (sets.size() > 2) return {};
  std::ranges::sort(sets);
  if (sets.empty() || sets.back() < 2) return UvSets{0, 1};
  visit_slots(material,
              [&](const MaterialTexture&, TextureSlot& slot) { slot.uv_set = slot.uv_set == sets.front() ? 0 : 1; });
  return UvSets{sets.front(), sets.back()};
}

UvSets fit_uv_sets(Document& document, Warnings& warnings, const tinygltf::Primitive& primitive, const Decoded& decoded,
                   Material& material) {
  std::vector<std::uint32_t> kept;
  std::vector<Elements> coordinates;
  std::map<std::uint32_t, UvSource> sources;
  for (const std::uint32_t set : sets_read(material)) {
    const std::string name = "TEXCOORD_" + std::to_string(set);
    const auto attribute = primitive.attributes.find(name);
    const Elements elements = attribute == primitive.attributes.end()
                                  ? Elements{}
                                  : open_accessor(document, attribute->second, name, decoded);
    std::optional<UvSource> source;
    for (std::uint32_t i = 0; i < kept.size() && !source; ++i)
      if (const auto map = find_map(coordinates[i], elements)) source = {i, *map};
    if (source && !elements.present()) warnings.add(kNoUvSet);
    if (!source && kept.size() < 2) {
      source = {static_cast<std::uint32_t>(kept.size()), {}};
      kept.push_back(set), coordinates.push_back(elements);
    }
    if (source) sources[set] = *source;
  }
  visit_slots(material, [&](const MaterialTexture& row, TextureSlot& slot) {
    if (const auto source = sources.find(slot.uv_set); source != sources.end())
      apply(source->second, slot);
    else
      leave_out(row, slot, material, warnings);
  });
  return {kept.front(), kept.back()};
}

} // namespace wavepath::gltf
