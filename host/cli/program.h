// The whole program: streams, signals, a command; every failure is one line and an exit code.
#pragma once

#include <span>

#include "host/cli/commands.h"

namespace wavepath {

// The body of main(). `own`: commands of the program alone, as run() takes them.
int run_program(int argument_count, const char* const* arguments, std::span<const OwnCommand> own = {});

} // namespace wavepath
