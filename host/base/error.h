// The one exception type. Thrown where a problem is found, caught once in main, printed as
// "wavepath: error: FILE: PROBLEM; REMEDY".
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace wavepath {

struct Error : std::runtime_error {
  Error(std::string about, std::string wrong, std::string advice)
      : std::runtime_error(about + ": " + wrong + "; " + advice),
        where(std::move(about)),
        problem(std::move(wrong)),
        remedy(std::move(advice)) {}

  std::string where;   // the file, flag or device it is about
  std::string problem; // what is wrong with it
  std::string remedy;  // what the user can do
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
