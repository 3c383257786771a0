// The rows of the table of settings that techniques of hybrid frames have.
#pragma once

#include <vector>

#include "host/render/settings/setting.h"

namespace wavepath {

std::vector<Setting> technique_rows();

} // namespace wavepath
