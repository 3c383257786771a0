// Path tracing as an integrator.
#pragma once

#include "host/render/integrator.h"

namespace wavepath {

extern const IntegratorKind kPath;

} // namespace wavepath
