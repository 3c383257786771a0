// --adaptive auto: whether a render is to look for noise. Whether it then shares samples out, its pilot decides
// (loop/adaptive.h).
#pragma once

#include "host/render/settings/settings.h"

namespace wavepath {

// The render has 32 times the paths of a pilot, which are 64 samples of its own in small pictures and 16 in large ones,
// and pixels enough that runs of them differ.
bool may_pay_adaptive(const RenderSettings& settings);

} // namespace wavepath
