#include "host/render/settings/light_groups.h"

#include "host/render/settings/integrator_kind.h"

namespace wavepath {

bool records_groups(const RenderPlan& settings) {
  return !settings.light_groups.empty() && supports(*settings.integrator, "light-groups");
}

std::uint64_t group_bytes_per_slot(const RenderPlan& settings) {
  return records_groups(settings) ? sizeof(float) * (3 * settings.group_names.size() + 1) : 0;
}

} // namespace wavepath
