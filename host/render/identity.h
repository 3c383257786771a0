// What decides the bits of a render, in words: two that agree in all of it can be joined, or one go on where the other
// stopped.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "host/render/render.h"
#include "host/scene/view.h"

namespace wavepath {

// "scene=5f..;camera=a3..;size=640x360;seed=0;...": keys in a fixed order, values without ';'. The range of samples is
// not in it.
std::string identity_of(std::uint64_t scene_hash, const View& view, const RenderSettings& settings);

// The first key in which they differ, with both values, as "seed is 1, not 0"; nothing if they are equal.
std::optional<std::string> first_difference(const std::string& identity, const std::string& expected);

} // namespace wavepath
