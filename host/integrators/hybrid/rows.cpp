#include "host/integrators/hybrid/rows.h"

#include <utility>

#include "host/integrators/hybrid/antialias/catalogue.h"
#include "host/integrators/hybrid/bounce/catalogue.h"
#include "host/integrators/hybrid/occlusion/catalogue.h"
#include "host/integrators/hybrid/reflections/catalogue.h"
#include "host/integrators/hybrid/shading/catalogue.h"
#include "host/integrators/hybrid/shadows/catalogue.h"
#include "host/integrators/hybrid/transparency/catalogue.h"
#include "host/integrators/hybrid/voxel_settings.h"

namespace wavepath {

std::vector<Setting> technique_rows() {
  const std::pair<SettingGroup, std::vector<Setting>> parts[] = {
      {SettingGroup::shadows, shadow_rows()},         {SettingGroup::occlusion, occlusion_rows()},
      {SettingGroup::hybrid, voxel_rows()},           {SettingGroup::hybrid, antialias_rows()},
      {SettingGroup::reflections, reflection_rows()}, {SettingGroup::reflections, bounce_rows()},
      {SettingGroup::shading, shading_rows()},        {SettingGroup::transparency, transparency_rows()}};
  std::vector<Setting> rows;
  for (const auto& [group, part] : parts)
    for (Setting row : part) {
      row.group = group;
      row.advanced = true;
      row.supported_by = SupportedBy::listed_else_refused;
      row.offered = kByRender | kByView;
      rows.push_back(std::move(row));
    }
  return rows;
}

} // namespace wavepath
