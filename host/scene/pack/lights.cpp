// Lists lights, weighs them by power and builds their alias table; see lights.h.
#include "host/scene/pack/lights.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <tbb/parallel_sort.h>

#include "host/base/error.h"
#include "host/scene/pack/alias.h"
#include "host/scene/pack/emission.h"

namespace wavepath {
namespace {

constexpr std::size_t kMostLights = std::size_t{1} << 26; // 5 GiB
constexpr double kPi = std::numbers::pi;

struct LightList {
  std::vector<gpu::Light> lights;
  std::vector<double> powers;
};

void add_light(const Scene& scene, LightList& list, const gpu::Light& light, double power) {
  if (list.lights.size() == kMostLights)
    throw Error(scene.path, "has more than 67108864 lights", "use --direct bsdf, or fewer emissive triangles");
  list.lights.push_back(light);
  list.powers.push_back(power);
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

// Place of the triangle's centre on a Z-curve through the object's box, 2^21 cells an axis.
std::uint64_t place_on_curve(const gpu::Triangle& triangle, const Object& object) {
  const glm::dvec3 lo = object.lo, size = glm::max(glm::dvec3(object.hi) - lo, glm::dvec3(1e-300));
  const glm::dvec3 centre = (glm::dvec3(triangle.v0) + glm::dvec3(triangle.v1) + glm::dvec3(triangle.v2)) / 3.0;
  const glm::dvec3 cell = glm::clamp((centre - lo) / size, 0.0, 1.0) * 0x1.fffffp20;
  std::uint64_t place = 0;
  for (int bit = 20; bit >= 0; --bit)
    for (int axis = 0; axis < 3; ++axis) place = place << 1 | (static_cast<std::uint64_t>(cell[axis]) >> bit & 1u);
  return place;
}

// Emissive items of the object, one copy of each triangle, sorted along a Z-curve: stratified random numbers then pick
// stratified lights (in the order of the source, a sphere of 3,968 triangles has 1.9 times the noise). The order does
// not depend on the tree, so neither does the picture.
std::vector<std::uint32_t> list_shining(const Object& object, const std::vector<double>& densities,
                                        const PackedScene& packed) {
  struct Shining {
    std::uint64_t place;
    std::uint32_t id, item;
    auto operator<=>(const Shining&) const = default;
  };
  std::vector<Shining> all;
  for (std::uint32_t item = object.first_item; item < object.first_item + object.item_count; ++item) {
    const gpu::Triangle& triangle = packed.triangles[item];
    if (densities[item] > 0.0) all.push_back({place_on_curve(triangle, object), triangle.id, item});
  }
  tbb::parallel_sort(all.begin(), all.end());
  std::vector<std::uint32_t> items;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (i == 0 || all[i].id != all[i - 1].id) items.push_back(all[i].item);
  return items;
}

void add_triangles(const Scene& scene, std::span<const Object> objects, std::span<const std::uint32_t> object_of,
                   const std::vector<double>& densities, const PackedScene& packed, LightList& list) {
  std::vector<std::vector<std::uint32_t>> shining;
  for (const Object& object : objects) shining.push_back(list_shining(object, densities, packed));
  std::vector<std::uint32_t> placed(packed.root_is_top ? object_of.size() : 1); // by the order of the source
  for (std::uint32_t i = 0; i < packed.instances.size(); ++i) placed[packed.instances[i].id] = i;
  for (const std::uint32_t i : placed)
    for (const std::uint32_t item : shining[packed.root_is_top ? object_of[i] : 0]) {
      gpu::Light light{};
      light.kind = gpu::kLightTriangle;
      light.triangle = item;
      light.instance = i;
      light.triangle_id = packed.triangles[item].id;
      const gpu::Instance* instance = packed.root_is_top ? &packed.instances[i] : nullptr;
      add_light(scene, list, light, densities[item] * world_area(packed.triangles[item], instance));
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
  return 2.0 * kPi * (std::pow(top - outer, 3.0) * scale * scale / 3.0 + (1.0 - top));
}

// KHR_lights_punctual's `range` is ignored: it is a hint for culling, and physical falloff has no limit.
void add_punctual(const Scene& scene, const PackedScene& packed, double radius, LightList& list) {
  for (const PunctualLight& source : scene.lights) {
    gpu::Light light{};
    light.intensity = source.intensity;
    light.position = source.position - packed.origin;
    double power = luminance(source.intensity);
    switch (source.kind) {
      case LightKind::point:
        light.kind = gpu::kLightPoint;
        power *= 4.0 * kPi;
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
        power *= kPi * radius * radius;
        break;
    }
    if (power > 0.0 && std::isfinite(power)) add_light(scene, list, light, power);
  }
}

} // namespace

void pack_lights(Scene& scene, std::span<const Object> objects, std::span<const std::uint32_t> object_of,
                 double environment_integral, std::uint32_t direct, PackedScene& packed) {
  if (direct == gpu::kDirectBsdf) {
    if (!scene.lights.empty())
      scene.warnings.add("punctual lights cannot be met by rays and are dark with --direct bsdf", scene.lights.size());
    return;
  }
  const double radius = packed.radius > 0.0 ? packed.radius : 1.0;
  LightList list;
  const std::vector<double> densities = emission_densities(packed);
  if (!densities.empty()) add_triangles(scene, objects, object_of, densities, packed, list);
  add_punctual(scene, packed, radius, list);
  const bool sample_environment =
      environment_integral > 0.0 && (!packed.environment.empty() || direct == gpu::kDirectNee);
  if (sample_environment) {
    gpu::Light light{};
    light.kind = gpu::kLightEnvironment;
    add_light(scene, list, light, kPi * radius * radius * environment_integral);
  }

  const AliasTable table = build_alias_table(list.powers);
  if (table.threshold.empty()) return;
  const std::vector<double> probability = alias_probabilities(table);
  for (std::size_t i = 0; i < list.lights.size(); ++i) {
    list.lights[i].probability = static_cast<float>(probability[i]);
    list.lights[i].threshold = table.threshold[i];
    list.lights[i].alias = table.alias[i];
  }
  if (sample_environment) packed.environment_probability = list.lights.back().probability;
  packed.lights = std::move(list.lights);
  for (std::size_t t = 0; t < densities.size(); ++t)
    packed.triangles[t].light_pdf = static_cast<float>(densities[t] / table.total);
}

} // namespace wavepath
