// Decides how rays are traced: by compute kernels or by the device's ray queries.
#pragma once

#include "host/gpu/device_info.h"
#include "host/render/settings/render_plan.h"

namespace wavepath {

// Value for kernels: a kTraversal constant. Scenes with motion are traced by compute kernels. Throws Error for
// --traversal hardware with motion.
std::uint32_t traversal_of(const RenderPlan& settings);

// True if the device's ray queries trace rays: `traversal` is hardware, or it is auto and the device is a GPU that has
// them. Throws Error if `traversal` is hardware and the device lacks them.
bool traces_by_query(std::uint32_t traversal, const DeviceInfo& device);

} // namespace wavepath
