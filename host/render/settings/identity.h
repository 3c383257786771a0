// Text that holds everything that decides the bits of a render. Renders with the same text can be merged, and one can
// be resumed where the other stopped.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "host/render/settings/render_plan.h"
#include "host/scene/staging/view.h"

namespace wavepath {

// "version=0.1.0;scene=5f..;size=640x360;...;camera=...": the settings that decide the film, in the order of their
// table. Values are without ';'. The range of samples is not among them, because parts of one render differ in it.
std::string identity_of(std::uint64_t scene_hash, const View& view, const RenderPlan& settings);

// The first key in which they differ, with both values, as "seed is 1, not 0"; nothing if they are equal.
std::optional<std::string> first_difference(const std::string& identity, const std::string& expected);

} // namespace wavepath
