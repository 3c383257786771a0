// Which settings ask for surface voxels, and the row of the table of settings that is about them.
#pragma once

#include <string_view>
#include <vector>

#include "host/render/settings/render_plan.h"
#include "host/render/settings/setting.h"

namespace wavepath {

// True if a technique that the settings name traces cones.
bool uses_voxels(const RenderPlan& settings);

std::vector<Setting> voxel_rows();

// False if `setting` is about voxels, and none are used.
bool voxels_support(const RenderPlan& settings, std::string_view setting);
// Throws UsageError if settings are about voxels that no technique uses.
void check_voxel_settings(const RenderPlan& settings);

} // namespace wavepath
