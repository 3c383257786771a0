// Lays out the trace of a path.
#include "host/cli/trace_report.h"

#include <cmath>
#include <string>

#include <fmt/format.h>

#include "host/render/workspace/nonfinite.h"
#include "host/scene/pack/hit_surface.h"

namespace wavepath {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kEndNames[] = {"escaped", "unlit", "depth", "absorbed", "roulette", "nonfinite"}; // by PathEnd
constexpr const char* kLightNames[] = {"triangle", "point", "spot", "directional", "environment"};      // by kLight...

Json number(double value) {
  if (std::isfinite(value)) return value;
  return std::isnan(value) ? "nan" : value > 0.0 ? "inf" : "-inf";
}
Json vector(const glm::dvec3& v) { return {number(v.x), number(v.y), number(v.z)}; }

// What a ray arrived at, or null.
Json hit_json(const PathVertex& vertex, const PackedScene& scene) {
  const gpu::Hit& hit = vertex.hit;
  if (hit.triangle == gpu::kNone) return nullptr;
  const gpu::Triangle& triangle = scene.triangles[hit.triangle];
  const std::uint32_t material = triangle.surface & gpu::kTriangleMaterialMask;
  const glm::dvec3 position = hit_position(scene, hit);
  Json instance = nullptr;
  if (scene.root_is_top) instance = scene.instances[hit.instance].id;
  return {{"triangle", scene.source_id(hit.triangle)},
          {"instance", instance},
          {"material", scene.material_names[material]},
          {"position", vector(position + scene.origin)},
          {"distance", number(glm::distance(glm::dvec3(vertex.ray.origin), position))},
          {"barycentrics", {number(1.0 - hit.b1 - hit.b2), number(hit.b1), number(hit.b2)}}};
}

Json shadow_json(const ShadowTrace& shadow, const PackedScene& scene) {
  const gpu::Light& light = scene.lights[shadow.ray.light];
  Json json{{"light", shadow.ray.light}, {"kind", kLightNames[light.kind]}};
  if (light.kind == gpu::kLightTriangle) json["triangle"] = scene.source_id(light.triangle);
  json["origin"] = vector(glm::dvec3(shadow.ray.origin) + scene.origin);
  json["direction"] = vector(glm::normalize(glm::dvec3(shadow.ray.direction)));
  json["contribution"] = vector(shadow.ray.contribution);
  json["blocked"] = shadow.blocked;
  return json;
}

Json vertex_json(const PathVertex& vertex, const PackedScene& scene) {
  Json shadows = Json::array();
  for (const ShadowTrace& shadow : vertex.shadows) shadows.push_back(shadow_json(shadow, scene));
  const Json pdf = vertex.pdf ? number(*vertex.pdf) : Json();
  return {{"origin", vector(glm::dvec3(vertex.ray.origin) + scene.origin)},
          {"direction", vector(vertex.ray.direction)},
          {"hit", hit_json(vertex, scene)},
          {"emission_gathered", vector(vertex.scattered.radiance)},
          {"shadow_rays", shadows},
          {"radiance", vector(vertex.radiance)},
          {"throughput", vector(vertex.scattered.throughput)},
          {"pdf", pdf}};
}

// Without quotes and brackets; nine digits tell any two floats apart.
std::string plain(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return fmt::format("{:.9g}", value.get<double>());
  if (!value.is_array()) return value.dump();
  std::string text;
  for (const Json& item : value) text += (text.empty() ? "" : " ") + plain(item);
  return text;
}

std::string hit_text(const Json& hit) {
  if (hit.is_null()) return "nothing";
  const std::string instance = hit["instance"].is_null() ? "" : " of instance " + plain(hit["instance"]);
  return fmt::format("triangle {}{}, material '{}', at {}, distance {}, barycentrics {}", plain(hit["triangle"]),
                     instance, plain(hit["material"]), plain(hit["position"]), plain(hit["distance"]),
                     plain(hit["barycentrics"]));
}

std::string shadow_text(const Json& shadow) {
  return fmt::format("to {} light {}, contribution {}, {}", plain(shadow["kind"]), plain(shadow["light"]),
                     plain(shadow["contribution"]), shadow["blocked"].get<bool>() ? "blocked" : "arrives");
}

} // namespace

Json trace_document(const PathTrace& trace, const PackedScene& scene, const RenderPlan& settings) {
  Json bounces = Json::array(), maker = nullptr;
  for (const PathVertex& vertex : trace.vertices) bounces.push_back(vertex_json(vertex, scene));
  if (trace.maker) maker = kMakerNames[*trace.maker];
  return {{"pixel", {trace.pixel.x, trace.pixel.y}},
          {"sample", trace.sample},
          {"seed", settings.seed},
          {"bounces", bounces},
          {"end", kEndNames[static_cast<std::size_t>(trace.end)]},
          {"radiance", vector(trace.radiance)},
          {"finite", !trace.maker.has_value()},
          {"kernel", maker}};
}

std::string trace_text(const Json& document) {
  std::string text = fmt::format("pixel {}, sample {}, seed {}\n", plain(document["pixel"]), plain(document["sample"]),
                                 plain(document["seed"]));
  std::size_t bounce = 0;
  for (const Json& vertex : document["bounces"]) {
    text += fmt::format("bounce {}\n", bounce++);
    text += fmt::format("  ray         from {} along {}\n", plain(vertex["origin"]), plain(vertex["direction"]));
    text += fmt::format("  hit         {}\n", hit_text(vertex["hit"]));
    text += fmt::format("  emission    radiance so far {}\n", plain(vertex["emission_gathered"]));
    for (const Json& shadow : vertex["shadow_rays"]) text += fmt::format("  shadow ray  {}\n", shadow_text(shadow));
    if (vertex["shadow_rays"].empty()) text += "  shadow ray  none\n";
    text += fmt::format("  radiance    {}\n", plain(vertex["radiance"]));
    text += fmt::format("  throughput  {}, pdf {}\n", plain(vertex["throughput"]),
                        vertex["pdf"].is_null() ? "none (one direction)" : plain(vertex["pdf"]));
  }
  text += fmt::format("end         {}\n", plain(document["end"]));
  text += fmt::format("radiance    {}, {}\n", plain(document["radiance"]),
                      document["finite"].get<bool>() ? "finite" : "made not finite by " + plain(document["kernel"]));
  return text;
}

} // namespace wavepath
