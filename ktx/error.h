// A KTX2 file that cannot be read. what() continues a sentence about it: "is damaged or cut short (level 0 is
// missing)".
#pragma once

#include <stdexcept>
#include <string>

namespace wavepath::ktx {

struct FileError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The file contradicts itself or the specification.
[[noreturn]] inline void fail_damaged(const std::string& detail) {
  throw FileError("is damaged or cut short (" + detail + ")");
}

} // namespace wavepath::ktx
