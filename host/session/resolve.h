// From the flags of a render to a request that is complete and makes sense.
#pragma once

#include "host/session/requests.h"

namespace wavepath {

// Does all that is declared below, in that order. Also resolves --devices, and predicts which pilots may be made, so
// that kernels can be compiled for them (foresee() in host/plan/plan.h). Throws UsageError; throws Error where a named
// device does not exist.
void resolve_settings(const SceneRequest& scene, RenderRequest& request);

// The parts of resolve_settings(), for commands that need only some of them.
//
// The sample range. Throws UsageError where --spp and --samples disagree.
void resolve_samples(RenderRequest& request);
// Chooses the integrator where --integrator is absent: `auto`, except in two cases that take `path`. First, a flag asks
// for something that `auto` does not support. Second, the render is a part (--samples) without the --spp of the whole:
// each part might choose another integrator. The sample range must have been resolved before.
void resolve_integrator(RenderRequest& request);
// Throws UsageError for settings and flags that the chosen integrator does not support.
void check_integrator(const RenderRequest& request);

// True if the render is neither a part of another one (--samples, --mergeable) nor shared by several devices.
bool stands_alone(const RenderRequest& request);

} // namespace wavepath
