// Rows of the table of settings for the techniques of hybrid frames.
#pragma once

#include <vector>

#include "host/render/settings/setting.h"

namespace wavepath {

std::vector<Setting> technique_rows();

} // namespace wavepath
