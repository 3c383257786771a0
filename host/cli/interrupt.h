// Signals: the first Ctrl-C requests an orderly end; writes that cannot go on are errors of the write.
#pragma once

namespace wavepath {

// From here on the first SIGINT or SIGTERM makes interrupted() true, and the second ends the process. SIGHUP, which a
// terminal that closes sends several times, makes interrupted() true and never ends the process. To be called once.
void catch_interrupts();
bool interrupted();

// Makes writing beyond the file size limit, and to a pipe that nobody reads, fail like writing to a full disk, instead
// of killing the process.
void ignore_write_signals();

} // namespace wavepath
