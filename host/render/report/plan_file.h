// Reads the plan of an earlier render from a file.
#pragma once

#include <string>

#include "host/plan/record.h"

namespace wavepath {

// Reads the plan from a picture (.exr), a state of --checkpoint, or a stats document (.json). Throws Error if the file
// has none.
PlanRecord read_plan(const std::string& path);

} // namespace wavepath
