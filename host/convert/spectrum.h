// Spectra of scene files as colours: tables of wavelengths, names of illuminants, metals and glasses.
#pragma once

#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <glm/glm.hpp>

#include "host/scene/spectrum.h"

namespace wavepath::convert {

// Wavelengths in nanometres, ascending, and values; linear in between, 0 outside.
using SpectrumTable = std::vector<std::pair<double, double>>;
Spectrum resample(const SpectrumTable& table);

// The colour of a reflectance under daylight (D65), so that 1 everywhere is white.
glm::dvec3 reflected_color(const Spectrum& reflectance);
// A colour, scaled to a luminance of 1. Black stays black.
glm::dvec3 unit_luminance(const glm::dvec3& color);
double luminance(const glm::dvec3& color);

// "stdillum-D65", "stdillum-A" and their like, with a luminance of 1.
std::optional<glm::dvec3> named_illuminant(std::string_view name);

// Reflectance at normal incidence of a metal by its symbol: "Au", "Cu_palik".
std::optional<glm::dvec3> named_metal(std::string_view name);
// The reflectance of an index of refraction eta + ik against vacuum, at normal incidence.
double conductor_reflectance(double eta, double k);
// Index of refraction by names of both formats: "glass-BK7", "water", "diamond".
std::optional<double> named_ior(std::string_view name);

// Fraction of diffuse light inside a smooth dielectric that its surface reflects back (above 1 as eta is).
double internal_diffuse_reflectance(double eta);

} // namespace wavepath::convert
