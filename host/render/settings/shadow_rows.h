// The rows of the table of settings that shadow techniques have.
#pragma once

#include <vector>

#include "host/render/settings/setting.h"

namespace wavepath {

// A technique that answers shadow rays from what lights see, and what can be set of it.
std::vector<Setting> shadow_rows();

} // namespace wavepath
