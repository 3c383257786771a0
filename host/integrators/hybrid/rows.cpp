#include "host/integrators/hybrid/rows.h"

#include "host/integrators/hybrid/antialias/catalogue.h"
#include "host/integrators/hybrid/occlusion/catalogue.h"
#include "host/integrators/hybrid/shading/catalogue.h"
#include "host/integrators/hybrid/shadows/catalogue.h"
#include "host/integrators/hybrid/transparency/catalogue.h"

namespace wavepath {

std::vector<Setting> technique_rows() {
  std::vector<Setting> rows;
  for (std::vector<Setting> part :
       {shadow_rows(), occlusion_rows(), antialias_rows(), shading_rows(), transparency_rows()})
    for (Setting& row : part) {
      row.group = SettingGroup::special;
      row.takers = Takers::listed_else_refused;
      row.offered = kByRender | kByView;
      rows.push_back(std::move(row));
    }
  return rows;
}

} // namespace wavepath
