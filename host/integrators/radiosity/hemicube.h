// The hemicube: how much of the light that a patch sends goes through each pixel (Cohen and Greenberg, "The Hemi-Cube:
// A Radiosity Solution for Complex Environments", SIGGRAPH 1985).
#pragma once

#include <cstdint>
#include <vector>

namespace wavepath {

// Even number of pixels along a side of the top face, with which a hemicube has about so many pixels in all.
std::uint32_t hemicube_side(std::uint64_t pixels);

// Delta form factors of all 3 side^2 pixels, in the order of kernels/radiosity/radiosity_shoot.comp: first the top
// face. Their sum is 1.
std::vector<double> delta_form_factors(std::uint32_t side);

} // namespace wavepath
