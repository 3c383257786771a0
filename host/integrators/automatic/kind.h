// --integrator auto: stands for path tracing, guided path tracing and bidirectional path tracing.
#pragma once

#include "host/render/settings/integrator_kind.h"

namespace wavepath {

// Path tracing under another name, with a list of candidates. Where nothing chooses among them, as in a window, it is
// path tracing.
const IntegratorKind& automatic_integrator();

} // namespace wavepath
