// --denoise of a finished picture: adds the filtered radiance as channels beside the rendered ones.
#pragma once

#include "host/film/film.h"
#include "host/picture/picture.h"
#include "host/render/loop/render_result.h"
#include "host/render/settings/render_plan.h"

namespace wavepath {

// Adds the channels of kShownPrefix (picture_io.h) to a picture that was developed from `film`. `how`: kDenoiseOn or
// kDenoiseOidn. Throws Error if the filter cannot run.
DenoiseReport add_denoised(Picture& picture, const Film& film, std::uint32_t how);

// Filters the picture of a result, if the settings ask for it. Throws Error as above.
void denoise_if_asked(RenderResult& result, const RenderPlan& settings);

} // namespace wavepath
