// Converts scenes of pbrt-v4 and Mitsuba 3 to glTF.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/base/warnings.h"

namespace wavepath::convert {

struct Converted {
  std::string format;             // of the source
  std::vector<std::string> files; // that were written, the scene first
  std::string command;            // that renders the scene as its file says
  Warnings losses;                // what glTF cannot say, each with its count
  std::uint64_t shapes = 0, instances = 0, triangles = 0, materials = 0, images = 0, lights = 0;
};

// The files that an output consists of: a .gltf has a .bin, and an environment map and voxels are files beside it.
std::vector<std::string> files_of(const std::string& output);

// Writes all files or none. Throws Error; UsageError for extensions that it does not know.
Converted convert_scene(const std::string& input, const std::string& output);

} // namespace wavepath::convert
