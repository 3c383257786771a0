// How long this process has run, as a user with a stopwatch would have it: loading of libraries counts.
#pragma once

namespace wavepath {

double seconds_since_process_start();

} // namespace wavepath
