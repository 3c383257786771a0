// WAVEPATH_EMULATE for a scope.
#pragma once

#include <cstdlib>
#include <optional>
#include <string>

namespace wavepath::test {

class Emulate {
public:
  // None if `value` is null.
  explicit Emulate(const char* value) {
    if (const char* before = std::getenv("WAVEPATH_EMULATE")) before_ = before;
    value ? setenv("WAVEPATH_EMULATE", value, 1) : unsetenv("WAVEPATH_EMULATE");
  }
  ~Emulate() { before_ ? setenv("WAVEPATH_EMULATE", before_->c_str(), 1) : unsetenv("WAVEPATH_EMULATE"); }
  Emulate(const Emulate&) = delete;

private:
  std::optional<std::string> before_;
};

} // namespace wavepath::test
