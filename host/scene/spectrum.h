// Spectra as linear Rec. 709 colours; black bodies.
#pragma once

#include <array>
#include <cstddef>

#include <glm/glm.hpp>

namespace wavepath {

// Values at 380, 390, ..., 780 nm.
inline constexpr std::size_t kWavelengths = 41;
using Spectrum = std::array<double, kWavelengths>;
constexpr double nanometres(std::size_t i) { return 380.0 + 10.0 * static_cast<double>(i); }

// Sums of the products with the colour matching functions of CIE 1931, 2 degrees.
glm::dvec3 xyz_of(const Spectrum& spectrum);
glm::dvec3 rgb_from_xyz(const glm::dvec3& xyz);

// The colour of light, with the scale at which a spectrum of 1 everywhere has a luminance of 1.
glm::dvec3 light_color(const Spectrum& light);

// Planck's law at a wavelength in nanometres, W / (m^2 sr nm); 0 at 0 K and below.
double planck(double wavelength, double kelvin);
Spectrum black_body(double kelvin);

} // namespace wavepath
