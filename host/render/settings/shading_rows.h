// The rows of the table of settings that local illumination has.
#pragma once

#include <vector>

#include "host/render/settings/setting.h"

namespace wavepath {

std::vector<Setting> shading_rows();

} // namespace wavepath
