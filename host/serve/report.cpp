#include "host/serve/report.h"

#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "host/picture/tonemap.h"
#include "host/render/settings/settings_table.h"
#include "host/session/viewing/viewed_scene.h"

namespace wavepath {
namespace {

using Json = nlohmann::json;

// Names in files need not be UTF-8.
std::string dumped(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

Json finite(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json json_of(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

// A row of the table as a widget: its kind tells which.
Json row_of(const Setting& row, const RenderPlan& settings) {
  Json json = {{"name", row.name}, {"label", row.label}, {"meaning", row.meaning}, {"value", text_of(row, settings)}};
  if (const auto* choice = std::get_if<ChoiceValue>(&row.value); choice && !choice->bare.empty()) {
    json["kind"] = "switch";
    json["on"] = choice->bare, json["off"] = text_of(row, RenderPlan{});
  } else if (const std::vector<std::string_view> names = choices_of(row); !names.empty()) {
    json["kind"] = "choice";
    json["choices"] = names;
  } else if (const auto* whole = std::get_if<WholeValue>(&row.value)) {
    json["kind"] = "whole";
    json["lowest"] = whole->lowest, json["highest"] = whole->highest;
    json["value"] = std::to_string(number_of(*whole, settings));
  } else if (const auto* number = std::get_if<NumberValue>(&row.value)) {
    json["kind"] = "number";
    json["lowest"] = number->lowest, json["highest"] = number->highest;
    json["value"] = Json(number->in(settings)).dump();
  } else {
    json["kind"] = "switch";
    json["on"] = "on", json["off"] = "off";
    json["value"] = settings.*std::get<SwitchValue>(row.value).member ? "on" : "off";
  }
  return json;
}

} // namespace

std::string scene_json(const SceneReport& report) {
  const RenderPlan& settings = report.settings;
  Json rows = Json::array(), shown = Json::array();
  for (const Setting& row : settings_table())
    if (is_viewed(row, *settings.integrator)) rows.push_back(row_of(row, settings));
  for (std::size_t i = 0; i < kShownNames.size(); ++i) {
    const auto quantity = static_cast<Shown>(i);
    if (quantity != Shown::shadow_error && can_show(*settings.integrator, quantity)) shown.push_back(kShownNames[i]);
  }
  Json groups = Json::array();
  for (std::size_t g = 0; g < settings.group_names.size(); ++g)
    groups.push_back({{"name", settings.group_names[g]},
                      {"gain", g < report.display.group_gains.size() ? report.display.group_gains[g] : 1.0f}});
  Json plan = Json::array();
  for (const Decision& decision : report.plan)
    plan.push_back({{"what", decision.what}, {"taken", decision.taken}, {"why", decision.why}});
  return dumped({{"type", "scene"},
                 {"scene", report.scene},
                 {"device", report.device},
                 {"light", report.light},
                 {"triangles", report.triangles},
                 {"lights", report.lights},
                 {"cameras", report.cameras},
                 {"notes", report.notes},
                 {"plan", plan},
                 {"width", settings.width},
                 {"height", settings.height},
                 {"settings", rows},
                 {"shown", shown},
                 {"show", kShownNames[static_cast<std::size_t>(report.display.shown)]},
                 {"tonemaps", kTonemapNames},
                 {"tonemap", kTonemapNames[static_cast<std::size_t>(report.display.tonemap)]},
                 {"auto_exposure", report.display.auto_exposure},
                 {"exposure", report.display.exposure},
                 {"groups", groups},
                 {"environments", report.environments},
                 {"environment",
                  {{"source", report.environment.source},
                   {"intensity", report.environment.intensity},
                   {"degrees", report.environment.degrees}}},
                 {"target", report.target_error}});
}

std::string status_json(const StatusReport& report) {
  const ProgressiveStatus& s = report.status;
  const bool knows = s.error_spp > 0;
  const double all = s.fraction > 0.0 ? s.seconds * (1.0 - s.fraction) / s.fraction : NAN;
  const char* state = s.compiling      ? "compiling kernels"
                      : report.reached ? "target reached"
                      : s.done         ? "done"
                      : s.coarse > 1   ? "moving"
                                       : "rendering";
  return dumped(
      {{"type", "status"},
       {"state", state},
       {"done", s.done},
       {"spp", s.spp},
       {"planned", s.planned},
       {"coarse", s.coarse},
       {"fraction", s.fraction},
       {"seconds", s.seconds},
       {"seconds_left", finite(all)},
       {"frame_seconds", s.frame_seconds},
       {"mrays_per_second", s.mrays_per_second},
       {"error", knows ? Json(s.error.relative_rms) : Json(nullptr)},
       {"ci95", knows ? Json({s.error.ci95[0], s.error.ci95[1]}) : Json(nullptr)},
       {"error_spp", s.error_spp},
       {"slope", s.slope},
       {"target", report.target_error},
       {"seconds_to_target", report.target_error > 0.0 ? finite(report.seconds_to_target) : Json(nullptr)},
       {"exposure", report.exposure},
       {"memory",
        {{"scene", s.memory.scene}, {"bvh", s.memory.bvh}, {"paths", s.memory.paths}, {"film", s.memory.film}}},
       {"viewers", report.viewers}});
}

std::string role_json(bool steers, bool is_asked) {
  return dumped({{"type", "role"}, {"steers", steers}, {"asked", is_asked}});
}

std::string pick_json(const PickReport& report) {
  Json values = Json::array();
  for (const auto& [name, value] : report.values) values.push_back({{"name", name}, {"value", finite(value)}});
  Json json = {{"type", "picked"},
               {"at", {report.at.x, report.at.y}},
               {"pixel", {report.x, report.y}},
               {"values", values},
               {"spp", report.spp},
               {"node", nullptr},
               {"material", nullptr},
               {"point", nullptr}};
  if (report.node) json["node"] = *report.node;
  if (report.material) json["material"] = *report.material;
  if (report.point) json["point"] = json_of(*report.point), json["distance"] = report.distance;
  return dumped(json);
}

std::string copied_json(const std::string& line) { return dumped({{"type", "copied"}, {"line", line}}); }

std::string note_json(const std::string& text) { return dumped({{"type", "note"}, {"text", text}}); }

} // namespace wavepath
