// What a render's own figures say about whether it can be trusted, in words.
#pragma once

#include <string>
#include <vector>

#include "host/render/render.h"
#include "host/render/report/true_error.h"

namespace wavepath {

// Why the estimate cannot be trusted, or why the error stops falling: one sentence each; empty if all is well.
// `true_errors`: against --reference, one a checkpoint, or none.
std::vector<std::string> diagnose(const RenderPlan& settings, const PackedScene& scene, const RenderResult& result,
                                  const std::vector<TrueError>& true_errors, const std::vector<std::string>& bias);

// What may find by design the bright samples that a render with these settings finds by chance: a clause.
std::string firefly_remedy(const RenderPlan& settings, const PackedScene& scene);

// Whether the estimated error says how wrong the picture is: enough samples, all finite, none that outweighs the rest.
bool is_trusted(const RenderResult& result);

} // namespace wavepath
