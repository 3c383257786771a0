// Runs cases of the numerical suite and prints the results, a line for each case or as one JSON document.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "host/selftest/selftest.h"

namespace wavepath {

struct SelftestRequest {
  std::vector<std::string> only; // cases whose name holds one of these; empty = all
  bool json = false;
};

// Returns the exit code: kExitFailed if any failed. Throws UsageError where nothing is to be run.
int report_cases(std::span<const SelftestCase> cases, const SelftestContext& context, const SelftestRequest& request);

} // namespace wavepath
