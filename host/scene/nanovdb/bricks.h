// Leaves and tiles of a tree as the bricks of a VoxelGrid.
#pragma once

#include <string>

#include "host/base/warnings.h"
#include "host/scene/nanovdb/tree.h"
#include "host/scene/volume.h"

namespace wavepath::nvdb {

// `what` names the grid in messages. `clamps`: values below 0 become 0. Values that are not finite become 0 anyway.
// Warnings count both. Bricks of 0 at the sides of the box are left out, all of them if no value is other than 0. Where
// the tree has nothing, the grid has the tree's background within its box. Throws Error if it is too large.
VoxelGrid make_grid(const std::string& file, const std::string& what, const Tree& tree, bool clamps,
                    Warnings& warnings);

} // namespace wavepath::nvdb
