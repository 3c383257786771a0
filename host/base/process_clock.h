// Seconds since the process was started, dynamic loading of libraries included.
#pragma once

namespace wavepath {

double seconds_since_process_start();

} // namespace wavepath
