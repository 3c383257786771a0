// Buffers of groups of lights, which are bound only where a render has groups (kFeatureLightGroups).
#pragma once

#include <vector>

#include "host/gpu/kernel.h"

namespace wavepath {

struct GroupBuffers {
  Buffer table; // PackedScene::light_groups
  Buffer paths; // light of each group of the paths in flight
};

// Bindings of kernels with kFeatureLightGroups, besides all others. `film`: sums of a band of the film.
std::vector<Binding> group_bindings(const GroupBuffers& groups, const Buffer& film);
// The same without buffers.
std::vector<Binding> group_layout();

} // namespace wavepath
