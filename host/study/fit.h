// Power laws through measured points: slope with its interval, values between points, times to an error.
#pragma once

#include <optional>
#include <vector>

namespace wavepath {

// A measured pair, both positive: seconds or samples, and an error.
struct Measured {
  double x = 0.0, y = 0.0;
};

// y = e^intercept x^slope, by least squares of logarithms over the last four octaves (five points at powers of two).
struct PowerFit {
  double slope = 0.0, intercept = 0.0;
  double ci95[2] = {0.0, 0.0}; // of the slope, by Student's t
  double scatter = 0.0;        // relative: 95 % of single measurements lie within a factor e^+-scatter of the line
  int points = 0;
};

// Nothing below three points, whose scatter would be unknown.
std::optional<PowerFit> fit_power(const std::vector<Measured>& points);

// y at `x`, straight between neighbours on logarithmic axes; nothing outside of what was measured. x ascends.
std::optional<double> value_at(const std::vector<Measured>& points, double x);

enum class Reach { interpolated, extrapolated, at_most, not_reached };

struct TimeTo {
  Reach how = Reach::not_reached;
  double x = 0.0; // at_most: the first point is below `level` already
};

// The x at which y comes down to `level`. Past the last point the fit is trusted for one octave and no further.
TimeTo time_to(const std::vector<Measured>& points, double level);

} // namespace wavepath
