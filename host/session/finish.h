// What is made of a picture after its last sample: channels by rays of their own, the filtered picture, measurements of
// missing light.
#pragma once

#include <functional>

#include "host/session/judge.h"
#include "host/session/run.h"

namespace wavepath {

// Appends the passes that the settings ask for, which need no sample. `goes_on`: false ends them with a warning. A
// failure becomes a warning too.
void add_passes_if_asked(Prepared& prepared, RenderResult& result, const MultiDeviceResult* shared,
                         const std::function<bool()>& goes_on);

// Measures what light is missing, unless the render ended early. `goes_on`: false ends the measurement.
MissingLight measure_missing_light(Prepared& prepared, const RenderResult& result, const MultiDeviceResult* shared,
                                   const std::function<bool()>& goes_on);

} // namespace wavepath
