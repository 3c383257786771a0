// Films to and from the device.
#pragma once

#include "host/integrators/path/film_transfer.h"
#include "host/film/film.h"
#include "host/integrators/path/path_tracer.h"

namespace wavepath {

Film download_film(const PathTracer& tracer, std::uint32_t width, std::uint32_t height);
void upload_film(PathTracer& tracer, const Film& film);

} // namespace wavepath
