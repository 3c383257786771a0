// The film, for kernels that define BIND_FILM before the include.
#ifndef WAVEPATH_FILM_BINDINGS_GLSL
#define WAVEPATH_FILM_BINDINGS_GLSL

#include "kernels/base/bindings.glsl"
#include "kernels/film/film_types.h"

#ifdef BIND_FILM
layout(set = 0, binding = kBindFilm, std430) writeonly buffer FilmBlock { uvec4 film_words[]; };
layout(set = 0, binding = kBindFilmTexels) uniform usamplerBuffer film_texels;
layout(set = 0, binding = kBindFilmAovs, std430) buffer FilmAovBlock { FilmAovs film_aovs[]; };
layout(set = 0, binding = kBindFilmGroups, std430) buffer FilmGroupBlock { FilmPixel film_groups[]; };
#endif

#endif
