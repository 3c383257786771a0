// The commands of wavepath. Each adds itself to the parser and returns what runs it.
#pragma once

#include <functional>
#include <span>
#include <string>

#include "host/base/warnings.h"

namespace CLI {
class App;
}

namespace wavepath {

// Runs a parsed command and returns its exit code; throws Error.
using Command = std::function<int()>;

// The exit codes, which scripts rely on.
inline constexpr int kExitDone = 0, kExitFailed = 1, kExitUsage = 2, kExitTargetMissed = 3, kExitInterrupted = 130;
// Whoever read stdout is gone: as shells tell it of programs that a broken pipe ends.
inline constexpr int kExitReaderGone = 141;

// `command_line`: as the user typed it, for the record.
Command add_render(CLI::App& app, const std::string& command_line);
Command add_view(CLI::App& app, const std::string& command_line);
Command add_serve(CLI::App& app, const std::string& command_line);
Command add_info(CLI::App& app);
Command add_compare(CLI::App& app);
Command add_bench(CLI::App& app);
Command add_merge(CLI::App& app);
Command add_relight(CLI::App& app);
Command add_parts(CLI::App& app);
Command add_convert(CLI::App& app);
Command add_selftest(CLI::App& app);
Command add_study(CLI::App& app, const std::string& command_line);

// Adds a command; `command_line`: as the user typed it.
using AddCommand = Command (*)(CLI::App& app, const std::string& command_line);

// A command of the program alone, which the library does not have.
struct OwnCommand {
  const char* name;
  AddCommand add;
};

// Parses, runs and returns the exit code. Throws Error, and UsageError for a command line that makes no sense.
int run(int argument_count, const char* const* arguments, std::span<const OwnCommand> own = {});

// Prints one line for each kind of warning on stderr.
void print_warnings(const Warnings& warnings);

} // namespace wavepath
