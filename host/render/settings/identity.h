// Identity of a render: a text of everything that decides its bits. Renders of equal identity can be merged, and one
// can be resumed where the other stopped.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "host/render/settings/render_plan.h"
#include "host/scene/staging/view.h"

namespace wavepath {

// Returns the identity, as "version=0.1.0;scene=5f..;size=640x360;...;camera=...". It has the settings that decide the
// film, in the order of their table; values contain no ';'. The range of samples is left out, because the parts of one
// render differ in it.
std::string identity_of(std::uint64_t scene_hash, const View& view, const RenderPlan& settings);

// Describes the first key whose values differ, as "seed is 1, not 0"; empty if the identities are equal.
std::optional<std::string> first_difference(const std::string& identity, const std::string& expected);

} // namespace wavepath
