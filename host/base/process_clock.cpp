#include "host/base/process_clock.h"

#include <fstream>
#include <limits>
#include <string>

#include <time.h>
#include <unistd.h>

#include "host/base/clock.h"

namespace wavepath {
namespace {

double boot_clock() {
  timespec now{};
  clock_gettime(CLOCK_BOOTTIME, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Age of the process in steps of the kernel's tick, 10 ms; 0 where /proc does not tell.
double age_now() {
  std::ifstream file("/proc/self/stat");
  file.ignore(std::numeric_limits<std::streamsize>::max(), ')'); // the program's name may hold anything else
  std::string word;
  for (int field = 3; field < 22; ++field) file >> word; // proc(5): starttime is field 22
  double ticks = 0.0;
  if (!(file >> ticks)) return 0.0;
  const double age = boot_clock() - ticks / static_cast<double>(sysconf(_SC_CLK_TCK));
  return age > 0.0 ? age : 0.0;
}

} // namespace

double seconds_since_process_start() {
  static const double age = age_now();
  static const Clock::time_point asked_first = Clock::now();
  return age + seconds_since(asked_first);
}

} // namespace wavepath
