// Volumes that the user adds to a scene.
#pragma once

#include <optional>
#include <string>

#include <glm/glm.hpp>

#include "host/base/warnings.h"
#include "host/scene/volume.h"

namespace wavepath {

struct VolumeRequest {
  std::string file;             // .nvdb; empty = none
  std::optional<glm::dvec3> at; // where the middle of the density's box is put, in metres; empty = in its own space
  double size = 0.0;            // metres of the longest side of this box; 0 = its own
  double density = 1.0;         // extinction where the grid's density is 1, in 1/m
  glm::dvec3 albedo{1.0};       // scattering / extinction
  double anisotropy = 0.0;      // as Volume has it, and what follows
  double emission = 1.0, temperature_scale = 1.0, temperature_offset = 0.0;

  bool operator==(const VolumeRequest&) const = default;
};

// Largest coefficient in 1/m, factor of emission, and number of a temperature; |anisotropy| is at most kMostAnisotropy.
inline constexpr double kMostCoefficient = 1e9, kMostEmission = 1e15, kMostTemperature = 1e9, kMostAnisotropy = 0.99;

// Reads and places it. Throws Error.
Volume load_volume(const VolumeRequest& request, Warnings& warnings);

// The flags that give this request, each preceded by a blank.
std::string flags_of(const VolumeRequest& request);

} // namespace wavepath
