#include "host/plan/record.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/render/settings/settings_table.h"

namespace wavepath {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kTrainingPathsName = "training-paths", kGuideIterationsName = "guide-iterations";

bool is_planned(std::string_view name) {
  return std::ranges::any_of(settings_table(), [&](const Setting& row) { return row.planned && row.name == name; });
}

template <class Number>
std::optional<Number> number_from(const std::string& text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc{} && end == text.data() + text.size() ? std::optional(number) : std::nullopt;
}

Json pilot_json(const PilotPicture& pilot) {
  if (pilot.spp == 0) return nullptr;
  return {{"size", {pilot.width, pilot.height}}, {"spp", pilot.spp}};
}

} // namespace

void complete(std::vector<Decision>& decisions, const RenderPlan& settings, bool trains) {
  const auto add = [&](std::string_view what, std::string taken, const char* why) {
    if (std::ranges::count(decisions, what, &Decision::what) == 0)
      decisions.push_back({.what = what, .taken = std::move(taken), .why = why});
  };
  for (const Setting& row : settings_table()) {
    if (!row.planned || !is_supported(row, settings)) continue;
    if (const std::string text = text_of(row, settings); !text.empty())
      add(row.name, text, "as asked, or with another decision");
  }
  if (trains || settings.guide)
    add(kTrainingPathsName, fmt::format("{}", settings.training.paths),
        settings.training.paths > 0 ? "rule: by the paths of the render" : "rule: as parts of a render have");
  if (settings.guide)
    add(kGuideIterationsName, fmt::format("{}", settings.training.guide_iterations),
        "rule: by the paths of the render");
}

Json to_json(const std::vector<Decision>& decisions) {
  Json list = Json::array();
  for (const Decision& decision : decisions) {
    Json trials = Json::array();
    for (const Trial& trial : decision.trials)
      trials.push_back({{"flags", trial.flags},
                        {"cost", trial.cost},
                        {"cost_ci95", {trial.lo, trial.hi}},
                        {"missing_light", trial.missing},
                        {"disagrees", trial.disagrees}});
    list.push_back({{"what", decision.what},
                    {"taken", decision.taken},
                    {"why", decision.why},
                    {"cost", decision.cost},
                    {"cost_ci95", {decision.lo, decision.hi}},
                    {"seconds", decision.seconds},
                    {"render_seconds", decision.render_seconds},
                    {"fraction", decision.fraction},
                    {"pilot", pilot_json(decision.pilot)},
                    {"trials", trials}});
  }
  return list;
}

std::string to_line(const std::vector<Decision>& decisions) {
  Json list = Json::array();
  for (const Decision& decision : decisions)
    list.push_back({{"what", decision.what}, {"taken", decision.taken}, {"why", decision.why}});
  return list.dump();
}

PlanRecord record_from(const Json& decisions) {
  PlanRecord record;
  for (const Json& decision : decisions) {
    const std::string what = decision.at("what"), taken = decision.at("taken");
    if (what == kTrainingPathsName)
      record.training_paths = number_from<std::uint64_t>(taken);
    else if (what == kGuideIterationsName)
      record.guide_iterations = number_from<std::uint32_t>(taken);
    else if (is_planned(what))
      record.values.emplace_back(what, taken);
  }
  return record;
}

void apply(const PlanRecord& record, RenderPlan& settings) {
  for (const auto& [name, value] : record.values) {
    const Setting& row = setting_named(name);
    const bool open = name == "integrator" ? settings.integrator.is_auto() : is_default(row, settings);
    if (open) read_setting(row, value, settings);
  }
  if (record.training_paths) settings.training.paths = *record.training_paths;
  if (record.guide_iterations) settings.training.guide_iterations = *record.guide_iterations;
}

} // namespace wavepath
