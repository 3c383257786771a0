// Command lines that can be typed again.
#pragma once

#include <string>

namespace wavepath {

// The word as a shell would take it again.
std::string shell_quoted(const std::string& word);

} // namespace wavepath
