// WAVEPATH_POSE for a scope.
#pragma once

#include <cstdlib>
#include <optional>
#include <string>

namespace wavepath::test {

class Pose {
public:
  // None if `value` is null.
  explicit Pose(const char* value) {
    if (const char* before = std::getenv("WAVEPATH_POSE")) before_ = before;
    value ? setenv("WAVEPATH_POSE", value, 1) : unsetenv("WAVEPATH_POSE");
  }
  ~Pose() { before_ ? setenv("WAVEPATH_POSE", before_->c_str(), 1) : unsetenv("WAVEPATH_POSE"); }
  Pose(const Pose&) = delete;

private:
  std::optional<std::string> before_;
};

} // namespace wavepath::test
