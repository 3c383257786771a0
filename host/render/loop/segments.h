// Cuts the film into segments, whose pixels get the same number of samples in a pass.
#pragma once

#include <cstdint>
#include <vector>

#include "host/render/loop/integrator.h"
#include "host/render/workspace/film_target.h"

namespace wavepath {

// One segment for each band: all pixels, without error probes.
std::vector<Segment> even_segments(const std::vector<FilmBand>& bands);

// Segments of all pixels and error probes of the film.
std::vector<Segment> all_segments(const FilmTarget& film);

// Segments of an adaptive render: sorts the entries of each band by the level of their pixel's run. `entries`: becomes
// the list that the segments index.
std::vector<Segment> level_segments(const FilmTarget& film, const std::vector<std::int8_t>& levels,
                                    std::vector<std::uint32_t>& entries);

} // namespace wavepath
