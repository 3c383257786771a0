// Signals: the first Ctrl-C requests an orderly end; exceeding the file size limit is an error of the write.
#pragma once

namespace wavepath {

// From here on the first SIGINT or SIGTERM makes interrupted() true, and the second ends the process. To be called
// once.
void catch_interrupts();
bool interrupted();

// Makes writing beyond the file size limit fail like writing to a full disk, instead of killing the process.
void ignore_file_size_signal();

} // namespace wavepath
