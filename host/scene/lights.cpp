// Lists lights, weighs them by power and builds their alias table; see lights.h.
#include "host/scene/lights.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/base/error.h"
#include "host/scene/alias.h"
#include "host/scene/emission.h"

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

void add_triangles(const Scene& scene, std::span<const Object> objects, std::span<const std::uint32_t> object_of,
                   const std::vector<double>& densities, const PackedScene& packed, LightList& list) {
  const std::size_t placements = std::max<std::size_t>(object_of.size(), packed.root_is_top ? 0 : 1);
  for (std::size_t i = 0; i < placements; ++i) {
    const Object& object = objects[packed.root_is_top ? object_of[i] : 0];
    for (std::uint32_t t = object.first_triangle; t < object.first_triangle + object.triangle_count; ++t) {
      if (!(densities[t] > 0.0)) continue;
      gpu::Light light{};
      light.kind = gpu::kLightTriangle;
      light.triangle = t;
      light.instance = static_cast<std::uint32_t>(i);
      add_light(scene, list, light,
                densities[t] * world_area(packed.triangles[t], packed.root_is_top ? &packed.instances[i] : nullptr));
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
  return 2.0 * kPi * (std::pow(top - outer, 3.0) * scale * scale / 3.0 + (1.0 - top));
}

// KHR's `range` is ignored on purpose: it is a hint for culling, and the inverse square law knows no range.
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
