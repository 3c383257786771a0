// Mixes the groups of lights of a picture anew.
#pragma once

#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "host/picture/picture.h"

namespace wavepath {

// Header attribute with the gains of a mix.
inline constexpr const char* kGainsText = "wavepath.gains";

struct GroupGain {
  std::string group;
  glm::dvec3 factor{1.0};
};

// Scales the layers of the groups and makes R, G, B their sum. `groups`: names of the picture's groups, of which each
// may have one gain; those without keep their light. Layers that hold light of all groups together are removed; returns
// their names. `file`: for messages. Throws Error if the picture has no groups, and UsageError for a gain of no group.
std::vector<std::string> relight(const std::string& file, const std::vector<std::string>& groups,
                                 const std::vector<GroupGain>& gains, Picture& picture);

} // namespace wavepath
