// The plan in words.
#pragma once

#include <string>
#include <vector>

#include "host/plan/decision.h"

namespace wavepath {

// "plan: reuse on: pilots: a given error costs 0.45x the work without".
std::string plan_line(const Decision& decision);

// A line for each decision, in columns, with what its pilots take of the render.
std::string plan_table(const std::vector<Decision>& decisions);

} // namespace wavepath
