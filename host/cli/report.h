// The report of a finished render: stats document, warnings, summary.
#pragma once

#include <string>
#include <vector>

#include "host/base/failure.h"
#include "host/base/warnings.h"
#include "host/cli/render_flags.h"
#include "host/render/report/stats.h"

namespace wavepath {

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
