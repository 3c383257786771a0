// The report of a finished render: stats document, warnings, summary.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/base/failure.h"
#include "host/base/warnings.h"
#include "host/cli/render_flags.h"
#include "host/render/depth_cut.h"
#include "host/render/lost_light.h"
#include "host/render/report/stats.h"

namespace wavepath {

// Measurements of missing light, if they were asked for, or the reasons why they failed.
struct MissingLight {
  std::optional<DepthCut> cut;   // light beyond --max-depth
  std::optional<LostLight> lost; // light that paths from the camera cannot find
  std::string no_cut, no_lost;   // why they were not measured; empty = they were, or nobody asked
};

// Every reason why the expected picture is not the full light transport of the scene, a sentence each.
std::vector<std::string> list_bias(const RenderPlan& settings, const PackedScene& scene, const RenderResult& result,
                                   const MissingLight& missing = {});

// `bias`, joined by "; ", with the share of the light that --clamp took from the samples of this film.
std::string with_clamp_share(const std::string& bias, const Film& film);

// The first sample that was not finite and how to replay it. There must be one.
std::string describe_first(const Nonfinite& nonfinite, const RenderPlan& settings);

TrueError measure_true_error(const Picture& picture, const Picture& reference);

// Tries every picture of `output`, even if one fails, because rendering was the expensive part. Leaves those in it that
// were written.
void write_pictures(OutputRequest& output, const PictureInfo& info, const Picture& picture, Warnings& warnings,
                    Attempts& attempts);

// The pictures written, separated by commas, those that are tonemapped with their exposure.
std::string written_text(const OutputRequest& output, const Picture& picture);

// Writes `document`, the text of the stats, to stdout as asked for, and warnings and a summary to stderr, each whatever
// becomes of the others. Reads the scene of `run` only for --verbose.
void report(const Run& run, const OutputRequest& output, Warnings warnings, const std::string& document,
            Attempts& attempts);

} // namespace wavepath
