// Lengths of renders in paths, and the counted work of pilots, by which decisions weigh errors.
#pragma once

#include "host/gpu/device_class.h"
#include "host/render/render.h"

namespace wavepath {

// Paths of the whole render: pixels times samples. For a part of a render, those of the whole if its total is known.
double paths_of(const RenderPlan& settings);

// The same for a render that may be limited by time. The number then depends on the type of the device alone, so that
// decisions depend on no clock. `device`: class of the device that renders.
double expected_paths(const RenderPlan& settings, DeviceClass device);

// True if the render may make pilots: it must be predicted to take at least a second.
bool may_make_pilots(const RenderPlan& settings, DeviceClass device);

// Work of the samples of a pilot, in camera rays of `path` (IntegratorKind::work). Training before the first sample
// does not count: the result is twice the work of the last half.
double steady_work(const RenderPlan& settings, const RenderResult& result, DeviceClass device);

} // namespace wavepath
