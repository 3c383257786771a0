// Path tracing as an integrator.
#pragma once

#include "host/render/settings/integrator_kind.h"

namespace wavepath {

extern const IntegratorKind kPath;

} // namespace wavepath
