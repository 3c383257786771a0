#include "host/cli/plan_report.h"

#include <algorithm>

#include <fmt/format.h>

namespace wavepath {
namespace {

// "pilots: 1.7 % of the paths", "pilots: 1.7 % of the paths, 0.21 s"; empty where there are none.
std::string pilots_text(const Decision& decision) {
  std::string text;
  if (decision.fraction > 0.0) text = fmt::format("pilots: {:.2g} % of the paths", 100.0 * decision.fraction);
  if (decision.seconds > 0.0) text += fmt::format("{}{:.2f} s", text.empty() ? "" : ", ", decision.seconds);
  return text;
}

} // namespace

std::string plan_line(const Decision& decision) {
  return fmt::format("plan: {} {}: {}", decision.what, decision.taken, decision.why);
}

std::string plan_table(const std::vector<Decision>& decisions) {
  std::string table;
  for (const Decision& decision : decisions) {
    const std::string pilots = pilots_text(decision);
    table += fmt::format("  {:<18}{:<14}{}{}\n", decision.what, decision.taken, decision.why,
                         pilots.empty() ? "" : fmt::format(" ({})", pilots));
    for (const Trial& trial : decision.trials)
      table += fmt::format(
          "  {:<18}  {}: {:.2g}x ({:.2g} to {:.2g}){}\n", "", trial.flags, trial.cost, trial.lo, trial.hi,
          trial.missing > 0.0 ? fmt::format(", lacks {:.2g} % of the light", 100.0 * trial.missing) : std::string());
  }
  return table;
}

} // namespace wavepath
