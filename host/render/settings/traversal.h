// By what rays are traced.
#pragma once

#include "host/gpu/device_info.h"
#include "host/render/settings/render_plan.h"

namespace wavepath {

// --traversal as kernels are asked for it: one of kTraversal...; ray queries know no surfaces that move.
std::uint32_t traversal_of(const RenderPlan& settings);

// Whether that means the device's ray queries in place of traversal in compute kernels: where it has hardware for them,
// or where settings insist. Throws Error if they insist on what the device lacks.
bool traces_by_query(std::uint32_t traversal, const DeviceInfo& device);

} // namespace wavepath
