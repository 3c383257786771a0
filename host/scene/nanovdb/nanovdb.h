// Reads the density and the temperature of a NanoVDB file (.nvdb). Nothing in the file is trusted.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "host/base/warnings.h"
#include "host/scene/volume.h"

namespace wavepath {

// The grids named "density" and "temperature" in any case; a file with one grid of scalars has its density in that,
// whatever its name. Values are those of NanoVDB's own accessor, but that densities below 0 and values that are not
// finite are 0, which warnings count. Throws Error: of what else is in the file, and if no density is above 0.
VolumeGrids read_nanovdb(const std::filesystem::path& path, Warnings& warnings);

// The same of a file's contents; `file` names it in messages.
VolumeGrids read_nanovdb(const std::string& file, std::span<const std::uint8_t> bytes, Warnings& warnings);

} // namespace wavepath
