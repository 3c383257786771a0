// Ctrl-C, asked for politely: the first SIGINT or SIGTERM sets a flag, the second ends the process.
#pragma once

namespace wavepath {

// From here on signals are caught; to be called once.
void catch_interrupts();

bool interrupted();

} // namespace wavepath
