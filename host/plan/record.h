// The plan as JSON, which stats, pictures and states hold; and the decisions that a later command reads from it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "host/plan/decision.h"
#include "host/render/settings/render_plan.h"

namespace wavepath {

// Values, spelled as on the command line, that pilots, rules or the length of the render decided. The choice of lights
// is not recorded, since it follows from how the scene was packed.
struct PlanRecord {
  std::vector<std::pair<std::string, std::string>> values; // pairs of setting name and value
  std::optional<std::uint64_t> training_paths;             // Training::paths
  std::optional<std::uint32_t> guide_iterations;
  bool operator==(const PlanRecord&) const = default;
};

// Adds entries for settings that the command line alone decided, so that the list is the whole plan. `trains`: the
// render trains light selection.
void complete(std::vector<Decision>& decisions, const RenderPlan& settings, bool trains);

// [{"what", "taken", "why", "cost", "cost_ci95", "seconds", "render_seconds", "fraction", "pilot", "trials"}]
nlohmann::ordered_json to_json(const std::vector<Decision>& decisions);
// The same on one line, without measured values, for the headers of files.
std::string to_line(const std::vector<Decision>& decisions);

// Reads the decisions of such a list. Throws nlohmann::json::exception if the JSON is no such list.
PlanRecord record_from(const nlohmann::ordered_json& decisions);

// Copies the recorded values into those settings that are at their defaults. Throws UsageError for a value that the
// setting does not have.
void apply(const PlanRecord& record, RenderPlan& settings);

} // namespace wavepath
