// From the flags of a render to a request that is complete and makes sense.
#pragma once

#include "host/cli/render_flags.h"
#include "host/cli/scene_flags.h"

namespace wavepath {

// Everything below, in its order, with what kernels must bear for pilots, and --devices. Throws UsageError, and Error
// where a device is named that is not there.
void resolve_settings(const SceneRequest& scene, RenderRequest& request);

// Its parts, for commands that render otherwise.
// The sample range. Throws UsageError where --spp and --samples disagree.
void resolve_samples(RenderRequest& request);
// Without --integrator: `auto`. But `path` where a flag asks for what `auto` leaves out, and where a part of a render
// does not know the whole's --spp, because parts might choose each its own. The sample range must be resolved.
void resolve_integrator(RenderRequest& request);
// Throws UsageError for settings and flags that the chosen integrator does not take.
void check_integrator(const RenderRequest& request);

// Whether a render is neither a part of another one nor shared by several devices.
bool stands_alone(const RenderRequest& request);

} // namespace wavepath
