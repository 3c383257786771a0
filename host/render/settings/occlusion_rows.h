// The rows of the table of settings that occlusion techniques have.
#pragma once

#include <vector>

#include "host/render/settings/setting.h"

namespace wavepath {

// A technique that finds ambient occlusion in what the picture shows, and what can be set of it.
std::vector<Setting> occlusion_rows();

} // namespace wavepath
