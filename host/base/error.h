// The one exception type. Thrown where a problem is found, caught once in main, printed as
// "wavepath: error: FILE: PROBLEM; REMEDY".
#pragma once

#include <stdexcept>
#include <string>

namespace wavepath {

struct Error : std::runtime_error {
  // `where`: the file, flag or device it is about. `problem`: what is wrong with it. `remedy`: what the user can do.
  Error(const std::string& where, const std::string& problem, const std::string& remedy)
      : std::runtime_error(where + ": " + problem + "; " + remedy) {}
};

// The device is gone: reset by its driver, unplugged, or silent. Nothing that needs it will work any more.
struct DeviceLost : Error {
  using Error::Error;
};

// A mistake on the command line: exit code 2 instead of 1.
struct UsageError : Error {
  using Error::Error;
};

} // namespace wavepath
