// --integrator auto: stands for path tracing, guided or not, and bidirectional path tracing.
#pragma once

#include "host/render/settings/integrator_kind.h"

namespace wavepath {

// Path tracing under another name, with candidates: where nothing chooses, as in a window, it is path tracing.
const IntegratorKind& automatic_integrator();

} // namespace wavepath
