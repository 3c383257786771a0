// The work of pilots: short renders of candidates, whose counted work is weighed against their estimated error.
#pragma once

#include "host/render/render.h"

namespace wavepath {

// Of the whole render: pixels times samples, also of one that renders a part of the samples and tells their total.
double paths_of(const RenderPlan& settings);

// The same of a render that may be bounded by time; then from the type of the device alone, so that what is decided by
// it depends on no clock.
double expected_paths(const RenderPlan& settings, bool cpu);

// Whether the render may make pilots: one that is foreseen to take less than a second makes none.
bool may_make_pilots(const RenderPlan& settings, bool cpu);

// Work of the samples of a pilot in camera rays (IntegratorKind::work), without the training before the first of them:
// twice the work of its last half.
double steady_work(const RenderPlan& settings, const RenderResult& result, bool cpu);

} // namespace wavepath
