// The plan as JSON, as the stats, pictures and states hold it; and the decisions that a later command takes from there.
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

// Values, as the command line has them, of what pilots and the length of the render decide. What rules decide from the
// scene alone repeats by itself.
struct PlanRecord {
  std::vector<std::pair<std::string, std::string>> values; // by name of the setting
  std::optional<std::uint64_t> training_paths;             // Training::paths
  std::optional<std::uint32_t> guide_iterations;
  bool operator==(const PlanRecord&) const = default;
};

// Adds to the decisions those that nothing but the command line made, so that the list tells the whole plan. `trains`:
// the choice of lights.
void complete(std::vector<Decision>& decisions, const RenderPlan& settings, bool trains);

// [{"what", "taken", "why", "cost", "cost_ci95", "seconds", "render_seconds", "fraction", "pilot", "trials"}]
nlohmann::ordered_json to_json(const std::vector<Decision>& decisions);
// The same without what was measured, on one line, for headers of files.
std::string to_line(const std::vector<Decision>& decisions);

// What such a list decided. Throws nlohmann::json::exception where it is none.
PlanRecord record_from(const nlohmann::ordered_json& decisions);

// Takes over what was recorded for settings that are at their defaults. Throws UsageError for a value that no setting
// has.
void apply(const PlanRecord& record, RenderPlan& settings);

} // namespace wavepath
