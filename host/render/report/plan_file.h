// The plan of an earlier render, from a file that holds one.
#pragma once

#include <string>

#include "host/plan/record.h"

namespace wavepath {

// From a picture (.exr), a state of --checkpoint, or a stats document (.json). Throws Error where there is none.
PlanRecord read_plan(const std::string& path);

} // namespace wavepath
