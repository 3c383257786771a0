// Quotes words for a POSIX shell.
#pragma once

#include <string>

namespace wavepath {

// The word, quoted if a shell would not read it back as it is.
std::string shell_quoted(const std::string& word);

} // namespace wavepath
