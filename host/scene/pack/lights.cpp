// Lists lights, weighs them by power and deals out the intervals that they are picked by; see lights.h.
#include "host/scene/pack/lights.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <span>
#include <unordered_map>

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include "host/base/error.h"
#include "host/scene/pack/emission.h"
#include "host/scene/pack/intervals.h"
#include "host/scene/pack/light_tree.h"

namespace wavepath {
namespace {

constexpr std::size_t kMostLights = std::size_t{1} << 26; // 5 GiB
using std::numbers::pi;

// Lights of one kind of reach, whose powers can be compared with each other. Those of two groups cannot: what a lamp
// does to a point goes by its distance, which an environment does not have.
enum Group : std::size_t { kLocal, kDirectional, kEnvironment, kGroupCount };

struct LightList {
  std::vector<gpu::Light> lights;              // by group
  std::vector<double> powers, areas;           // of triangles; areas of other lights are 0
  std::array<std::size_t, kGroupCount> ends{}; // of the groups in `lights`
};

void add_light(const Scene& scene, LightList& list, const gpu::Light& light, double power, double area = 0.0) {
  if (list.lights.size() == kMostLights)
    throw Error(scene.path, "has more than 67108864 lights", "use --direct bsdf, or fewer emissive triangles");
  list.lights.push_back(light);
  list.powers.push_back(power);
  list.areas.push_back(area);
}

double world_area(const gpu::Triangle& triangle, const gpu::Instance* instance) {
  glm::dvec3 edges[2] = {glm::dvec3(triangle.v1) - glm::dvec3(triangle.v0),
                         glm::dvec3(triangle.v2) - glm::dvec3(triangle.v0)};
  if (instance != nullptr)
    for (glm::dvec3& edge : edges) {
      const glm::dvec3 e = edge;
      for (int row = 0; row < 3; ++row)
        edge[row] = glm::dot(glm::dvec3(glm::vec3(instance->world_from_object[row])), e);
    }
  return 0.5 * glm::length(glm::cross(edges[0], edges[1]));
}

// Index of the triangle's centre on a Z-curve through the object's box, 2^21 cells an axis.
std::uint64_t curve_index(const gpu::Triangle& triangle, const Object& object) {
  const glm::dvec3 lo = object.lo, size = glm::max(glm::dvec3(object.hi) - lo, glm::dvec3(1e-300));
  const glm::dvec3 centre = (glm::dvec3(triangle.v0) + glm::dvec3(triangle.v1) + glm::dvec3(triangle.v2)) / 3.0;
  const glm::dvec3 cell = glm::clamp((centre - lo) / size, 0.0, 1.0) * 0x1.fffffp20;
  std::uint64_t curve_index = 0;
  for (int bit = 20; bit >= 0; --bit)
    for (int axis = 0; axis < 3; ++axis)
      curve_index = curve_index << 1 | (static_cast<std::uint64_t>(cell[axis]) >> bit & 1u);
  return curve_index;
}

// The area of a triangle that moves may change, and with it the density of points on it: paths find its light by
// chance.
bool moves(const PackedScene& packed, std::uint32_t item) {
  if (!packed.moves()) return false;
  const gpu::Triangle& motion = packed.motions[item];
  return motion.v0 != glm::vec3(0.0f) || motion.v1 != glm::vec3(0.0f) || motion.v2 != glm::vec3(0.0f);
}

// Emissive items of the object, one copy of each triangle, sorted along a Z-curve: stratified random numbers then pick
// stratified lights (in the order of the source, a sphere of 3,968 triangles has 1.9 times the noise). The order does
// not depend on the tree, so neither does the picture. Sets Triangle::light of all copies.
std::vector<std::uint32_t> list_shining(const Object& object, const Emission& emission, const PackedScene& packed,
                                        std::vector<gpu::Triangle>& triangles) {
  struct Shining {
    std::uint64_t curve_index;
    std::uint32_t id, item;
    auto operator<=>(const Shining&) const = default;
  };
  std::vector<Shining> all;
  for (std::uint32_t item = object.first_item; item < object.first_item + object.item_count; ++item) {
    const gpu::Triangle& triangle = triangles[item];
    const bool shines = emission.firsts[item] != Emission::kDark && !moves(packed, item);
    if (shines) all.push_back({curve_index(triangle, object), triangle.id, item});
  }
  tbb::parallel_sort(all.begin(), all.end());
  std::vector<std::uint32_t> items;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i == 0 || all[i].id != all[i - 1].id) items.push_back(all[i].item);
    triangles[all[i].item].light = static_cast<std::uint32_t>(items.size() - 1);
  }
  return items;
}

// Emission of a triangle that is the same in every instance.
struct ShiningTriangle {
  std::uint32_t item = 0;
  std::uint32_t parts = 0; // see Light::parts
  double density = 0.0;    // mean of its parts, see Emission
};

ShiningTriangle cut_in_parts(std::uint32_t item, const Emission& emission, std::vector<std::uint32_t>& words) {
  const std::span parts = emission.parts_of(item);
  std::vector<double> weights;
  std::uint32_t begin = 0;
  for (const EmissionPart& part : parts) {
    weights.push_back(part.density * static_cast<double>(part.end - begin));
    begin = part.end;
  }
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  ShiningTriangle shining{item, 0, sum / static_cast<double>(parts.back().end)};
  if (parts.size() == 1) return shining;
  shining.parts =
      std::uint32_t{emission.depths[item]} << gpu::kPartDepthShift | static_cast<std::uint32_t>(words.size());
  words.push_back(static_cast<std::uint32_t>(parts.size()));
  const std::vector<std::uint32_t> ends = build_intervals(weights);
  words.insert(words.end(), ends.begin(), ends.end());
  for (const EmissionPart& part : parts) words.push_back(part.end);
  return shining;
}

void add_triangles(const Scene& scene, std::span<const Object> objects, std::span<const std::uint32_t> object_of,
                   const Emission& emission, PackedScene& packed, LightList& list) {
  std::vector<std::vector<ShiningTriangle>> shining(objects.size());
  for (std::size_t i = 0; i < objects.size(); ++i)
    for (const std::uint32_t item : list_shining(objects[i], emission, packed, packed.triangles))
      shining[i].push_back(cut_in_parts(item, emission, packed.light_parts));
  std::vector<std::uint32_t> placed(packed.root_is_top ? object_of.size() : 1); // by the order of the source
  for (std::uint32_t i = 0; i < packed.instances.size(); ++i) placed[packed.instances[i].id] = i;
  for (const std::uint32_t i : placed) {
    if (packed.root_is_top) packed.instances[i].first_light = static_cast<std::uint32_t>(list.lights.size());
    const gpu::Instance* instance = packed.root_is_top ? &packed.instances[i] : nullptr;
    for (const ShiningTriangle& triangle : shining[packed.root_is_top ? object_of[i] : 0]) {
      gpu::Light light{};
      light.kind = gpu::kLightTriangle;
      light.triangle = triangle.item;
      light.instance = i;
      light.triangle_id = packed.triangles[triangle.item].id;
      light.parts = triangle.parts;
      const double area = world_area(packed.triangles[triangle.item], instance);
      add_light(scene, list, light, triangle.density * area, area);
    }
  }
}

// KHR_lights_punctual's cosine falloff, clamp(cos * scale + offset, 0, 1)^2; returns its integral over the sphere.
double set_spot_falloff(const PunctualLight& source, gpu::Light& light) {
  const double inner = std::cos(source.inner_cone), outer = std::cos(source.outer_cone);
  const double scale = 1.0 / std::max(0.001, inner - outer);
  light.spot_scale = static_cast<float>(scale);
  light.spot_offset = static_cast<float>(-outer * scale);
  // Squared ramp from outer on, reaching 1 where cos = outer + 1/scale (or at cos = 1, if that comes first).
  const double full = outer + 1.0 / scale, top = std::min(full, 1.0);
  return 2.0 * pi * (std::pow(top - outer, 3.0) * scale * scale / 3.0 + (1.0 - top));
}

// Integral over the sphere of what kernels read of a profile, which goes linearly from angle to angle.
double profile_integral(const LightProfile& profile) {
  const std::size_t rows = profile.vertical.size();
  std::vector<double> meridians; // integrals of intensity times sine
  for (std::size_t c = 0; c < profile.horizontal.size(); ++c) {
    double sum = 0.0;
    for (std::size_t r = 0; r + 1 < rows; ++r) {
      const double a = profile.vertical[r], b = profile.vertical[r + 1];
      const double p = profile.intensities[c * rows + r], q = profile.intensities[c * rows + r + 1];
      sum += p * (std::cos(a) - std::cos(b)) + (q - p) * ((std::sin(b) - std::sin(a)) / (b - a) - std::cos(b));
    }
    meridians.push_back(sum);
  }
  if (meridians.size() == 1) return 2.0 * pi * meridians[0];
  double sum = 0.0;
  for (std::size_t c = 0; c + 1 < meridians.size(); ++c) {
    const double a = profile.horizontal[c], b = profile.horizontal[c + 1];
    const double begin = std::max(a, 0.0), end = std::min(b, 2.0 * pi), middle = (0.5 * (begin + end) - a) / (b - a);
    sum += (end - begin) * (meridians[c] + middle * (meridians[c + 1] - meridians[c]));
  }
  return sum;
}

std::uint32_t word(float value) { return std::bit_cast<std::uint32_t>(value); }

// Table of a profile among the words behind the lights; returns its first word. See kernels/base/scene_types.h.
std::uint32_t add_table(const LightProfile& profile, std::vector<std::uint32_t>& words) {
  const auto first = static_cast<std::uint32_t>(words.size());
  words.push_back(static_cast<std::uint32_t>(profile.vertical.size()));
  words.push_back(static_cast<std::uint32_t>(profile.horizontal.size()));
  for (const auto* values : {&profile.vertical, &profile.horizontal, &profile.intensities})
    for (const float value : *values) words.push_back(word(value));
  return first;
}

// What a light says of its profile; returns Light::parts.
std::uint32_t add_profile(const PunctualLight& source, std::uint32_t table, std::vector<std::uint32_t>& words) {
  const auto first = static_cast<std::uint32_t>(words.size());
  for (const glm::dvec3& v : {source.direction, source.tangent})
    for (int i = 0; i < 3; ++i) words.push_back(word(static_cast<float>(v[i])));
  words.push_back(table);
  return first + 1;
}

// The `range` of KHR_lights_punctual dims light by distance, of which the powers here take no account: they decide the
// noise.
void add_punctual(const Scene& scene, bool directional, double radius, PackedScene& packed, LightList& list) {
  std::map<std::uint32_t, std::uint32_t> tables; // by profile
  for (std::uint32_t index = 0; index < scene.lights.size(); ++index) {
    const PunctualLight& source = scene.lights[index];
    if ((source.kind == LightKind::directional) != directional) continue;
    gpu::Light light{};
    light.intensity = source.intensity;
    light.position = source.position - packed.origin;
    light.inverse_range = !directional && source.range > 0.0 ? static_cast<float>(1.0 / source.range) : 0.0f;
    light.pdf_area =
        static_cast<float>(directional ? 2.0 * std::pow(std::sin(0.5 * source.extent), 2.0) : source.extent);
    double power = luminance(source.intensity);
    switch (source.kind) {
      case LightKind::point:
        light.kind = gpu::kLightPoint;
        if (source.profile == kNoIndex) {
          power *= 4.0 * pi;
          break;
        }
        if (const auto [table, is_new] = tables.emplace(source.profile, 0); is_new)
          table->second = add_table(scene.profiles[source.profile], packed.light_parts);
        light.parts = add_profile(source, tables.at(source.profile), packed.light_parts);
        power *= profile_integral(scene.profiles[source.profile]);
        break;
      case LightKind::spot:
        light.kind = gpu::kLightSpot;
        light.direction = source.direction;
        power *= set_spot_falloff(source, light);
        break;
      case LightKind::directional:
        light.kind = gpu::kLightDirectional;
        light.direction = -source.direction;
        light.position = glm::vec3(0.0f);
        power *= pi * radius * radius;
        break;
    }
    if (!(power > 0.0) || !std::isfinite(power)) continue;
    add_light(scene, list, light, power);
    packed.lamp_sources.push_back(index);
  }
}

// Half of the picks go to the groups alike, half by power through the scene's bounding sphere: a distant light never
// starves a lamp, however large the scene.
std::vector<double> weigh(const LightList& list) {
  std::array<double, kGroupCount> power{};
  for (std::size_t i = 0, group = 0; i < list.powers.size(); ++i) {
    while (i >= list.ends[group]) ++group;
    power[group] += list.powers[i];
  }
  double total = 0.0, present = 0.0;
  for (const double p : power) total += p, present += p > 0.0;
  std::vector<double> weights = list.powers;
  for (std::size_t i = 0, group = 0; i < weights.size(); ++i) {
    while (i >= list.ends[group]) ++group;
    if (weights[i] > 0.0) weights[i] *= 0.5 / total + 0.5 / (present * power[group]);
  }
  return weights;
}

LightBounds lamp_bounds(const gpu::Light& light, double power) {
  // That of a profile shines as brightly as its mean in all directions, for who picks lights.
  if (light.kind == gpu::kLightPoint) return point_light_bounds(light.position, power / (4.0 * pi));
  const double outer = std::acos(std::clamp(-double{light.spot_offset} / light.spot_scale, -1.0, 1.0));
  return spot_light_bounds(light.position, light.direction, outer, luminance(light.intensity), power);
}

LightBounds bounds_of(const gpu::Light& light, double power, double area, const PackedScene& packed) {
  if (light.kind == gpu::kLightPoint || light.kind == gpu::kLightSpot) {
    LightBounds bounds = lamp_bounds(light, power);
    const float radius = light.pdf_area;
    bounds.lo -= radius, bounds.hi += radius;
    return bounds;
  }
  const gpu::Triangle& triangle = packed.triangles[light.triangle];
  const bool two_sided =
      (packed.materials[triangle.surface & gpu::kTriangleMaterialMask].flags & gpu::kMaterialDoubleSided) != 0;
  glm::vec3 corners[3];
  for (int k = 0; k < 3; ++k) {
    const glm::dvec3 p = k == 0 ? triangle.v0 : k == 1 ? triangle.v1 : triangle.v2;
    corners[k] = glm::vec3(p);
    if (!packed.root_is_top) continue;
    const auto& rows = packed.instances[light.instance].world_from_object;
    for (int row = 0; row < 3; ++row)
      corners[k][row] = static_cast<float>(glm::dot(glm::dvec4(rows[row]), glm::dvec4(p, 1.0)));
  }
  // Normals keep to the front of a mirrored object, whose corners are then met clockwise.
  if (packed.root_is_top && packed.instances[light.instance].flipped) std::swap(corners[1], corners[2]);
  return triangle_light_bounds(corners, power / (pi * area * (two_sided ? 2.0 : 1.0)), two_sided);
}

// The number of locations of the local lights: as many cubes, a `part` of the scene's radius wide, of equal power would
// vary as much.
double count_locations(const std::vector<LightBounds>& lights, double radius, double part) {
  std::unordered_map<std::uint64_t, double> power;
  double total = 0.0, squares = 0.0;
  for (const LightBounds& light : lights) {
    const glm::dvec3 centre = 0.5 * (glm::dvec3(light.lo) + glm::dvec3(light.hi));
    const glm::i64vec3 cell(glm::floor(glm::clamp(centre / (part * radius), -1e6, 1e6)));
    power[static_cast<std::uint64_t>((cell.x & 0xfffff) | (cell.y & 0xfffff) << 20 | (cell.z & 0xfffff) << 40)] +=
        light.power;
    total += light.power;
  }
  for (const auto& [cell, p] : power) squares += p * p;
  return squares > 0.0 ? total * total / squares : 0.0;
}

void pack_light_tree(const LightList& list, double radius, bool if_many, PackedScene& packed) {
  std::vector<LightBounds> bounds(list.ends[kLocal]);
  tbb::parallel_for(std::size_t{0}, bounds.size(), [&](std::size_t i) {
    bounds[i] = bounds_of(list.lights[i], list.powers[i], list.areas[i], packed);
  });
  packed.light_locations = count_locations(bounds, radius, kPlace);
  const bool many =
      packed.light_locations >= kManyLocations || count_locations(bounds, radius, kSmallPlace) >= kManySmallPlaces;
  if (if_many && !many) return;
  const LightTree tree = build_light_tree(bounds);
  packed.light_tree = light_tree_words(tree);
  packed.light_tree_depth = tree.depth;
}

} // namespace

void pack_lights(Scene& scene, std::span<const Object> objects, std::span<const std::uint32_t> object_of,
                 double environment_integral, std::uint32_t direct, std::uint32_t selection, PackedScene& packed) {
  if (direct == gpu::kDirectBsdf) {
    if (!scene.lights.empty())
      scene.warnings.add("punctual lights cannot be met by rays and are dark with --direct bsdf", scene.lights.size());
    return;
  }
  const double radius = packed.radius > 0.0 ? packed.radius : 1.0;
  LightList list;
  const Emission emission = find_emission(packed, objects);
  if (!emission.empty()) add_triangles(scene, objects, object_of, emission, packed, list);
  add_punctual(scene, false, radius, packed, list);
  list.ends[kLocal] = list.lights.size();
  add_punctual(scene, true, radius, packed, list);
  list.ends[kDirectional] = list.lights.size();
  const bool sample_environment =
      environment_integral > 0.0 && (!packed.environment.empty() || direct == gpu::kDirectNee);
  if (sample_environment) {
    gpu::Light light{};
    light.kind = gpu::kLightEnvironment;
    add_light(scene, list, light, pi * radius * radius * environment_integral);
  }
  list.ends[kEnvironment] = list.lights.size();

  const std::vector<std::uint32_t> ends = build_intervals(weigh(list));
  if (ends.empty()) return;
  for (std::size_t i = 0; i < list.lights.size(); ++i) {
    const double probability = interval_probability(ends, i);
    list.lights[i].probability = static_cast<float>(probability);
    list.lights[i].end = ends[i];
    if (list.areas[i] > 0.0) list.lights[i].pdf_area = static_cast<float>(probability / list.areas[i]);
  }
  if (sample_environment) packed.environment_probability = list.lights.back().probability;
  packed.local_light_count = static_cast<std::uint32_t>(list.ends[kLocal]);
  double power = 0.0; // as if all shone into the scene's sphere
  for (const double p : list.powers) power += p;
  packed.typical_radiance = power / (4.0 * pi * pi * radius * radius);
  const std::size_t least = selection == gpu::kLightsAuto ? kFewLights + 1 : 1;
  if (selection != gpu::kLightsPower && list.ends[kLocal] >= least)
    pack_light_tree(list, radius, selection == gpu::kLightsAuto, packed);
  packed.lights = std::move(list.lights);
}

} // namespace wavepath
