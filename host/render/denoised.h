// --denoise of a finished picture: the filtered radiance as channels beside those that were rendered.
#pragma once

#include "host/film/film.h"
#include "host/picture/picture.h"
#include "host/render/loop/render_result.h"
#include "host/render/settings/render_plan.h"

namespace wavepath {

// Adds the channels of kShownPrefix (picture_io.h) to a picture that was developed from `film`. `how`: kDenoiseOn or
// kDenoiseOidn. Throws Error where the filter cannot run.
DenoiseReport add_denoised(Picture& picture, const Film& film, std::uint32_t how);

// The same for the result of a render, if its settings ask for it.
void denoise_if_asked(RenderResult& result, const RenderPlan& settings);

} // namespace wavepath
