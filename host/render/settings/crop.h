// Which part of a picture a render makes: the film that kernels fill, and the picture that is developed from it.
#pragma once

#include "host/film/film.h"
#include "host/render/settings/render_plan.h"

namespace wavepath {

// True if the film holds a part of the picture only. Light paths of `bidirectional` reach any pixel, and techniques of
// frames look at neighbours: such renders fill the whole film, from which the part is cut.
bool renders_part(const RenderPlan& settings);

// The film that kernels fill; and that of the picture, the same unless --crop asks for a part.
FilmShape film_shape(const RenderPlan& settings);
FilmShape picture_shape(const RenderPlan& settings);

} // namespace wavepath
