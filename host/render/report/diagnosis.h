// Diagnosis of a render: sentences about whether its own figures can be trusted.
#pragma once

#include <string>
#include <vector>

#include "host/render/render.h"
#include "host/render/report/true_error.h"

namespace wavepath {

// Reasons why the estimate cannot be trusted or the error has stopped falling, one sentence each; empty if all is well.
// `true_errors`: against --reference, one for each checkpoint; empty without a reference.
std::vector<std::string> diagnose(const RenderPlan& settings, const PackedScene& scene, const RenderResult& result,
                                  const std::vector<TrueError>& true_errors, const std::vector<std::string>& bias);

// Advice, as a clause: a way to sample by design the bright light that these settings find only by chance.
std::string firefly_remedy(const RenderPlan& settings, const PackedScene& scene);

// True if the estimated error can be trusted: there are enough samples, all are finite, and none outweighs the rest.
bool is_trusted(const RenderResult& result);

} // namespace wavepath
