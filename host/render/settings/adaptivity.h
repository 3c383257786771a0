// Whether a render gives pixels with more noise more samples.
#pragma once

#include "host/render/settings/settings.h"

namespace wavepath {

// Whether a pilot looks for noise: it was asked for, or the program tries on its own whether it pays.
bool is_adaptive(const RenderSettings& settings);

// Whether to try (RenderSettings::tries_adaptive): the render has 32 times the paths of a pilot, which are 64 samples
// of its own in small pictures and 16 in large ones, and pixels enough that runs of them differ.
bool may_pay_adaptive(const RenderSettings& settings);

} // namespace wavepath
