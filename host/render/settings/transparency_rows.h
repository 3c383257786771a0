// The rows of the table of settings that techniques of transparency have.
#pragma once

#include <vector>

#include "host/render/settings/setting.h"

namespace wavepath {

std::vector<Setting> transparency_rows();

} // namespace wavepath
