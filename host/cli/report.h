// The report of a finished render: stats document, warnings, summary.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/base/warnings.h"
#include "host/cli/render_flags.h"
#include "host/render/depth_cut.h"
#include "host/render/lost_light.h"
#include "host/render/report/stats.h"

namespace wavepath {

// Every reason why the expected picture is not the full light transport of the scene, a sentence each.
// `cut`: what the depth costs, `lost`: what paths from the camera cannot find, if those were measured.
std::vector<std::string> list_bias(const RenderSettings& settings, const PackedScene& scene, const RenderResult& result,
                                   const std::optional<DepthCut>& cut, const std::optional<LostLight>& lost);

// The first sample that was not finite and how to replay it. There must be one.
std::string describe_first(const Nonfinite& nonfinite, const RenderSettings& settings);

TrueError measure_true_error(const Picture& picture, const Picture& reference);

// The pictures written, separated by commas, those that are tonemapped with their exposure.
std::string written_text(const OutputRequest& output, const Picture& picture);

// Writes the stats file and, as asked for, the document to stdout, and warnings and a summary to stderr.
void report(const Run& run, const OutputRequest& output, Warnings warnings);

} // namespace wavepath
