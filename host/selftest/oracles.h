// Closed forms and quadratures in double precision that renders are judged by. Nothing here shares code with the
// kernels.
#pragma once

#include "host/selftest/props.h"

namespace wavepath {

// Irradiance of the point at zero, facing +Y, from a convex body or sheet of radiance 1 all above the horizon: the sum
// of Lambert's polygon formula (1760) over the triangles that face it.
double irradiance(const Triangles& light);

// Fraction of unpolarized light that a smooth interface reflects; eta = transmitted / incident ior, 1 beyond the
// critical angle.
double fresnel(double cosine, double eta);

// Fraction of a sun at the zenith, of this half angle in radians, that a point of a floor sees past a half-plane which
// ends `edge_slope` times its own height beyond the point; negative: before it.
double sun_past_edge(double half_angle, double edge_slope);

} // namespace wavepath
