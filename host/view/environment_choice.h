// The environment that the panel offers and the command line names.
#pragma once

#include <string>

namespace wavepath {

// The environment, as --env, --env-intensity and --env-rotation give it.
struct EnvironmentChoice {
  std::string source; // file, R,G,B, or empty for the default
  double intensity = 1.0;
  double rotation_degrees = 0.0;
  bool operator==(const EnvironmentChoice&) const = default;
};

} // namespace wavepath
