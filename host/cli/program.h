// The whole program: streams, signals, a command; every failure is one line and an exit code.
#pragma once

#include "host/cli/commands.h"

namespace wavepath {

// What main() does. `view`: as run() takes it.
int run_program(int argument_count, const char* const* arguments, AddCommand view);

} // namespace wavepath
