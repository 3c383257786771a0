// Form factor from a point to a triangle, in closed form.
#pragma once

#include <array>

#include <glm/glm.hpp>

namespace wavepath {

// Share of the light of a diffuse point at `x`, with unit normal `n`, that goes to the triangle if nothing stands
// between (Lambert, "Photometria", 1760; Baum, Rushmeier and Winget, "Improving Radiosity Solutions Through the Use of
// Analytically Determined Form-Factors", SIGGRAPH 1989, equation 8). What lies below the horizon of x counts nothing.
// From 0 to 1. Whether the triangle turns its front to x does not matter.
double point_form_factor(const glm::dvec3& x, const glm::dvec3& n, const std::array<glm::dvec3, 3>& triangle);

} // namespace wavepath
