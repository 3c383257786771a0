// The row of the table of settings that techniques of anti-aliasing have.
#pragma once

#include <vector>

#include "host/render/settings/setting.h"

namespace wavepath {

std::vector<Setting> antialias_rows();

} // namespace wavepath
