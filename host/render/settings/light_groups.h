// Decides whether a render adds light up by groups of lights (--light-groups).
#pragma once

#include "host/render/settings/render_plan.h"

namespace wavepath {

// True if the film of this render has groups: they were asked for, and its integrator knows whose light it finds.
bool records_groups(const RenderPlan& settings);

// Bytes of a path in flight.
std::uint64_t group_bytes_per_slot(const RenderPlan& settings);

} // namespace wavepath
