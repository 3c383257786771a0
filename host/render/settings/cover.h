// Transparency, the shadow catcher, and the passes `shadow` and `environment`: what of them a render asks for.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "host/render/settings/render_plan.h"

namespace wavepath {

// Values of --aov that come from the sums of transparency and shadow (kernels/film/cover_types.h).
inline constexpr std::array<std::string_view, 2> kCoverAovs = {"shadow", "environment"};

bool is_cover(std::string_view aov);

// True if direct light is told as if nothing blocked it, and as it arrives: for the catcher, and for `shadow`.
bool compares_light(const RenderPlan& settings);

// kCover bits of gpu::Frame.
std::uint32_t cover_bits(const RenderPlan& settings);

// True if the film holds sums of transparency and shadow.
bool has_cover(const RenderPlan& settings);

// The settings of a picture that asks for none of this, for measurements that other integrators join in.
RenderPlan without_cover(RenderPlan settings);

} // namespace wavepath
