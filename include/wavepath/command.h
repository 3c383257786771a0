// The command line in a function.
#pragma once

#include <string>
#include <vector>

#include <wavepath/export.h>

namespace wavepath_v0 {

// What a command printed.
struct Printed {
  std::string out; // on stdout; one JSON document with --json
  std::string err; // on stderr: warnings and summary
  int exit_code = 0;
};

// Runs `info`, `compare` or `merge`, such as {"compare", "a.exr", "b.exr", "--json"}, and keeps what it prints. Throws
// Error where the command would print one.
WAVEPATH_API Printed command(const std::vector<std::string>& words);

// The program `wavepath` without its window: prints, handles signals, and returns the exit code. For main() alone.
WAVEPATH_API int command_line(int argument_count, const char* const* arguments);

} // namespace wavepath_v0
