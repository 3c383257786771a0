// The whole program: streams, signals, a command; every failure is one line and an exit code.
#pragma once

#include <span>

#include "host/cli/commands.h"

namespace wavepath {

// What main() does. `own`: as run() takes it.
int run_program(int argument_count, const char* const* arguments, std::span<const OwnCommand> own = {});

} // namespace wavepath
