// report.html of a study, made by benchmarks/study_report.py, which is built into the program.
#pragma once

#include <string>

namespace wavepath {

// Runs the script with Python on a folder that write_study() filled. Throws Error, with the remedy, where Python or
// matplotlib is missing or the script fails.
void write_page(const std::string& folder);

// The text of the script; the build fills it in.
extern const char* const kStudyReportScript;

} // namespace wavepath
